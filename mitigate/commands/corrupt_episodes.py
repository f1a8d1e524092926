"""``python -m mitigate.corrupt_episodes``: the same as ``mitigate corrupt_episodes``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["corrupt_episodes", *sys.argv[1:]])
