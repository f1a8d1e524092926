"""Find files of the project, read text and gzip safely, and write files atomically."""

from __future__ import annotations

import difflib
import gzip
import hashlib
import io
import json
import os
import secrets
import stat
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any, BinaryIO, TextIO

from mitigate.core import output
from mitigate.core.names import printable, unknown

GZIP_MAGIC = b"\x1f\x8b"  # RFC 1952
# first line of a pointer file (Git LFS specification)
LFS_START = b"version https://git-lfs.github.com/spec/"
RECORDING = "recording.json"  # a recording of `mitigate run record=FOLDER` contains this file
LONGEST_DRAFT = 200  # a temporary name contains at most this many bytes of the final name
# A gzip file may unpack to at most FREE + RATIO * (its size) bytes.
# This limit is a heuristic; our files unpack to 15 to 31 times their size.
RATIO = 128
FREE = 1 << 24
# number of final bytes of a program's output that are read for a message (heuristic)
TAIL_BYTES = 1 << 16
LINE_WIDTH = 200  # maximum length of an output line in a message, in characters (heuristic)

PACKAGE = Path(__file__).resolve().parents[1]  # the folder of mitigate
ROOT = PACKAGE.parent  # the checkout, or the folder of installed packages

WEIGHTS = "checkpoints"  # first part of the names of shipped weights, such as checkpoints/base
WEIGHTS_PACKAGE = "mitigate_weights"  # the import name of the distribution mitigate-weights
# this environment variable names a folder with the same content as checkpoints/
WEIGHTS_VARIABLE = "MITIGATE_WEIGHTS"


def find(path: str | Path) -> Path:
    """Return the path of a file or folder of the project.

    Configs name shipped weights and episodes as ``checkpoints/base`` and ``mitigate/worlds/...``.

    Args:
        path: a path, relative to the current folder or to a checkout; ``~`` is the home folder.

    Returns:
        The first existing path of :func:`places`, or ``path`` itself if none exists.

    Raises:
        FileNotFoundError: If the path names shipped weights (``checkpoints/...``) that do not
            exist.
    """
    candidates = places(path)
    place = next((candidate for candidate in candidates if candidate.exists()), candidates[0])
    if candidates[0].parts[:1] == (WEIGHTS,) and not place.exists():
        if shipped := {f"{WEIGHTS}/{n}" for root in places(WEIGHTS) for n in weights_below(root)}:
            namesakes = {name for name in shipped if Path(name).name == candidates[0].name}
            raise FileNotFoundError(unknown("weights folder", str(path), namesakes or shipped))
        package = find_spec(WEIGHTS_PACKAGE)
        raise FileNotFoundError(
            f"There are no weights at {path}, neither here nor in {ROOT / WEIGHTS}. Install "
            f"mitigate-weights ({'' if package else 'not '}installed), work in a checkout, "
            f"set {WEIGHTS_VARIABLE} ({os.environ.get(WEIGHTS_VARIABLE) or 'not set'}), or name "
            "other weights, such as runs/.../agent."
        )
    return place


def weights_below(folder: Path) -> list[str]:
    """Return the relative paths of folders with weights, up to two levels below ``folder``."""
    files = [*folder.glob("*/*.safetensors"), *folder.glob("*/*/*.safetensors")]
    return sorted({file.parent.relative_to(folder).as_posix() for file in files})


def places(path: str | Path) -> list[Path]:
    """Return the candidates for ``path``, in the order in which they are tried.

    The candidates are in the current folder, the package mitigate-weights, the checkout, and the
    folder that ``MITIGATE_WEIGHTS`` names.
    """
    path = Path(os.path.expanduser(path))  # "~" stays unchanged if the user is unknown
    if path.parts[:1] != (WEIGHTS,):
        return [path, ROOT / path, PACKAGE / path]
    package = find_spec(WEIGHTS_PACKAGE)
    folders = [*(package.submodule_search_locations or ())] if package else []
    folders.append(str(ROOT / WEIGHTS))
    if os.environ.get(WEIGHTS_VARIABLE):
        folders.append(os.path.expanduser(os.environ[WEIGHTS_VARIABLE]))
    return [path, *(Path(folder, *path.parts[1:]) for folder in folders)]


