"""What is still to be done of a study, cut into batches.

Where a chunk starts and ends, and so the name and the bytes of a waveform file, follows from what was asked for and
from what is known of the FMUs: not from the number of workers, nor from how often the exploration was stopped.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from types import MappingProxyType

from dse.domain.run import RunRequest
from dse.exploration.job import Batch
from dse.storage.asks import Asks
from dse.storage.waveforms import file_name

_NO_LIMITS: Mapping[str, int] = MappingProxyType({})


def missing_runs(
    missing: Iterable[int], requests: Mapping[int, RunRequest], asks: Asks, most: Mapping[str, int] = _NO_LIMITS
) -> Iterator[Batch]:
    """Batches for the *missing* runs, without waveforms; *requests* by number.

    Of a configuration in *most*, a process can make only so many.
    """

    def chunk(number: int) -> tuple[int, int]:
        return asks.chunk(number, most.get(requests[number].configuration))

    for (first, _), numbers in groupby(sorted(missing), chunk):
        yield _batch(first, [requests[number] for number in numbers], "")


def missing_waveforms(
    missing: Iterable[int],
    requests: Mapping[int, RunRequest],
    asks: Asks,
    kept: Mapping[int, str],
    most: Mapping[str, int] = _NO_LIMITS,
) -> Iterator[Batch]:
    """Batches for the runs whose waveforms are *missing*.

    The file of a chunk is written as a whole: runs whose waveforms are *kept* in it already are simulated with them.
    """

    def chunk(number: int) -> tuple[int, int]:
        return asks.chunk(number, most.get(requests[number].configuration))

    for (first, last), numbers in groupby(sorted(missing), chunk):
        wanted = set(numbers)
        todo = [requests[n] for n in range(first, last + 1) if n in requests and (n in wanted or kept.get(n))]
        yield _batch(first, todo, file_name(first, last))


def _batch(identity: int, todo: Sequence[RunRequest], file: str) -> Batch:
    names = tuple(todo[0].point)
    return Batch(
        identity,
        todo[0].configuration,
        names,
        tuple(request.number for request in todo),
        tuple(tuple(request.point[name] for name in names) for request in todo),
        file,
    )
