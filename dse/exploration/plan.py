"""What is still to be done of a study, cut into batches.

Where a chunk starts and ends, and so the name and the bytes of a waveform file, depends on the study and on what is
known of its FMUs: not on the number of workers, nor on how often the exploration was stopped.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from itertools import groupby
from types import MappingProxyType

from dse.domain.run import RunRequest
from dse.exploration.job import Batch
from dse.results.waveforms import file_name

_LARGEST_CHUNK = 32
_FEWEST_CHUNKS = 64
_NO_LIMITS: Mapping[str, int] = MappingProxyType({})


def chunks(requests: Sequence[RunRequest], most_runs: Mapping[str, int] = _NO_LIMITS) -> Iterator[Sequence[RunRequest]]:
    """*requests*, sorted by number, in pieces of one configuration: at most 32 runs, fewer in a small study.

    *most_runs* of a configuration go into one piece where a process can make only so many.
    """
    size = max(1, min(_LARGEST_CHUNK, len(requests) // _FEWEST_CHUNKS))
    for configuration, group in groupby(requests, key=lambda request: request.configuration):
        members = list(group)
        length = min(size, most_runs.get(configuration, size))
        yield from (members[start : start + length] for start in range(0, len(members), length))


def missing_runs(
    requests: Sequence[RunRequest], finished: AbstractSet[int], most_runs: Mapping[str, int] = _NO_LIMITS
) -> Iterator[Batch]:
    """Batches for the runs that are not *finished*, without waveforms."""
    for identity, chunk in enumerate(chunks(requests, most_runs)):
        todo = [request for request in chunk if request.number not in finished]
        if todo:
            yield _batch(identity, todo, "")


def missing_waveforms(
    requests: Sequence[RunRequest],
    wanted: AbstractSet[int],
    kept: Mapping[int, str],
    most_runs: Mapping[str, int] = _NO_LIMITS,
) -> Iterator[Batch]:
    """Batches for the runs that are *wanted* with waveforms and not *kept*.

    The file of a chunk is written as a whole: runs that are in it already are simulated with the others.
    """
    for identity, chunk in enumerate(chunks(requests, most_runs)):
        if any(request.number in wanted and request.number not in kept for request in chunk):
            todo = [r for r in chunk if kept.get(r.number) or (r.number in wanted and r.number not in kept)]
            yield _batch(identity, todo, file_name(chunk[0].number, chunk[-1].number))


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
