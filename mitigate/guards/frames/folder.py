"""Write and read the folder of a restorer.

The folder contains ``model.safetensors``, ``card.json`` and a manifest. No code from the folder is
run when it is read. The sizes of the networks come from the card, and must be within ``LIMITS``.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from mitigate.core import checkpoint, folders
from mitigate.core.files import write_json
from mitigate.core.observation import DEPTH, RGB

if TYPE_CHECKING:
    from mitigate.guards.frames.restorer import Restorer

FORMAT, CARD = 4, "card.json"
LIMITS = {"width": (4, 128), "depth_width": (4, 128), "size": (32, 512)}  # heuristic
FARTHEST = 1000.0  # metres, heuristic
_AGAIN = "Fetch the folder again, or train it again with `make train RECIPE=restore`."


def write(restorer: Restorer, folder: str | Path, *, half: bool = False) -> Path:
    """Write ``restorer`` into ``folder`` and return the folder.

    With ``half``, the weights of ``restorer`` itself are also rounded to float16, because the card
    contains the hash of the weights that are read from the folder.
    """
    with folders.write_folder(folder, "restorer") as draft:
        checkpoint.write_tensors(restorer, draft / checkpoint.WEIGHTS, half=half)
        if half:
            checkpoint.load_weights(restorer, draft)
        card = {"format": FORMAT, "hash": restorer.hash, "settings": restorer.settings()}
        write_json(draft / CARD, card, indent=1)
    return Path(folder)


def card(folder: str | Path) -> dict[str, Any]:
    """Return the checked content of ``card.json``.

    Raises:
        FileNotFoundError: If a file of the folder is missing.
        ValueError: If the card is damaged or has an unknown format.
    """
    folder = Path(folder)
    missing = [n for n in (CARD, checkpoint.WEIGHTS) if not (folder / n).is_file()]
    if missing:
        raise FileNotFoundError(
            f"There is no restorer at {folder}: {', '.join(missing)} missing. Train a restorer "
            "with `make train RECIPE=restore` (its folder is runs/.../agent), or name "
            "checkpoints/restorer or a function (module:callable)."
        )
    content = folders.read_checked(folder / CARD, _AGAIN)
    if wrong := _wrong(content):
        raise ValueError(f"{folder / CARD}: {wrong}. {_AGAIN}")
    return content


def _wrong(content: dict[str, Any]) -> str:
    """Return a message about the first problem in a card, or "" if the card is valid."""
    if content.get("format") != FORMAT:
        return f"it must have format {FORMAT}"
    settings = content.get("settings")
    if not isinstance(settings, dict) or not isinstance(content.get("hash"), str):
        return "it must have settings and a hash"
    if set(settings) != {"sensors", "far", *LIMITS}:
        return f"settings must be sensors, far, {', '.join(LIMITS)}"
    return problem(settings)


def problem(settings: dict[str, Any]) -> str:
    """Return a message about the first invalid setting of a restorer, or "" if there is none."""
    sensors, far = settings["sensors"], settings["far"]
    if sensors not in ([RGB], [DEPTH], [RGB, DEPTH], [DEPTH, RGB]):
        return f"sensors={sensors!r:.60} must name rgb, depth or both"
    if type(far) not in (int, float) or not 0 < far <= FARTHEST:
        return f"far={far!r:.40} must be metres above 0, {FARTHEST:g} at most"
    for name, (least, most) in LIMITS.items():
        value = settings[name]
        if type(value) is not int or not least <= value <= most:
            return f"{name}={value!r:.40} must be a whole number from {least} to {most}"
    return ""


def fill(restorer: Restorer, folder: str | Path) -> None:
    """Load the weights in ``folder`` into ``restorer``.

    The settings of ``restorer`` must equal those in the card. Raises the errors of :func:`card`.
    Raises ValueError if the settings differ, or if a checksum is missing or does not match the
    weights.
    """
    content = card(folder)
    for name, value in restorer.settings().items():
        if content["settings"][name] != value:
            raise ValueError(
                f"The restorer in {folder} has {name}={content['settings'][name]!r:.60}, not "
                f"{value!r:.60}. Set agent.{name} to that, or train from scratch (init=null)."
            )
    file = Path(folder) / checkpoint.WEIGHTS
    if not folders.is_listed(file):
        raise ValueError(f"{file} is not listed in the {folders.MANIFEST} of its folder. {_AGAIN}")
    # load_weights would report this too, but would suggest deleting the checksum, which is required
    if wrong := folders.problem(file):
        raise ValueError(f"{file} is truncated or damaged: it {wrong}. {_AGAIN}")
    checkpoint.load_weights(restorer, folder)
    if restorer.hash != content["hash"]:
        raise ValueError(
            f"The weights in {folder} do not match its {CARD} ({restorer.hash}, not "
            f"{content['hash'][:20]}). {_AGAIN}"
        )
