"""A scene as a picture, or as many of them that move."""

from __future__ import annotations

import io
import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO, cast

import numpy as np

from dse.errors import fail
from dse.report.scene.camera import Camera, camera_on
from dse.scratch import make_folder, write_whole, written_whole

VIEWS = ("chase", "driver", "top", "side")
"""The cameras."""

MOVING = (".webp", ".gif")
"""Animated pictures that are written here."""

VIDEOS = (".mp4", ".webm")
"""Videos, which the program ffmpeg writes."""

SIZES = (200, 4096)
"""Least and most pixels each way."""

_MOST_FRAMES = 20_000


@dataclass(frozen=True, slots=True)
class Shot:
    """From *at* s, by the camera *view*, *size* pixels wide and high; with a *rate* of frames a second it goes on until
    *until* s, or the end."""

    at: float = 0.0
    until: float | None = None
    rate: float | None = None
    view: str = "chase"
    size: tuple[int, int] = (1280, 720)

    def __post_init__(self) -> None:
        """Raises DseError for what cannot be shot."""
        low, high = SIZES
        if not all(low <= side <= high for side in self.size):
            raise fail(
                f"{self.size[0]}x{self.size[1]} is not a size of a picture", hint=f"{low} to {high} pixels each way"
            )
        if self.view not in VIEWS:
            raise fail(f"there is no camera '{self.view}'", hint=f"one of {', '.join(VIEWS)}")


def require_target(target: Path, shot: Shot) -> None:
    """Raise DseError if *shot* cannot be written as *target*, which its suffix says, on this machine."""
    kind = target.suffix.lower()
    if shot.rate is None:
        if kind != ".png":
            raise fail(
                f"a picture of a scene is a PNG, not '{target.name}'", hint="-o PICTURE.png; or a film: --frames 25"
            )
    elif kind in VIDEOS:
        if shutil.which("ffmpeg") is None:
            others = ", ".join(MOVING)
            raise fail(
                f"a {kind} needs the program ffmpeg, which is not on the path", hint=f"install it, or take {others}"
            )
    elif kind not in (*MOVING, ""):
        kinds = ", ".join((*MOVING, *VIDEOS))
        raise fail(f"a film is not written as '{target.name}'", hint=f"{kinds}, or a folder for numbered PNG files")


def film(page: str, shot: Shot, target: Path, tell: Callable[[str], None] = lambda _: None) -> int:
    """Write what *shot* has of the scene of *page* to *target*; returns how many frames.

    A PNG without a rate; with one a file of `MOVING` or `VIDEOS`, or a folder of numbered PNG files. Raises DseError.
    """
    require_target(target, shot)
    with camera_on(page, shot.size) as camera:
        moments = _moments(shot, camera.seconds)
        frames = _taken(camera, shot.view, moments, tell)
        _write(frames, target, shot.rate)
    return len(moments)


def _moments(shot: Shot, seconds: float) -> list[float]:
    """Raises DseError if the run is over before they begin, or if they are too many."""
    if shot.at > seconds + 1e-9:
        raise fail(f"the run is over at {seconds:g} s, before {shot.at:g} s", hint="give an earlier moment with --at")
    if shot.rate is None:
        return [shot.at]
    end = seconds if shot.until is None else min(shot.until, seconds)
    if end < shot.at:
        raise fail(f"the film ends at {end:g} s, before it begins at {shot.at:g} s")
    count = int((end - shot.at) * shot.rate + 1e-6) + 1
    if count > _MOST_FRAMES:
        raise fail(f"{count:,} frames are more than {_MOST_FRAMES:,}", hint="film a part of the run: --at, --until")
    moments: list[float] = (shot.at + np.arange(count) / shot.rate).tolist()
    return moments


def _taken(camera: Camera, view: str, moments: list[float], tell: Callable[[str], None]) -> Iterator[bytes]:
    for number, moment in enumerate(moments, start=1):
        tell(f"frame {number} of {len(moments)}")
        yield camera.picture(moment, view)


def _write(frames: Iterator[bytes], target: Path, rate: float | None) -> None:
    kind = target.suffix.lower()
    if rate is None:
        write_whole(target, next(frames))
    elif kind in VIDEOS:
        _encode(frames, target, rate)
    elif kind in MOVING:
        _animate(frames, target, rate)
    else:
        make_folder(target)
        for number, frame in enumerate(frames, start=1):
            write_whole(target / f"frame_{number:05}.png", frame)


def _animate(frames: Iterator[bytes], target: Path, rate: float) -> None:
    from PIL import Image  # matplotlib brings it

    def opened() -> Iterator[Image.Image]:
        for frame in frames:
            yield Image.open(io.BytesIO(frame)).convert("RGB")

    images = opened()
    first = next(images)
    options = {"quality": 80, "method": 2} if target.suffix.lower() == ".webp" else {}
    kind = target.suffix[1:].upper()
    with written_whole(target) as path, path.open("wb") as file:
        first.save(file, kind, save_all=True, append_images=images, duration=1000 / rate, loop=0, **options)


def _encode(frames: Iterable[bytes], target: Path, rate: float) -> None:
    """By ffmpeg, which reads the frames as they are taken."""
    program = shutil.which("ffmpeg") or "ffmpeg"
    read = f"-f image2pipe -framerate {rate:g} -c:v png -i -"
    # Most players want colours at half the pixels, thus an even number of them.
    made = "-vf pad=ceil(iw/2)*2:ceil(ih/2)*2 -pix_fmt yuv420p"
    with written_whole(target) as path, TemporaryFile() as said:
        command = [program, "-y", "-loglevel", "error", *read.split(), *made.split(), str(path.absolute())]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said) as process:
            with suppress(BrokenPipeError):  # it has ended, and says why
                for frame in frames:
                    cast("BinaryIO", process.stdin).write(frame)
            with suppress(BrokenPipeError):
                cast("BinaryIO", process.stdin).close()
        if process.returncode:
            said.seek(0)
            told = said.read().decode("utf-8", "replace").strip()[-300:]
            raise fail(f"ffmpeg could not write {target.name}: {told or 'it prints nothing'}")
