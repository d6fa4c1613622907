"""A folder for each instance of an FMU, so that no other instance or run sees what the FMU writes there.

What is unpacked in the cache is shared by all runs of all processes. An FMU may write into its resources, in place, so
links to the files would not keep it from changing them: they are copied, and what lies beside them is linked. A copy is
made again before the next instance if the FMU has changed anything: each begins with what the archive holds.
"""

from __future__ import annotations

import os
import shutil
from contextlib import suppress
from pathlib import Path

from dse.cache import stamp
from dse.domain.fmu import FmuModel
from dse.errors import fail
from dse.scratch import new_folder


class InstanceFolder:
    """The folder of one instance of *model* after the other; :meth:`remove` it in the end.

    An FMU without resources has no folder of its own, as making one costs more than the rest of a short run: what it
    writes in their place is removed. Raises DseError if the folder cannot be made.
    """

    def __init__(self, model: FmuModel) -> None:
        self._model = model
        self._own: Path | None = None
        if model.folder.is_dir() and (model.version == 1 or (model.folder / "resources").is_dir()):
            self._own = new_folder()
            self._fill(self._own)

    @property
    def location(self) -> str:
        """What the FMU is told, as its standard wants it.

        A file URI in FMI 2, a path that ends in a separator in FMI 3; in FMI 1 the URI of the FMU's own folder.
        """
        folder = self._own or self._model.folder.resolve()
        if self._model.version == 1:
            return folder.as_uri()
        place = folder / "resources"
        return place.as_uri() if self._model.version == 2 else f"{place}{os.sep}"  # FMI 2

    def renew(self) -> None:
        """Take back what the instances before have changed. Raises DseError if that is not possible."""
        if self._own is None or stamp(self._own) == self._filled:
            return
        for entry in list(os.scandir(self._own)):
            _remove(entry)
        self._fill(self._own)

    def remove(self) -> None:
        """Remove it; safe to call twice."""
        written = self._own or self._model.folder / "resources"
        if written.is_dir():
            shutil.rmtree(written, ignore_errors=True)

    def _fill(self, own: Path) -> None:
        try:
            for entry in os.scandir(self._model.folder):
                _bring(Path(entry.path), own / entry.name)
            self._filled = stamp(own)
        except OSError as error:
            what = f"{self._model.identifier}: its resources cannot be copied: {error.strerror or error}"
            raise fail(what, hint="make room, or set TMPDIR to a folder that has some") from error


def _bring(path: Path, target: Path) -> None:
    if path.name != "resources":
        with suppress(OSError):  # as on Windows, which lets few users make links
            target.symlink_to(path.absolute())
            return
    _copy(path, target)


def _copy(path: Path, target: Path) -> None:
    """By hand: what `shutil` has for folders sets modes and times, which a sandbox refuses."""
    if path.is_dir():
        target.mkdir()
        for entry in os.scandir(path):
            _copy(Path(entry.path), target / entry.name)
    else:
        shutil.copyfile(path, target)


def _remove(entry: os.DirEntry[str]) -> None:
    if entry.is_dir(follow_symlinks=False):
        shutil.rmtree(entry.path, ignore_errors=True)
    else:
        with suppress(OSError):
            Path(entry.path).unlink()
