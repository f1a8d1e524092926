"""``python -m mitigate.export_scene``: the same as ``mitigate export_scene``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["export_scene", *sys.argv[1:]])
