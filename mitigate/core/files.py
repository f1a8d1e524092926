"""Files written whole or not at all; text, gzipped or not, opened by content, streamed."""

from __future__ import annotations

import difflib
import gzip
import hashlib
import io
import os
import secrets
import stat
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TextIO

from mitigate.core import output

GZIP_MAGIC = b"\x1f\x8b"  # RFC 1952
RECORDING = "recording.json"  # in the folder of a recording by `mitigate run record=FOLDER`
RATIO = 128  # bytes that a gzipped byte may unpack to, beyond FREE (ours); our files have 15 to 31
FREE = 1 << 24


PACKAGE = Path(__file__).resolve().parents[1]  # the folder of mitigate
ROOT = PACKAGE.parent  # of the checkout, or of all installed packages


WEIGHTS = "checkpoints"  # first part of the names of shipped weights: checkpoints/base
WEIGHTS_PACKAGE = "mitigate_weights"  # of the distribution mitigate-weights
WEIGHTS_VARIABLE = "MITIGATE_WEIGHTS"  # names a folder with the content of checkpoints/


def find(path: str | Path) -> Path:
    """Return where a file or folder of the project is.

    Configs name shipped weights and episodes as ``checkpoints/base`` and ``mitigate/worlds/...``.

    Args:
        path: as it is from the current folder, or as in a checkout; ``~`` is the home folder.

    Returns:
        The first of :func:`places` that exists; else ``path`` itself.

    Raises:
        FileNotFoundError: for shipped weights (``checkpoints/...``) that are in no place.
    """
    candidates = places(path)
    place = next((candidate for candidate in candidates if candidate.exists()), candidates[0])
    if candidates[0].parts[:1] == (WEIGHTS,) and not place.exists():
        package = find_spec(WEIGHTS_PACKAGE)
        raise FileNotFoundError(
            f"There are no weights at {path}: not in this folder, not in the package "
            f"mitigate-weights ({'installed' if package else 'not installed'}), not in "
            f"{ROOT / WEIGHTS}, and not in the folder that {WEIGHTS_VARIABLE} names "
            f"({os.environ.get(WEIGHTS_VARIABLE) or 'not set'}). Install mitigate-weights, work in "
            f"a checkout, set {WEIGHTS_VARIABLE}, or name other weights, such as runs/.../agent."
        )
    return place


def places(path: str | Path) -> list[Path]:
    """Return where ``path`` is looked for, in this order: as it is from the current folder, in the
    package mitigate-weights, in the checkout, in the folder that ``MITIGATE_WEIGHTS`` names."""
    path = Path(os.path.expanduser(path))  # stays as it is for an unknown user
    if path.parts[:1] != (WEIGHTS,):
        return [path, ROOT / path, PACKAGE / path]
    package = find_spec(WEIGHTS_PACKAGE)
    folders = [*(package.submodule_search_locations or ())] if package else []
    folders.append(str(ROOT / WEIGHTS))
    if os.environ.get(WEIGHTS_VARIABLE):
        folders.append(os.path.expanduser(os.environ[WEIGHTS_VARIABLE]))
    return [path, *(Path(folder, *path.parts[1:]) for folder in folders)]


def open_text(path: Path | str) -> io.TextIOWrapper:
    """Open ``path`` for reading as UTF-8, behind the byte order mark that editors of Windows put
    first; gzip is told by the first two bytes, not by the name.

    Raises FileNotFoundError, with the nearest names in the folder, if there is no such file, and
    UnsafePathError for a FIFO, a socket or a device.
    Reading raises BadGzipFile for a gzip file that is damaged, cut short or a bomb (``RATIO``).
    """
    path = Path(path)
    if not output.is_regular(path):
        raise FileNotFoundError(_absent(path))
    with open(path, "rb") as file:
        gzipped = file.read(2) == GZIP_MAGIC
    if gzipped:
        return io.TextIOWrapper(_Unpacked(path, "rb"), encoding="utf-8-sig")
    return open(path, encoding="utf-8-sig")


class _Unpacked(gzip.GzipFile):
    """What a gzip file holds. All that can be wrong with it raises BadGzipFile."""

    def __init__(self, path: Path, mode: str) -> None:
        super().__init__(path, mode)
        self._most, self._held = FREE + RATIO * path.stat().st_size, 0

    def read(self, size: int | None = -1) -> bytes:
        """As a file's; at most one byte more than allowed is unpacked."""
        wanted = self._most + 1 - self._held if size is None or size < 0 else size
        return self._checked(super().read, wanted)

    def read1(self, size: int = -1) -> bytes:
        """As a buffered file's."""
        return self._checked(super().read1, size)

    def _checked(self, read: Callable[[int], bytes], size: int) -> bytes:
        try:
            found = read(size)
        except (EOFError, zlib.error) as error:
            raise gzip.BadGzipFile(f"the gzip data are cut short or damaged ({error})") from error
        self._held += len(found)
        if self._held > self._most:
            raise gzip.BadGzipFile(
                f"it unpacks to more than {self._most >> 20} MiB, over {RATIO} times what it has, "
                "as no file of ours does: do not use it, or unpack it yourself and name the plain "
                "file"
            )
        return found


