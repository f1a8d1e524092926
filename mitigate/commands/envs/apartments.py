"""``python -m mitigate.envs.apartments``: what ``python -m mitigate.worlds.apartments`` was."""

from mitigate.worlds.apartments.__main__ import main

if __name__ == "__main__":
    main()
