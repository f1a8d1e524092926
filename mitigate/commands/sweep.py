"""``python -m mitigate.sweep``: the same as ``mitigate sweep``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["sweep", *sys.argv[1:]])
