"""``python -m mitigate.controls``: the same as ``mitigate controls``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["controls", *sys.argv[1:]])
