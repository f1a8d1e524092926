"""``python -m mitigate.train``: the same as ``mitigate train``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["train", *sys.argv[1:]])
