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

from dse.api import metric_rows, results, what_if_run
from dse.errors import DseError, fail
from dse.json_data import read_json, read_noun
from dse.report import content_of_run

T = TypeVar("T")

_DIGITS = 7
"""Digits of a waveform's values, which are drawn and not computed with."""

_one_at_a_time = Lock()


@dataclass(frozen=True, slots=True)
class AskedPoint:
    """A request to simulate the *point* of a *configuration*; the user *accepts* that this has changed."""

    configuration: str
    point: Mapping[str, float]
    accepts: tuple[str, ...] = ()


def read_request(content: bytes | str, shape: type[T]) -> T:
    """The noun of type *shape* in a request's body or a message. DseError for anything else."""
    try:
        noun: T = read_noun(read_json(content), shape, "request")
    except ValueError as error:
        raise fail(f"the request is invalid: {error}") from error
    return noun


def simulated_point(folder: Path, asked: AskedPoint, workspace: Path | None = None) -> dict[str, object]:
    """What came of the point, simulated now: metrics, verdicts and waveforms; or, with nothing simulated, what has
    changed in the workspace that the user has not accepted. Raises DseError; also while it is busy."""

    def require_accepted(changed: tuple[str, ...]) -> None:
        if not {*changed} <= {*asked.accepts}:
            raise _ChangedError(changed)

    try:
        with the_only_one():
            tried = what_if_run(
                results(folder).definition,
                asked.configuration,
                asked.point,
                near=folder,
                workspace=workspace,
                on_changed=require_accepted,
            )
    except _ChangedError as error:
        return {"changed": [*error.changed], "simulated": False}
    run = tried.run
    rows = metric_rows(run.noun, run.definition, run.check) if run.is_done else ()
    return {
        "simulated": True,
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


class _ChangedError(Exception):
    """The workspace has *changed* since the study was made."""

    def __init__(self, changed: tuple[str, ...]) -> None:
        super().__init__(", ".join(changed))
        self.changed = changed


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
