"""One configuration on its bench, ready to be simulated again and again."""

from __future__ import annotations

import io
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.api.studies.run import Run
from dse.exploration import simulate_alone
from dse.storage import StudyHeader
from dse.testbench import make_runner

if TYPE_CHECKING:
    from dse.domain.definition import StudyDefinition
    from dse.testbench import Prepared


@dataclass(frozen=True, slots=True)
class PreparedRun:
    """The *configuration* on its *bench*; *units* are those of the waveforms that are kept."""

    configuration: str
    bench: Prepared
    definition: StudyDefinition
    units: Mapping[str, str]

    def simulate(self, *, sandbox: bool = False) -> Run:
        """The run, made in a process of its own, with waveforms."""
        measures = StudyHeader(self.definition).measures
        noun = simulate_alone(self.bench, make_runner, self.configuration, measures, sandboxed=sandbox)
        return Run(noun, self.definition, self.units)

    def packed(self) -> tuple[bytes, frozenset[str]]:
        """What `unpacked_run` takes, and the files and folders that are named in it."""
        content, paths = io.BytesIO(), set[Path]()
        _Pickler(content, paths).dump(self)
        return content.getvalue(), frozenset(map(str, paths))


def unpacked_run(content: bytes) -> PreparedRun:
    """What `PreparedRun.packed` made on this machine, by this version."""
    found = pickle.loads(content)  # noqa: S301  # of our own cache, as are the libraries that it names
    if not isinstance(found, PreparedRun):
        raise TypeError(f"{type(found)} instead of a prepared run")
    return found


class _Pickler(pickle.Pickler):
    """Notes the *paths* in what it packs."""

    def __init__(self, file: io.BytesIO, paths: set[Path]) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self._paths = paths

    def reducer_override(self, value: Any) -> Any:
        """Pack *value* as ever."""
        if isinstance(value, Path):
            self._paths.add(value)
        return NotImplemented
