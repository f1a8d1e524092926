"""``python -m mitigate.table1``: the same as ``mitigate table1``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["table1", *sys.argv[1:]])
