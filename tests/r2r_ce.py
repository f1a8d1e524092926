"""Find the files of the R2R-CE episodes for tests that need them; they are not shipped."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOLDER = Path(os.environ.get("MITIGATE_R2R_CE", ROOT / "../shared/data/r2r-ce"))
FILES = ("train.json.gz", "val_seen.json.gz", "val_seen_gt.json.gz")

needs_r2r_ce = pytest.mark.skipif(
    not all((FOLDER / name).is_file() for name in FILES),
    reason=f"no R2R-CE v1-3 files ({', '.join(FILES)}) in {FOLDER}: set MITIGATE_R2R_CE; they are "
    "under the Matterport3D terms and not shipped",
)
