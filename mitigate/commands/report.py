"""``python -m mitigate.report``: the same as ``mitigate report``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["report", *sys.argv[1:]])