def open_text(path: Path | str) -> io.TextIOWrapper:
    """Open ``path`` for reading as UTF-8; skip a byte order mark.

    A gzip file is recognised by its first two bytes, not by its name. Reading raises BadGzipFile if
    the gzip file is damaged or truncated, or if it unpacks to too many bytes (``RATIO``).

    Raises:
        FileNotFoundError: If the file does not exist; the message lists the nearest names.
        UnsafePathError: If the path is a FIFO, a socket or a device.
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
    """Stream of a gzip file's content, which raises BadGzipFile for every kind of damage."""

    def __init__(self, path: Path, mode: str) -> None:
        super().__init__(path, mode)
        self._limit = FREE + RATIO * path.stat().st_size
        self._unpacked = 0

    def read(self, size: int | None = -1) -> bytes:
        """Read like a file object, but stop at a limit if ``size`` is not set.

        Reading stops one byte after the limit, which is enough to detect a file that is too large.
        """
        count = self._limit + 1 - self._unpacked if size is None or size < 0 else size
        return self._checked(super().read, count)

    def read1(self, size: int = -1) -> bytes:
        return self._checked(super().read1, size)

    def _checked(self, read: Callable[[int], bytes], size: int) -> bytes:
        try:
            content = read(size)
        except (EOFError, zlib.error) as error:
            raise gzip.BadGzipFile(f"the gzip data are truncated or damaged ({error})") from error
        self._unpacked += len(content)
        if self._unpacked > self._limit:
            raise gzip.BadGzipFile(
                f"it unpacks to more than {self._limit >> 20} MiB, over {RATIO} times its size: do "
                "not use it, or unpack it yourself and name the plain file"
            )
        return content


def lfs_problem(path: Path | str) -> str:
    """Return "is a Git LFS pointer ..." if the file is a pointer, else ""."""
    with open(path, "rb") as file:
        if file.read(len(LFS_START)) != LFS_START:
            return ""
    return "is a Git LFS pointer, not the file itself. Run `git lfs pull` in its repository"


def read_bounded(path: Path | str, most: int) -> bytes:
    """Return the content of an untrusted file.

    Raises:
        ValueError: "it has more than ... bytes"; the caller names the file.
        UnsafePathError: If the path is a FIFO, a socket or a device.
    """
    output.is_regular(path)
    with open(path, "rb") as file:
        # read() allocates as many bytes as its argument says, so limit it to the size of the file
        content = file.read(min(most, os.fstat(file.fileno()).st_size) + 1)
    if len(content) > most:
        raise ValueError(f"it has more than {most} bytes")
    return content


def last_lines(file: BinaryIO, count: int, width: int = LINE_WIDTH) -> list[str]:
    """Return the last non-empty lines of a program's output, for a message.

    Only the last ``TAIL_BYTES`` are read. A longer line is shortened in its middle, and control
    characters are escaped.

    Args:
        file: seekable file, open for reading.
        count: maximum number of lines.
        width: maximum number of characters per line. In a shortened line, " ... " is not counted.
    """
    size = file.seek(0, os.SEEK_END)
    file.seek(max(0, size - TAIL_BYTES))
    text = file.read(TAIL_BYTES).decode("utf-8", "replace").replace("\t", " ")
    lines = [line for line in text.splitlines() if line.strip()][-count:]
    half = width // 2
    return [
        printable(line if len(line) <= width else f"{line[:half]} ... {line[-half:]}")
        for line in lines
    ]


def make_folder(folder: Path | str) -> Path:
    """Create ``folder`` and its parents unless it exists, and return it.

    Raises the same errors as :func:`mitigate.core.output.writing` and ``check``.
    """
    with output.writing(folder):
        output.make_checked(folder)
    return Path(folder)


def draft_path(path: Path) -> Path:
    """Return the path of a new temporary file or folder that will be renamed to ``path``.

    If the process is killed, ``core/locks.py`` recognises the name and deletes the file.
    """
    # The random part of the name prevents an attacker from placing a link at a predictable path.
    name = os.fsdecode(os.fsencode(path.name)[:LONGEST_DRAFT])  # a file name has up to 255 bytes
    return path.with_name(f".{name}.{secrets.token_hex(4)}.{os.getpid()}.tmp")


