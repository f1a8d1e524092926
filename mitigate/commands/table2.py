"""``python -m mitigate.table2``: the same as ``mitigate table2``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["table2", *sys.argv[1:]])
