"""Save a trained encoder as a folder that plain PyTorch can load, and load such folders.

Adapters are stored in ``adapters.safetensors`` and ``adapters.json``; with ``tune=all``, all
weights are stored in ``model.safetensors``. ``encoder.json`` describes the input frames and the
output with which the weights were trained. The manifest lists all files. Loading runs no code from
the folder. Therefore the caller must construct the encoder.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from mitigate.agents import adapters
from mitigate.core import checkpoint, folders
from mitigate.core.files import write_json, write_text

if TYPE_CHECKING:
    from mitigate.encoders.model import Encoder

FORMAT = 1
CARD, README = "encoder.json", "README.md"
_AGAIN = "Fetch the folder again, or train it again with `make train RECIPE=encoder`."
_LINES = {
    "adapters": """\
from plain_adapters import attach  # mitigate/encoders/plain_adapters.py, copied into your project

encoder.eval()  # with the weights that the adapters were trained for
encoder = attach(encoder, "{folder}")
""",
    "all": """\
from plain_adapters import parse  # mitigate/encoders/plain_adapters.py, copied into your project

encoder.load_state_dict(parse(open("{folder}/model.safetensors", "rb").read()))
""",
}


def write(encoder: Encoder, folder: str | Path) -> Path:
    """Write the trained weights of ``encoder`` into ``folder``, and return the folder."""
    with folders.write_folder(folder, "encoder") as draft:
        if encoder.tune == "adapters":
            adapters.write_adapters(encoder.model, draft)
        else:
            checkpoint.write_tensors(encoder.model, draft / checkpoint.WEIGHTS)
        write_json(draft / CARD, described(encoder), indent=2)
        write_text(
            draft / README,
            f"# A hardened encoder\n\nTrained by `make train RECIPE=encoder` (mitigate). In plain "
            f"PyTorch:\n\n```python\n{lines(encoder, 'this-folder')}```\n",
        )
    return Path(folder)


def described(encoder: Encoder) -> dict[str, Any]:
    """Return, as plain data, the settings for the input and output of ``encoder``."""
    return {
        "format": FORMAT,
        "sensor": encoder.sensor,
        "transform": encoder.transform.settings(),
        "output": encoder.output,
        "pool": encoder.pool,
        "tune": encoder.tune,
    }


def lines(encoder: Encoder, folder: str | Path) -> str:
    """Return the lines of plain PyTorch code that load ``folder``."""
    return _LINES[encoder.tune].format(folder=folder)


def card(folder: str | Path) -> dict[str, Any]:
    """Read ``encoder.json``.

    Raises:
        FileNotFoundError: If the file is missing.
        ValueError: If the file is damaged.
    """
    file = Path(folder) / CARD
    if not file.is_file():
        raise FileNotFoundError(
            f"{folder} must contain a hardened encoder, but {CARD} is missing. Give the path of "
            "the folder `agent` that `make train RECIPE=encoder` writes into its run folder."
        )
    return folders.read_checked(file, _AGAIN)


def fill(encoder: Encoder, folder: str | Path) -> None:
    """Load the trained weights of a folder into ``encoder``.

    ``folder`` must come from :func:`write`, and ``encoder`` must have its original weights.

    Raises the same errors as :func:`card` and ``load_adapters``, and ValueError if the folder
    belongs to an encoder with different settings.
    """
    stored = card(folder)
    for name, value in described(encoder).items():
        if stored.get(name) != value:
            raise ValueError(
                f"{folder} belongs to an encoder with {name}={stored.get(name)!r:.100}, but the "
                f"given encoder has {value!r:.100}. Construct it with the settings in {CARD}."
            )
    if encoder.tune == "adapters":
        adapters.remove_adapters(encoder.model)
        adapters.load_adapters(encoder.model, folder)
    else:
        checkpoint.load_weights(encoder.model, folder)
