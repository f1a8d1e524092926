"""``python -m mitigate.table``: the same as ``mitigate table``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["table", *sys.argv[1:]])
