"""Decode and encode the videos of a LeRobot dataset."""

from __future__ import annotations

import errno
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mitigate.core.names import escaped, short
from mitigate.core.observation import RGB
from mitigate.core.output import open_output
from mitigate.corruptions.lerobot.metadata import Camera
from mitigate.corruptions.lerobot.tables import FIX, INSTALL, check_file

# Only MP4 is read, because other formats, such as playlists, can refer to other files or URLs.
CONTAINER = "mp4"
RGB_PIXELS = "rgb24"
DEPTH_PIXELS = "gray12le"
GROUP = "2"  # frames between key frames, as in lerobot; the small number makes random access fast


class Encoding(NamedTuple):
    """How frames are encoded."""

    codec: str  # name of the encoder in FFmpeg
    name: str  # name of the codec in meta/info.json
    pixels: str  # pixel format of the frames that the encoder receives
    stored: str  # pixel format of the video, for meta/info.json
    options: dict[str, str]  # options of the encoder


# H.264 in RGB with quantiser 0 keeps every pixel, and the fastest preset is used.
# It wrote noisy frames four times as fast as "veryfast", in files that were 12 % larger.
LOSSLESS = Encoding(
    "libx264rgb", "h264", "rgb24", "gbrp", {"qp": "0", "preset": "ultrafast", "g": GROUP}
)
# lerobot's encoding of depth (DepthEncoderConfig)
DEPTH = Encoding(
    "libx265",
    "hevc",
    DEPTH_PIXELS,
    DEPTH_PIXELS,
    {"x265-params": "lossless=1:log-level=none", "preset": "ultrafast", "g": GROUP},
)
# maps the codec of the original video to lerobot's encoding of RGB (RGBEncoderConfig)
LOSSY = {
    name: Encoding(codec, name, "yuv420p", "yuv420p", {"crf": "30", "g": GROUP, **options})
    for name, codec, options in (
        ("av1", "libsvtav1", {"preset": "12"}),
        ("h264", "libx264", {}),
        ("hevc", "libx265", {"x265-params": "log-level=none"}),
    )
}


def video_library() -> Any:
    """Return the module ``av``; raise ValueError if it is not installed."""
    try:
        import av
    except ModuleNotFoundError as error:
        raise ValueError(
            f"The videos of LeRobot datasets need av, which is not installed: {INSTALL}"
        ) from error
    return av


@contextmanager
def open_video(path: Path, camera: Camera) -> Iterator[tuple[Any, Any]]:
    """Open a video; errors during decoding get a message that explains them.

    Yields:
        The container and its video stream.

    Raises:
        FileNotFoundError: If the file is missing.
        ValueError: If the file is damaged, or its frames have a different size than ``camera``.
    """
    av = video_library()
    check_file(path)
    with open(path, "rb") as file:
        try:
            with av.open(file, format=CONTAINER) as container:
                if not container.streams.video:
                    raise ValueError(f"{path} has no video stream. {FIX}")
                stream = container.streams.video[0]
                if stream.codec_context is None:
                    raise ValueError(f"{path} has an unknown codec. {FIX}")
                _check_size(path, camera, stream.height, stream.width)
                stream.thread_type = "AUTO"
                yield container, stream
        except (av.FFmpegError, OSError) as error:
            # In a damaged file, FFmpeg may seek to a position before its start.
            # This fails with EINVAL.
            if not isinstance(error, av.FFmpegError) and error.errno != errno.EINVAL:
                raise
            cause = escaped(" ".join(str(error).split()))
            raise ValueError(
                f"{path} cannot be decoded: it is truncated or damaged ({cause}). {FIX}"
            ) from error


def _check_size(path: Path, camera: Camera, height: int, width: int) -> None:
    if (height, width) != (camera.height, camera.width):
        raise ValueError(
            f"{path}: frames of {camera.name} must have {camera.width} x {camera.height} pixels, "
            f"as in meta/info.json, got {width} x {height}. Correct the shape in this file, or "
            "copy the dataset again."
        )


def read_codec(path: Path, camera: Camera) -> str:
    """Return the name of the codec of a video, such as "av1"."""
    with open_video(path, camera) as (_, stream):
        return str(stream.codec.canonical_name)


def decode(
    path: Path, camera: Camera, times: Sequence[float], tolerance: float
) -> Iterator[np.ndarray]:
    """Yield the nearest frame for each time, in the order of ``times``.

    Args:
        path: The video.
        camera: Its camera.
        times: Times in seconds, in increasing order.
        tolerance: Maximum seconds between a time and its frame.

    Yields:
        uint8 [H, W, 3], or float32 metres [H, W] with 0 for no reading.

    Raises:
        FileNotFoundError: If the file is missing.
        ValueError: If the file is damaged, or has no frame near one of the times.
    """
    if not times:
        return
    pending = list(times)[::-1]
    before: tuple[float, Any] | None = None  # time and content of the previous frame
    with open_video(path, camera) as (container, stream):
        # decoding starts one tick earlier, because rounding could otherwise skip the first frame
        container.seek(max(0, round(pending[-1] / stream.time_base) - 1), stream=stream)
        for frame in container.decode(stream):
            if frame.pts is None:
                continue
            now = float(frame.pts * stream.time_base)
            while pending and before is not None and pending[-1] - before[0] <= now - pending[-1]:
                yield _pixels(path, camera, before, pending.pop(), tolerance)
            if not pending:
                return
            before = now, frame
        while pending:
            yield _pixels(path, camera, before, pending.pop(), tolerance)


