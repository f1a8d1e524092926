"""What a training of an encoder leaves: a folder of data that plain PyTorch can load.

With adapters: ``adapters.safetensors`` and ``adapters.json``; with ``tune=all``:
``model.safetensors``. ``encoder.json`` says what frames and which output they belong to; all files
are listed in the manifest. Reading one runs nothing from it: the caller gives the encoder.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mitigate.agents import adapters
from mitigate.core import checkpoint, folders
from mitigate.core.files import write_text
from mitigate.core.json_files import read_json

if TYPE_CHECKING:
    from mitigate.encoders.model import Encoder

FORMAT = 1
CARD, README = "encoder.json", "README.md"
ENTRIES: dict[str, tuple[type, ...]] = {
    "format": (int,),
    "sensor": (str,),
    "transform": (dict,),
    "output": (str, int, type(None)),
    "pool": (str,),
    "tune": (str,),
}
_AGAIN = "Fetch the folder again, or train it again with `make train RECIPE=encoder`."
_LINES = {
    "adapters": """\
from plain_adapters import attach  # mitigate/encoders/plain_adapters.py, copied beside your code

encoder.eval()  # with the weights that the adapters were trained for
encoder = attach(encoder, "{folder}")
""",
    "all": """\
from plain_adapters import parse  # mitigate/encoders/plain_adapters.py, copied beside your code

encoder.load_state_dict(parse(open("{folder}/model.safetensors", "rb").read()))
""",
}


def write(encoder: Encoder, folder: str | Path) -> Path:
    """Write what was trained of ``encoder`` into ``folder``; return it."""
    with folders.write_folder(folder, "encoder") as draft:
        if encoder.tune == "adapters":
            adapters.write_adapters(encoder.model, draft)
        else:
            checkpoint.write_tensors(_inner(encoder), draft / checkpoint.WEIGHTS)
        card = {"format": FORMAT, **described(encoder)}
        write_text(draft / CARD, json.dumps(card, indent=2))
        write_text(
            draft / README,
            f"# A hardened encoder\n\nTrained by `make train RECIPE=encoder` (mitigate). In plain "
            f"PyTorch:\n\n```python\n{lines(encoder, 'this-folder')}```\n",
        )
    return Path(folder)


def described(encoder: Encoder) -> dict[str, Any]:
    """What ``encoder`` takes and gives, as plain data."""
    return {
        "sensor": encoder.sensor,
        "transform": encoder.transform.settings(),
        "output": encoder.output,
        "pool": encoder.pool,
        "tune": encoder.tune,
    }


def lines(encoder: Encoder, folder: str | Path) -> str:
    """The lines of plain PyTorch that load ``folder``."""
    return _LINES[encoder.tune].format(folder=folder)


def _inner(encoder: Encoder) -> Any:
    return encoder.model.model if encoder.wrapped else encoder.model


def card(folder: str | Path) -> dict[str, Any]:
    """What ``encoder.json`` says. Raises FileNotFoundError if it is missing, ValueError if it is
    damaged or of another form."""
    file = Path(folder) / CARD
    if not file.is_file():
        raise FileNotFoundError(
            f"{folder} holds no hardened encoder: {CARD} is missing. Name the folder `agent` of a "
            "run of `make train RECIPE=encoder`."
        )
    damage = folders.problem(file)
    if damage:
        raise ValueError(f"{file} is cut short or damaged: it {damage}. {_AGAIN}")
    found = read_json(file, _AGAIN)
    for name, kinds in ENTRIES.items():
        value = found.get(name) if isinstance(found, dict) else None
        if type(value) not in kinds or (name == "format" and value != FORMAT):
            raise ValueError(f"{file}: {name} must not be {value!r:.60}. {_AGAIN}")
    return found


def fill(encoder: Encoder, folder: str | Path) -> None:
    """Read what :func:`write` wrote into an encoder with the original weights.

    Raises as :func:`card` and ``load_adapters``; ValueError too for the folder of an encoder with
    other settings.
    """
    held, own = card(folder), described(encoder)
    wrong = [name for name, value in own.items() if held[name] != value]
    if wrong:
        raise ValueError(
            f"{folder} is of an encoder with {wrong[0]}={held[wrong[0]]!r:.100}, but this one has "
            f"{own[wrong[0]]!r:.100}. Build it with the settings in {CARD}."
        )
    if encoder.tune == "adapters":
        adapters.remove_adapters(encoder.model)
        adapters.load_adapters(encoder.model, folder)
    else:
        checkpoint.load_weights(_inner(encoder), folder)
