"""Read and corrupt LeRobot datasets, version 3.0 of the format of Hugging Face's ``lerobot``.

A dataset is a folder with ``meta/info.json`` (features, frame rate, path templates),
``meta/tasks.parquet``, ``meta/episodes/`` (files and start times of each episode), ``data/``
(one row per frame) and ``videos/`` (several episodes per file). The format is documented at
https://huggingface.co/docs/lerobot/lerobot-dataset-v3 and defined by ``src/lerobot/datasets`` of
``lerobot`` 0.6. ``pyarrow`` and ``av`` read the files; ``lerobot`` need not be installed.
"""

from mitigate.corruptions.lerobot.dataset import Dataset, is_dataset, open_dataset
from mitigate.corruptions.lerobot.metadata import Camera, Episode

__all__ = ["Camera", "Dataset", "Episode", "is_dataset", "open_dataset"]
