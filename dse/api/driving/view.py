"""What a driver sees of a run while it goes on: the scene's columns, worked out from the signals of one moment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dse.errors import fail

if TYPE_CHECKING:
    from dse.testbench import WiredBench

_FASTEST = 70.0
_EVERYWHERE = 1e9


class View:
    """The scene of *wired*, which lasts *length* s. Every column of it is a sum of signals with fixed weights.

    *document* is what the page of a replay has, with all places of others and sensors; *columns* are the names of what
    `of` gives. DseError if nothing says where a car is.
    """

    def __init__(self, wired: WiredBench, length: float) -> None:
        from dse.api.studies.scenes import scene_of_signals
        from dse.report import SceneSignals, scene_document

        bench = wired.bench
        told = SceneSignals(
            wired.signals, {name: setting.value for name, setting in wired.settings.items()}, bench.figures
        )
        if not told.is_scene:
            what = "no part gives the position of a car: neither 'motion.x' nor 'position' and 'gap'"
            raise fail(f"bench '{bench.name}' cannot be driven: {what}", bench.where)
        self.wanted = told.wanted
        found = _Columns()
        # Each signal 1 and all others 0, after nothing but 0: so the weights are read off, whatever a scene is made of.
        probe = np.vstack([np.zeros(len(self.wanted)), np.eye(len(self.wanted))])
        columns = dict(zip(self.wanted, probe.T, strict=True))
        straight = np.array([[0.0, 0.0], [_FASTEST * length, 0.0]])
        times = np.arange(len(probe), dtype=np.float64)
        scene = scene_of_signals(wired, told, columns, times, way=straight, reach=_EVERYWHERE)
        self.document = scene_document(scene, found)
        self.document["columns"] = {}
        self.columns = tuple(found.values)
        table = np.array([np.broadcast_to(values, len(probe)) for values in found.values.values()])
        self._offsets = np.ascontiguousarray(table[:, 0])
        weights = table[:, 1:] - table[:, :1]
        self._rows, self._places = np.nonzero(weights)
        self._weights = weights[self._rows, self._places]

    def of(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The columns where the signals `wanted` have *values*."""
        columns = self._offsets.copy()
        np.add.at(columns, self._rows, self._weights * values[self._places])
        return columns


class _Columns:
    def __init__(self) -> None:
        self.values: dict[str, NDArray[np.float64]] = {}

    def add(self, name: str, kind: str, values: NDArray[np.floating]) -> None:  # noqa: ARG002  # all go as doubles
        self.values[name] = np.asarray(values, np.float64)


def frame(head: Sequence[float], columns: NDArray[np.float64]) -> bytes:
    """A frame as it goes to a page: *head*, then the columns, as doubles, little-endian."""
    return np.concatenate([head, columns]).astype("<f8").tobytes()
