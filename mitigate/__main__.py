"""Run the command ``mitigate`` when Python is started with ``python -m mitigate``."""

from mitigate.cli import main

if __name__ == "__main__":
    main()
