"""Reads how long, how finely and what a test bench simulates."""

from __future__ import annotations

import math
from collections.abc import Mapping

from dse.domain.bench import Simulation
from dse.errors import DseError, Problem
from dse.formats.yaml import Document
from dse.loading.bench.memory import read_memory
from dse.loading.documents import SimulationSection
from dse.loading.values import Raw, read_number, read_unit

_MAX_STEPS = 10_000_000
_MAX_TIMEOUT = 10_000_000.0


def read_simulation(document: Document, section: SimulationSection, problems: list[Problem]) -> Simulation:
    """The section ``simulation``; what is wrong with it is added to *problems*, and the result is then of no use."""
    raw: dict[str, Raw] = {"stop": section.stop, "step": section.step}
    if section.record_every is not None:
        raw["record_every"] = section.record_every
    times = _times(document, {**raw, "timeout": section.timeout}, problems)
    if "stop" in times and "step" in times and times["stop"] > _MAX_STEPS * times["step"]:
        what = f"'stop' ({section.stop}) takes more than {_MAX_STEPS:,} steps of {section.step}"
        problems.append(Problem(what, document.place(("simulation", "stop")), "use a longer step or an earlier stop"))
    else:
        _require_multiples(document, raw, times, problems)
    for number, name in enumerate(section.record):
        if name in section.record[:number]:
            problems.append(
                Problem(f"'{name}' is recorded twice", document.place(("simulation", "record", number)), "remove one")
            )
    return Simulation(
        times.get("stop", 1.0),
        times.get("step", 1.0),
        tuple(section.record),
        times.get("record_every", times.get("step", 1.0)),
        times.get("timeout", 1.0),
        document.key(("simulation",)),
        memory=read_memory(section.memory, document.place(("simulation", "memory")), problems),
    )


def _times(document: Document, raw: Mapping[str, Raw], problems: list[Problem]) -> dict[str, float]:
    """The times in seconds that can be used; one that cannot is reported once and checked no further."""
    times: dict[str, float] = {}
    seconds = read_unit("s", document.place(("simulation",)))
    for key, text in raw.items():
        where = document.place(("simulation", key))
        try:
            value = read_number(text, seconds, where)
        except DseError as error:
            problems += error.problems
            continue
        if value <= 0:
            problems.append(Problem(f"'{key}' must be positive, not {text}", where))
        elif key == "timeout" and value > _MAX_TIMEOUT:
            problems.append(Problem(f"'timeout' is longer than {_MAX_TIMEOUT:.0f} s", where, "use a shorter one"))
        else:
            times[key] = value
    return times


def _require_multiples(
    document: Document, raw: Mapping[str, Raw], times: Mapping[str, float], problems: list[Problem]
) -> None:
    for whole, part in (("stop", "step"), ("record_every", "step"), ("stop", "record_every")):
        if whole in times and part in times and not _divides(times[part], times[whole]):
            problems.append(
                Problem(
                    f"'{whole}' ({raw[whole]}) is not a multiple of '{part}' ({raw[part]})",
                    document.place(("simulation", whole)),
                    "runs have a fixed number of equal steps",
                )
            )


def _divides(part: float, whole: float) -> bool:
    ratio = whole / part
    return math.isfinite(ratio) and round(ratio) >= 1 and abs(ratio - round(ratio)) <= 1e-9 * ratio
