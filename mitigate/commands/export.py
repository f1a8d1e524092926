"""``python -m mitigate.export``: the same as ``mitigate export``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["export", *sys.argv[1:]])
