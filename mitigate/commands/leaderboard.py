"""``python -m mitigate.leaderboard``: the same as ``mitigate leaderboard``."""

import sys

from mitigate.cli import main

if __name__ == "__main__":
    main(["leaderboard", *sys.argv[1:]])
