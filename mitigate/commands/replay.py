"""``python -m mitigate.replay``: the same as ``mitigate replay``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["replay", *sys.argv[1:]])
