"""Work on its way to another process or machine, and what comes back."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Mapping
from dataclasses import dataclass

import dse
from dse.errors import fail
from dse.exploration.remote.machine import Machine
from dse.exploration.work import Batch, MakeRunner
from dse.fmu import this_platform
from dse.storage import Attempt, Measures, RowBlock


@dataclass(frozen=True, slots=True)
class WorkMessage:
    """What is needed to make the runs of *batches*, without any path of this machine; *study* names what they are of.

    *needs* has for each configuration the entries of the cache it refers to, with the digests of their contents.
    *configurations* and *entries* (by digest) are those that were asked for. The run *canary* is made by every worker
    before any other, so that its bits can be compared.
    """

    study: str
    batches: tuple[Batch, ...]
    make_runner: MakeRunner
    measures: Measures
    needs: Mapping[str, Mapping[str, str]]
    canary: Batch
    configurations: Mapping[str, bytes]
    entries: Mapping[str, bytes]


@dataclass(frozen=True, slots=True)
class MissingEntries:
    """The *worker* (its address, "" if it has none) needs these configurations and entries of the cache first."""

    configurations: tuple[str, ...]
    entries: tuple[str, ...]
    worker: str


@dataclass(frozen=True, slots=True)
class WorkerError:
    """The machine *host* could not make the runs for a reason that is not theirs."""

    host: str
    words: str


@dataclass(frozen=True, slots=True)
class BatchRows:
    """The results of a batch: rows, the runs that have waveforms, and files with these."""

    blocks: tuple[RowBlock, ...]
    kept: tuple[int, ...] = ()
    files: tuple[bytes, ...] = ()


@dataclass(frozen=True, slots=True)
class BatchResults:
    """The results of a message, a piece for each batch, made by *machine* in *seconds*.

    *retried* runs were made twice there, *attempts* are the tries that gave no row. *canary* is the run by which
    machines are compared, if it was made just now.
    """

    pieces: tuple[BatchRows, ...]
    machine: Machine
    seconds: float
    retried: int
    attempts: tuple[Attempt, ...]
    canary: RowBlock | None


Answer = BatchResults | MissingEntries | WorkerError


def message_bytes(message: WorkMessage) -> bytes:
    """*message* with what tells whether a worker can open it."""
    return pickle.dumps((_kind(), pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)))


def read_message(content: bytes, host: str) -> WorkMessage:
    """The message in *content*; DseError if it was sealed by another version of dse or on another platform."""
    kind, inside = pickle.loads(content)  # noqa: S301  # from our own coordinator
    if kind != _kind():
        what = f"the worker on {host} has {_kind()}, this machine {kind}"
        raise fail(what, hint="give workers the same version of dse and a machine of the same kind")
    message: WorkMessage = pickle.loads(inside)  # noqa: S301  # same
    return message


def _kind() -> str:
    return f"dse {dse.__version__} for {this_platform().name}, Python {sys.version_info[0]}"