def read_regular(path: Path | str) -> str:
    """Return the UTF-8 text of a small file in an output folder. Raises as :func:`open_text`."""
    with open_text(path) as file:
        return file.read()


def make_folder(folder: Path | str) -> Path:
    """Make ``folder`` with those above it, unless it is there; return it.

    Raises OSError as :func:`writing`, and as :func:`mitigate.core.output.check` does.
    """
    with output.writing(folder):
        output.make_checked(folder)
    return Path(folder)


@contextmanager
def _draft(path: Path) -> Iterator[Path]:
    """Yield an empty neighbour of ``path``, which is flushed to disk and becomes ``path`` if the
    block ends without an error, with the mode that the umask gives. Makes the folder."""
    # a random part: nobody can put a link at a name that is not known
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.{os.getpid()}.tmp")
    with output.writing(path):
        output.make_checked(path.parent)
        output.open_output(temporary, "xb").close()
    mode = stat.S_IMODE(temporary.stat().st_mode)
    try:
        yield temporary
        with output.writing(path):
            output.check(path)
            temporary.chmod(mode)  # safetensors puts a private file in its place
            with open(temporary, "rb+") as file:
                os.fsync(file.fileno())
            os.replace(temporary, path)
    except (OSError, RuntimeError):  # torch raises RuntimeError for a folder that is gone
        output.check(path)
        raise
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def atomic_text(path: Path | str) -> Iterator[TextIO]:
    """Yield a UTF-8 text file that becomes ``path`` only if the block ends without an error.

    A name ending in ``.gz`` is gzipped, without time stamp or name: equal text, equal bytes.
    Raises OSError, as :func:`writing`, if it cannot be written.
    """
    path = Path(path)
    with _draft(path) as temporary, open(temporary, "wb") as raw:
        if path.suffix == ".gz":
            with (
                gzip.GzipFile("", "wb", fileobj=raw, mtime=0) as packed,
                io.TextIOWrapper(packed, encoding="utf-8", newline="\n") as text,
            ):
                yield text
        else:
            plain = io.TextIOWrapper(raw, encoding="utf-8", newline="\n")
            yield plain
            plain.detach()  # flushes, and leaves the file open


def put_folder(draft: Path, target: Path, old: Path) -> None:
    """Rename ``draft`` to ``target``. What was there becomes ``old``, and comes back if that fails;
    the three are on one disk."""
    if target.exists():
        target.rename(old)
    try:
        draft.rename(target)
    except BaseException:
        if old.exists() and not target.exists():
            old.rename(target)
        raise


def sha256(path: Path | str) -> str:
    """Return the sha256 of a file, as hex. Raises UnsafePathError for a FIFO or a device."""
    output.is_regular(path)
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def write_atomically(path: Path, write: Callable[[Path], Any]) -> Path:
    """Call ``write`` on a temporary neighbour of ``path``, flush it to disk, then rename it.

    Raises OSError, as :func:`writing`, if there is no place for it.
    """
    with _draft(path) as temporary:
        write(temporary)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
    return path


def write_bytes(path: Path | str, data: bytes) -> None:
    """Write ``data`` to ``path``, which is there whole or not at all. Makes the folder. Raises
    OSError as :func:`writing`."""
    with _draft(Path(path)) as temporary, output.writing(path):
        temporary.write_bytes(data)


def write_text(path: Path | str, text: str) -> None:
    """Write ``text`` as UTF-8, as :func:`write_bytes` does."""
    write_bytes(path, text.encode())


def write_figure(path: Path | str, figure: Any, **options: Any) -> Path:
    """Write a matplotlib ``figure`` to ``path``, as :func:`write_bytes` does.

    Args:
        path: The picture; its suffix says the format.
        figure: A ``matplotlib.figure.Figure``.
        options: Other arguments of ``savefig``, such as ``dpi``.
    """
    path = Path(path)
    drawn = io.BytesIO()
    figure.savefig(drawn, format=path.suffix[1:], **options)
    write_bytes(path, drawn.getvalue())
    return path


def _absent(path: Path) -> str:
    names = [p.name for p in path.parent.iterdir()] if path.parent.is_dir() else []
    near = difflib.get_close_matches(path.name, names, n=3, cutoff=0.5)
    if path.is_dir():
        return f"{path} is a folder, not a file: name a file in it."
    if not path.parent.is_dir():
        return f"There is no file {path}, nor its folder: check the path."
    found = f"the nearest names there are {', '.join(near)}" if near else "nothing there is near"
    return f"There is no file {path}; {found}. Check the path."
