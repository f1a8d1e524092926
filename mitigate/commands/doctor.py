"""``python -m mitigate.doctor``: the same as ``mitigate doctor``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["doctor", *sys.argv[1:]])
