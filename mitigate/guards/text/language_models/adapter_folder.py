"""Read and write a LoRA adapter in PEFT's folder format.

The folder also contains a card that names the adapter's base model.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from torch import Tensor

from mitigate.core import folders
from mitigate.core.checkpoint import load_tensors
from mitigate.core.files import write_json
from mitigate.guards.text.choices import ADAPTER_CONFIG, ADAPTER_WEIGHTS

CARD, CONFIG, ADAPTER = "card.json", ADAPTER_CONFIG, ADAPTER_WEIGHTS
# entries that are read from the card and from PEFT's config, with their types
ENTRIES: dict[str, dict[str, tuple[type, ...]]] = {
    CARD: {"base": (str,), "base_sha256": (str,), "prompt": (str,)},
    CONFIG: {
        "r": (int,),
        "lora_alpha": (int, float),
        "lora_dropout": (int, float),
        "target_modules": (list,),
    },
}
# maximum rank of an adapter (heuristic: larger than the layer width of the default base model)
HIGHEST_RANK = 1024
_AGAIN = "Fetch the folder again, or train it again with `make train RECIPE=safeguard_lora`."


def write_adapter(
    folder: str | Path, network: Any, tensors: dict[str, Tensor], card: dict[str, Any]
) -> None:
    """Write the adapter of a PEFT ``network``: its weights (``tensors``) and its ``card``.

    All files are replaced together, and a manifest lists them.
    """
    with folders.write_folder(folder, "safeguard") as draft:
        network.save_pretrained(draft, state_dict=tensors, save_embedding_layers=False)
        for file in draft.iterdir():
            if file.name not in (CONFIG, ADAPTER):
                file.unlink()  # PEFT's README template
        write_json(draft / CARD, card, indent=1)


def read_adapter(folder: str | Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the card of an adapter folder, and the PEFT config.

    Only the entries listed in ``ENTRIES`` are checked. Raises FileNotFoundError for a missing file,
    and ValueError for a damaged one.
    """
    missing = [n for n in (CARD, CONFIG, ADAPTER) if not (Path(folder) / n).is_file()]
    if missing:
        raise FileNotFoundError(
            f"There is no adapter at {folder}: {', '.join(missing)} missing. Train an adapter with "
            "`make train RECIPE=safeguard_lora`, or name checkpoints/safeguard."
        )
    card, config = (_entries(Path(folder) / name, kinds) for name, kinds in ENTRIES.items())
    named = all(isinstance(target, str) for target in config["target_modules"])
    if not named or not 1 <= config["r"] <= HIGHEST_RANK:
        raise ValueError(
            f"{Path(folder) / CONFIG}: target_modules must be names, and r from 1 to "
            f"{HIGHEST_RANK}. {_AGAIN}"
        )
    return card, config


def adapter_tensors(folder: str | Path, config: dict[str, Any]) -> dict[str, Tensor]:
    """Return the weight matrices of an adapter folder, and check them against its ``config``.

    Raises ValueError for damaged files and wrong shapes.
    """
    file, rank = Path(folder) / ADAPTER, config["r"]
    tensors = load_tensors(file)
    for name, value in tensors.items():
        module, _, matrix = name.partition(".lora_")
        known = any(module.endswith(f".{target}") for target in config["target_modules"])
        side = {"A.weight": 0, "B.weight": 1}.get(matrix)
        if not known or side is None or value.ndim != 2 or value.shape[side] != rank:
            raise ValueError(
                f"{file} does not fit its {CONFIG}: {name} {list(value.shape)} is not a LoRA "
                f"matrix of rank {rank} for {', '.join(config['target_modules'])}. {_AGAIN}"
            )
    if not tensors:
        raise ValueError(f"{file} holds no weights. {_AGAIN}")
    return tensors


def _entries(file: Path, kinds: dict[str, tuple[type, ...]]) -> dict[str, Any]:
    """Return the JSON object in ``file``.

    ``kinds`` maps the names of its required entries to their allowed types.
    """
    config = folders.read_checked(file, _AGAIN)
    for name, kind in kinds.items():
        value = config.get(name)
        if type(value) not in kind:
            allowed = " or ".join(k.__name__ for k in kind)
            raise ValueError(f"{file}: {name} must be {allowed}, not {value!r:.80}. {_AGAIN}")
    return config
