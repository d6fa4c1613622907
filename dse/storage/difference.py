"""A run that was simulated again against the one that is stored: whether it is the same, and whether from the same."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from dse.domain.definition import StudyDefinition
from dse.domain.noise import DRAW
from dse.domain.run import Outcome, Run, Waveforms

_SECTIONS = {
    "metrics": ("metric", ("expression",)),
    "requirements": ("requirement", ("metric", "at_most", "at_least", "exercised_when")),
}
"""What decides results in the entries of a definition; the rest is titles and units of display."""

_SHOWN = {
    "figures": ("figure", ("current", "target")),
    "variables": ("design variable", ("low", "high", "levels", "nominal")),
}
_OF_CONFIGURATIONS = {
    "components": "components",
    "wires": "connections",
    "inside": "texts and conversions",
    "columns": "what is recorded",
}


def changed_results(stored: Run, again: Run) -> list[str]:
    """In which results *again* is not *stored*; [] if they are the same bit for bit.

    Compared are outcome, problem, metrics, verdicts and margins, and waveforms if *stored* has them. NaN equals NaN;
    the sign of a metric's or margin's zero is not compared, as SQLite does not keep it.
    """
    if stored.outcome is not again.outcome:
        return [f"{stored.outcome} became {again.outcome}"]
    found = [
        name for name in _names(stored.metrics, again.metrics) if not _same_at(name, stored.metrics, again.metrics)
    ]
    # Only a failed run's problem is a result; a run that came to its end may carry a note of the exploration.
    if stored.outcome is Outcome.FAILED and stored.problem != again.problem:
        found.append(f"its problem, now '{again.problem}'")
    found += _judgement_differences(stored, again)
    return found + (_waveform_differences(stored.waveforms, again.waveforms) if stored.waveforms else [])


def changed_inputs(stored: StudyDefinition, again: StudyDefinition, run: Run) -> list[str]:
    """What decides the results of *run* and is not the same in the two definitions, its own point aside.

    *again* may hold just the configuration of *run*.
    """
    found = [f"FMU {name}" for name, digest in again.fmus.items() if stored.fmus.get(name) != digest]
    for section, (what, keys) in _SECTIONS.items():
        before, after = (_deciding(getattr(definition, section), keys) for definition in (stored, again))
        found += [f"{what} {name}" for name in _names(before, after) if before.get(name) != after.get(name)]
    found += _simulation_differences(stored, again, ("stop", "step", "record_every"))
    was, now = (definition.configuration(run.request.configuration) for definition in (stored, again))
    found += [
        f"{key} of the configuration" for key in ("components", "wires") if getattr(was, key) != getattr(now, key)
    ]
    varied = {*run.request.point, *now.streams} if DRAW in run.request.point else {*run.request.point}
    free = [name for name in _names(was.constants, now.constants) if name not in varied]
    return found + [name for name in free if not _same_at(name, was.constants, now.constants)]


def changed_study(stored: StudyDefinition, again: StudyDefinition) -> list[str]:
    """What is not the same in two definitions of one study, in words; configurations only one has are counted."""
    found = [f"FMU {name}" for name, digest in again.fmus.items() if stored.fmus.get(name, digest) != digest]
    before, after = ({each.id: each for each in definition.configurations} for definition in (stored, again))
    both = [(before[name], after[name]) for name in _names(before, after) if name in before and name in after]
    varied = {variable.name for variable in again.variables}
    parameters: dict[str, None] = {}
    for was, now in both:
        shared = [n for n in _names(was.constants, now.constants) if n in was.constants and n in now.constants]
        parameters |= dict.fromkeys(
            n for n in shared if n not in varied and not _same_at(n, was.constants, now.constants)
        )
    found += [f"parameter {name}" for name in parameters]
    for key, what in _OF_CONFIGURATIONS.items():
        found += [what] if any(getattr(was, key) != getattr(now, key) for was, now in both) else []
    for section, (what, keys) in (_SECTIONS | _SHOWN).items():
        ours, theirs = (_deciding(getattr(definition, section), keys) for definition in (stored, again))
        found += [f"{what} {name}" for name in _names(ours, theirs) if ours.get(name) != theirs.get(name)]
    found += _simulation_differences(stored, again, ("stop", "step", "record_every", "method"))
    found += [key for key in ("sampler", "seed") if getattr(stored, key) != getattr(again, key)]
    counts = len(set(after) - set(before)), len(set(before) - set(after))
    return found + [f"{n} configurations {word}" for n, word in zip(counts, ("more", "less"), strict=True) if n]


def _simulation_differences(stored: StudyDefinition, again: StudyDefinition, keys: Sequence[str]) -> Iterator[str]:
    before, after = ({"": each.simulation, **each.other_simulations} for each in (stored, again))
    for bench in _names(before, after):
        was, now = before.get(bench), after.get(bench)
        yield from (
            f"simulation {key}{' on ' * bool(bench)}{bench}"
            for key in keys
            if getattr(was, key, 0) != getattr(now, key, 0)
        )


def _judgement_differences(stored: Run, again: Run) -> Iterator[str]:
    before, after = ({judgement.requirement: judgement for judgement in run.judgements} for run in (stored, again))
    for name in _names(before, after):
        was, now = before.get(name), after.get(name)
        if was is None or now is None:
            yield f"{name} ({'is new' if was is None else 'is gone'})"
        elif was.verdict is not now.verdict:
            yield f"{name} ({was.verdict} became {now.verdict})"
        elif not _same(was.margin, now.margin):
            yield f"margin of {name}"


def _waveform_differences(stored: Waveforms, again: Waveforms | None) -> list[str]:
    if again is None:
        return ["its waveforms, now there are none"]
    found = [] if stored.time.tobytes() == again.time.tobytes() else ["the times of its waveforms"]
    for name in _names(stored.values, again.values):
        was, now = stored.values.get(name), again.values.get(name)
        if was is None or now is None or was.tobytes() != now.tobytes():
            found.append(f"waveform of {name}")
    return found


def _names(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[str]:
    return sorted(before.keys() | after.keys())


def _same(a: float, b: float) -> bool:
    return a == b or (math.isnan(a) and math.isnan(b))


def _same_at(name: str, a: Mapping[str, float], b: Mapping[str, float]) -> bool:
    return name in a and name in b and _same(a[name], b[name])


def _deciding(entries: tuple[Any, ...], keys: tuple[str, ...]) -> dict[str, Any]:
    return {entry.name: [getattr(entry, key) for key in keys] for entry in entries}
