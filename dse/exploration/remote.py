"""A batch on its way to another process or machine, and what comes back: for executors other than the local one.

A parcel names files of the FMU cache by their place in it, and so by the content of their FMUs: where it is carried out
they are looked for in the cache there.
"""

from __future__ import annotations

import io
import pickle
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import Any

from dse.cache import cache_folder
from dse.domain.fmu import FmuModel
from dse.domain.run import Run, RunRequest, Waveforms
from dse.errors import FreshProcessNeeded, Problem, fail
from dse.exploration.failures import checked_run, failed_run, in_words
from dse.exploration.work import PROGRESS_BYTES, Batch, MakeRunner, Runnable, Runner, Sink, Work
from dse.scratch import ScratchFolder
from dse.storage import Measures, RowBlock, block_of, write_waveforms


@dataclass(frozen=True, slots=True)
class Parcel:
    """What is needed to make the runs of *batch*; picklable, without any path of this machine."""

    batch: Batch
    configuration: bytes
    make_runner: MakeRunner
    measures: Measures


@dataclass(frozen=True, slots=True)
class Carried:
    """The results of a parcel: a row for each run, and the file of waveforms with those of the runs *kept*."""

    block: RowBlock
    kept: tuple[int, ...] = ()
    waveforms: bytes = b""


def parcel(work: Work, batch: Batch) -> Parcel:
    """*batch* of *work*, ready to be sent. DseError if it needs files that are not in the cache of FMUs."""
    content, elsewhere = packed(work.configurations[batch.configuration])
    if elsewhere:
        raise fail(f"the configuration {batch.configuration} needs {elsewhere[0]}, which only this machine has")
    return Parcel(batch, content, work.make_runner, work.measures)


def carry_out(parcel: Parcel) -> Carried:
    """Make the runs, in this process. A run that fails is a row; an FMU that crashes takes the process with it.

    Raises FreshProcessNeeded if only a process that made no runs before can make them.
    """
    batch = parcel.batch
    configuration = pickle.loads(parcel.configuration)  # noqa: S301  # from our own coordinator
    try:
        runner = parcel.make_runner(configuration, memoryview(bytearray(PROGRESS_BYTES)))
    except FreshProcessNeeded:
        raise
    except Exception as error:  # noqa: BLE001  # each of its runs fails, other configurations go on
        problem = in_words(error)
        return Carried(block_of([failed_run(request, problem) for request in batch.requests], parcel.measures))
    try:
        if runner.runs_left is not None and runner.runs_left < len(batch.requests):
            raise FreshProcessNeeded(Problem(f"this process can make {runner.runs_left} runs of {batch.configuration}"))
        runs = [_made(runner, request, parcel) for request in batch.requests]
    finally:
        runner.close()
    kept = [(run.request.number, run.waveforms) for run in runs if run.waveforms is not None]
    return Carried(block_of(runs, parcel.measures), tuple(number for number, _ in kept), _file(kept, batch.file))


def hand_over(carried: Carried, batch: Batch, work: Work, sink: Sink) -> None:
    """Store the file of waveforms that came back and tell *sink* that *batch* is done."""
    if carried.kept:
        aside = work.waveforms / f"{batch.file}.part"
        aside.write_bytes(carried.waveforms)
        aside.replace(work.waveforms / batch.file)
    sink.rows(batch, carried.block)
    sink.ended(batch, carried.kept)


def packed(configuration: Runnable) -> tuple[bytes, tuple[Path, ...]]:
    """*configuration* for ``pickle.loads``, and the absolute paths in it that lie outside of the cache of FMUs."""
    stream = io.BytesIO()
    pickler = _Pickler(stream, protocol=pickle.HIGHEST_PROTOCOL)
    pickler.dump(configuration)
    return stream.getvalue(), tuple(pickler.elsewhere)


class _Pickler(pickle.Pickler):
    """Writes paths in the cache as places in it."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._cache = cache_folder().absolute()
        self.elsewhere: list[Path] = []

    def reducer_override(self, value: object) -> Any:
        if isinstance(value, FmuModel) and value.archive.is_absolute():
            # Only messages name it once the FMU is unpacked.
            return _itself, (replace(value, archive=Path(value.archive.name)),)
        if isinstance(value, Path) and value.is_absolute():
            if value.is_relative_to(self._cache):
                return _in_cache, (value.relative_to(self._cache).as_posix(),)
            self.elsewhere.append(value)
        return NotImplemented


def _itself(value: Any) -> Any:
    return value


def _in_cache(place: str) -> Path:
    return cache_folder().absolute() / PurePath(place)


def _made(runner: Runner, request: RunRequest, parcel: Parcel) -> Run:
    try:
        return checked_run(runner.run(request, keep=parcel.batch.keep), parcel.measures)
    except Exception as error:  # noqa: BLE001  # a failed run is a row, not the end of the study
        return failed_run(request, in_words(error))


def _file(kept: list[tuple[int, Waveforms]], name: str) -> bytes:
    if not kept:
        return b""
    with ScratchFolder() as scratch:
        write_waveforms(Path(scratch) / name, kept)
        return (Path(scratch) / name).read_bytes()
