"""``python -m mitigate``: the command ``mitigate``."""

from mitigate.cli import main

if __name__ == "__main__":
    main()
