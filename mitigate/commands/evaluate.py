"""``python -m mitigate.evaluate``: the same as ``mitigate evaluate``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["evaluate", *sys.argv[1:]])
