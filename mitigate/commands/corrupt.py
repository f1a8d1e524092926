"""``python -m mitigate.corrupt``: the same as ``mitigate corrupt``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["corrupt", *sys.argv[1:]])
