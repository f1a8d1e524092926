"""``python -m mitigate.run``: the same as ``mitigate run``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["run", *sys.argv[1:]])