@contextmanager
def _draft(path: Path) -> Iterator[Path]:
    """Yield an empty temporary file that is renamed to ``path`` after the block.

    The temporary file is in the same folder, which is created if needed. The file is flushed to
    disk, and its permissions follow the umask. If the block raises an error, the file is deleted.
    """
    temporary = draft_path(path)
    with output.writing(path):
        output.make_checked(path.parent)
        output.open_output(temporary, "xb").close()
    mode = stat.S_IMODE(temporary.stat().st_mode)
    try:
        yield temporary
        with output.writing(path):
            output.check(path)
            # needed because safetensors replaces the file by a file with mode 600
            temporary.chmod(mode)
            with open(temporary, "rb+") as file:
                os.fsync(file.fileno())
            os.replace(temporary, path)
    except (OSError, RuntimeError):  # torch raises RuntimeError if the folder no longer exists
        output.check(path)
        raise
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def atomic_text(path: Path | str) -> Iterator[TextIO]:
    """Yield a UTF-8 text file that becomes ``path`` only if the block ends without an error.

    If the name ends in ``.gz``, the text is gzipped without time stamp and file name, so equal
    texts give equal bytes. Raises OSError, as :func:`mitigate.core.output.writing` does, if the
    file cannot be written.
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
            plain.detach()  # this flushes the text and leaves the file open


def put_folder(draft: Path, target: Path, old: Path) -> None:
    """Rename ``draft`` to ``target``; an existing ``target`` is first renamed to ``old``.

    If renaming ``draft`` fails, ``old`` is renamed back to ``target``. All three paths must be on
    the same disk.

    Raises:
        OSError: If a path cannot be renamed.
    """
    if target.exists():
        target.rename(old)
    try:
        draft.rename(target)
    except BaseException:
        if old.exists() and not target.exists():
            old.rename(target)
        raise


def sha256(path: Path | str) -> str:
    """Return the sha256 of a file as hex digits.

    Raises:
        FileNotFoundError: If the file does not exist.
        UnsafePathError: If the path is a FIFO, a socket or a device, since reading it could block
            forever.
    """
    output.is_regular(path)
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def write_atomically(path: Path, write: Callable[[Path], Any]) -> Path:
    """Write ``path`` atomically: call ``write`` with a temporary file, flush it, and rename it.

    If ``write`` raises an error, an existing file at ``path`` stays unchanged.

    Raises:
        OSError: If the file cannot be written; :func:`mitigate.core.output.writing` explains why.
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
    """Write ``data`` to ``path`` atomically, and create its folder if needed.

    Raises:
        OSError: If the file cannot be written; :func:`mitigate.core.output.writing` explains why.
    """
    with _draft(Path(path)) as temporary, output.writing(path):
        temporary.write_bytes(data)


def write_text(path: Path | str, text: str) -> None:
    """Write ``text`` as UTF-8 to ``path`` atomically."""
    write_bytes(path, text.encode())


def write_json(path: Path | str, value: Any, indent: int | None = None, **options: Any) -> None:
    """Write ``value`` as JSON and a final newline to ``path`` atomically.

    ``options`` are other arguments of ``json.dumps``. A path in ``.gz`` is not gzipped.
    """
    write_bytes(path, (json.dumps(value, indent=indent, **options) + "\n").encode())


def write_figure(path: Path | str, figure: Any, **options: Any) -> Path:
    """Write a matplotlib ``figure`` to ``path`` atomically.

    Args:
        path: The path of the picture; its suffix determines the format.
        figure: A ``matplotlib.figure.Figure``.
        options: Other arguments of ``savefig``, such as ``dpi``.
    """
    path = Path(path)
    picture = io.BytesIO()
    figure.savefig(picture, format=path.suffix[1:], **options)
    write_bytes(path, picture.getvalue())
    return path


def _absent(path: Path) -> str:
    """Return the error paragraph for a missing file."""
    names = [p.name for p in path.parent.iterdir()] if path.parent.is_dir() else []
    near = difflib.get_close_matches(path.name, names, n=3, cutoff=0.5)
    if path.is_dir():
        return f"{path} is a folder, not a file: name a file in it."
    if not path.parent.is_dir():
        return f"There is no file {path}, and no folder {path.parent}. Check the path."
    hint = f"the nearest names there are {', '.join(near)}" if near else "no name there is similar"
    return f"There is no file {path}; {hint}. Check the path."
