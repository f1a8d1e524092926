"""``python -m mitigate.export_drive``: the same as ``mitigate export_drive``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["export_drive", *sys.argv[1:]])