def _pixels(
    path: Path, camera: Camera, frame: tuple[float, Any] | None, time: float, tolerance: float
) -> np.ndarray:
    distance = abs(frame[0] - time) if frame else float("inf")
    if frame is None or distance > tolerance:
        raise ValueError(
            f"{path} must have a frame at {time:.6f} s, but the nearest frame is {distance:.6f} s "
            f"away, more than the tolerance of {tolerance:g} s. Copy the dataset again, or set "
            "tolerance= to a larger value if its clock is inexact."
        )
    return _as_frame(path, camera, frame[1])


def _as_frame(path: Path, camera: Camera, frame: Any) -> np.ndarray:
    _check_size(path, camera, frame.height, frame.width)
    if camera.kind == RGB:
        return frame.to_ndarray(format=RGB_PIXELS)
    assert camera.code is not None
    return camera.code.metres(read_codes(path, frame))


def read_codes(path: Path, frame: Any) -> np.ndarray:
    """Return the codes of a depth frame, uint16 [H, W].

    Raises:
        ValueError: If the frame does not have 12 bits per pixel.
    """
    name = frame.format.name
    if not frame.format.components[0].bits == 12:
        raise ValueError(
            f"{path}: a depth video must have 12 bits per pixel ({DEPTH_PIXELS}), got "
            f"{short(name)}. Older datasets store images that only visualise depth; they cannot be "
            "converted to metres."
        )
    return frame.to_ndarray(format=DEPTH_PIXELS)


def encode(
    target: Path, frames: Iterable[np.ndarray], camera: Camera, encoding: Encoding, fps: int
) -> None:
    """Write a video with ``fps`` frames per second.

    The frames are uint8 [H, W, 3], or float32 metres [H, W].
    """
    av = video_library()
    with open_output(target, "wb") as file, av.open(file, "w", format=CONTAINER) as output:
        output_stream = _add_stream(output, camera, encoding, fps)
        for frame in frames:
            pixels = frame if camera.code is None else camera.code.codes(frame)
            output.mux(output_stream.encode(_video_frame(pixels)))
        output.mux(output_stream.encode(None))


def _add_stream(output: Any, camera: Camera, encoding: Encoding, rate: Any) -> Any:
    stream = output.add_stream(encoding.codec, rate, options=encoding.options)
    stream.width, stream.height = camera.width, camera.height
    stream.pix_fmt = encoding.pixels
    return stream


def corrupt_video(
    source: Path,
    target: Path,
    camera: Camera,
    encoding: Encoding,
    corrupt: Callable[[np.ndarray, float, int], np.ndarray],
) -> None:
    """Write a video with corrupted frames and the times of the original frames.

    Args:
        source: The original.
        target: The file to write.
        camera: Its camera.
        encoding: How the frames are encoded.
        corrupt: Function that corrupts a frame. Its arguments are the frame (uint8 [H, W, 3] or
            float32 metres [H, W]), the time in seconds, and the frame number in the video.

    Raises:
        ValueError: If the original is damaged.
    """
    av = video_library()
    with (
        open_video(source, camera) as (container, stream),
        # Python opens the file, so that a full disk is not reported as a damaged video
        open_output(target, "wb") as file,
        av.open(file, "w", format=CONTAINER) as output,
    ):
        rate = stream.average_rate or stream.guessed_rate or Fraction(30)
        output_stream = _add_stream(output, camera, encoding, rate)
        output_stream.codec_context.time_base = stream.time_base
        for number, frame in enumerate(container.decode(stream)):
            clean = _as_frame(source, camera, frame)
            if frame.pts is None:
                raise ValueError(f"{source}: frame {number} has no timestamp. {FIX}")
            corrupted = corrupt(clean, float(frame.pts * stream.time_base), number)
            if camera.code is not None:  # unchanged depth keeps its code
                codes = camera.code.codes(corrupted)
                corrupted = np.where(corrupted == clean, read_codes(source, frame), codes)
            new = _video_frame(corrupted)
            new.pts, new.time_base = frame.pts, stream.time_base
            output.mux(output_stream.encode(new))
        output.mux(output_stream.encode(None))


def _video_frame(pixels: np.ndarray) -> Any:
    """Convert RGB [H, W, 3] or depth codes [H, W] to a frame for the encoder."""
    form = RGB_PIXELS if pixels.ndim == 3 else DEPTH_PIXELS
    return video_library().VideoFrame.from_ndarray(pixels, format=form)
