"""What the script of a served page asks for and is told, as plain data."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from dse.api import metric_rows, results, try_point
from dse.errors import DseError, fail
from dse.json_data import read_json, read_noun
from dse.report import content_of_run

T = TypeVar("T")

_DIGITS = 7
"""Digits of a waveform's values, which are drawn and not computed with."""

_one_at_a_time = Lock()


@dataclass(frozen=True, slots=True)
class AskedPoint:
    """A point to simulate."""

    configuration: str
    point: Mapping[str, float]


def read_request(content: bytes | str, shape: type[T]) -> T:
    """The noun of type *shape* in a request's body or a message. DseError for anything else."""
    try:
        noun: T = read_noun(read_json(content), shape, "request")
    except ValueError as error:
        raise fail(f"the request is invalid: {error}") from error
    return noun


def simulated(folder: Path, configuration: str, point: Mapping[str, float]) -> dict[str, object]:
    """What came of *point*, simulated now: metrics, verdicts and waveforms. Raises DseError; also while it is busy."""
    with the_only_one():
        definition = results(folder).definition
        tried = try_point(definition, configuration, point, near=folder)
    run = tried.run
    rows = metric_rows(run.noun, run.definition, run.check) if run.is_done else ()
    return {
        "done": run.is_done,
        "problem": run.problem,
        "changed": [*tried.changed],
        "metrics": [[r.title, r.value, r.requirement, r.bound, r.margin, r.verdict] for r in rows],
        "figures": [
            {
                "title": each.title or each.name,
                "unit": each.unit_symbol,
                "current": each.current_label,
                "target": each.target_label or "target",
                "time": _short(each.time),
                "values": _short(each.current[0]),
                "targets": None if each.target is None else _short(np.broadcast_to(each.target[0], each.time.shape)),
            }
            for each in content_of_run(run.noun, run.definition).figures
        ],
    }


@contextmanager
def the_only_one() -> Iterator[None]:
    """Within it one run is simulated for all who ask; BusyError if another one is."""
    if not _one_at_a_time.acquire(blocking=False):
        raise BusyError
    try:
        yield
    finally:
        _one_at_a_time.release()


class BusyError(Exception):
    """Another point is being simulated."""


def problem_of(error: DseError) -> dict[str, object]:
    """*error* in words."""
    return {
        "problems": [
            {"where": str(each.where or ""), "what": each.what, "hint": each.hint or ""} for each in error.problems
        ]
    }


def _short(values: NDArray[np.floating]) -> list[float | None]:
    return [float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None for value in values.tolist()]
