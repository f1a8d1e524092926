"""Write the fixed list of episodes for a validation split of the apartments:
``python -m tools.apartment_episodes OUT.json.gz --split val_unseen --task vln``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mitigate.worlds.apartments.palette import SPLITS
from mitigate.worlds.apartments.tasks import TASKS, fixed_episodes
from mitigate.worlds.episodes import write_episodes


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--split", choices=SPLITS, default="val_unseen")
    parser.add_argument("--task", choices=TASKS, default="vln")
    parser.add_argument("--count", type=int, default=300)
    options = parser.parse_args()
    write_episodes(options.out, fixed_episodes(options.split, options.task, options.count))
    print(f"wrote {options.count} {options.task} episodes of {options.split} to {options.out}")


if __name__ == "__main__":
    main()
