"""A LoRA adapter on disk: PEFT's folder format, and a card that names the base it belongs to."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

from torch import Tensor

CARD, CONFIG, ADAPTER = "card.json", "adapter_config.json", "adapter_model.safetensors"


def write_adapter(
    folder: str | Path, network: Any, tensors: dict[str, Tensor], card: dict[str, Any]
) -> None:
    """Write the adapter of a PEFT ``network``, its weights ``tensors``, and ``card``.

    Files appear whole or not at all.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder) as temporary:
        network.save_pretrained(temporary, state_dict=tensors, save_embedding_layers=False)
        (Path(temporary) / CARD).write_text(json.dumps(card, indent=1) + "\n", "utf-8")
        for name in (CONFIG, ADAPTER, CARD):
            os.replace(Path(temporary) / name, folder / name)


def read_adapter(folder: str | Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the card and PEFT's config of an adapter folder; raises FileNotFoundError."""
    missing = [n for n in (CARD, CONFIG, ADAPTER) if not (Path(folder) / n).is_file()]
    if missing:
        raise FileNotFoundError(
            f"There is no adapter at {folder}: {', '.join(missing)} missing. Train one with `make "
            "train RECIPE=safeguard_lora`, or name checkpoints/safeguard."
        )
    card, config = (json.loads((Path(folder) / name).read_text("utf-8")) for name in (CARD, CONFIG))
    return card, config
