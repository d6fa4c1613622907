"""How strong it is what an optimisation says: among how much it is the best, what bounds it, and how it came about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dse.analysis.design_ranking import Ranking, unit_of_objective
from dse.domain.definition import StudyDefinition
from dse.domain.sampler import Objective
from dse.exploration import design_variable, designs_of, hypervolume
from dse.space import OpenedSpace, read_aims
from dse.storage import RunTable
from dse.testbench import with_composites
from dse.units import parse_unit, short_symbol


@dataclass(frozen=True, slots=True)
class Stage:
    """A study after its first *runs*: how many designs are *feasible*, and the *volume* that they dominate.

    The volume is a share of what all designs of the study dominate at its end, up to the worst feasible value of each
    objective; NaN if that is nothing.
    """

    runs: int
    feasible: int
    volume: float


def static_bound(space: OpenedSpace, objective: Objective) -> float | None:
    """What no configuration of *space* can beat, in SI; None for what only simulation tells.

    Exact for a sum of properties: it is the best of the whole space, requirements aside.
    """
    if not objective.is_total:
        return None
    text = [f"sum({objective.name})"]
    (aim,) = read_aims(*(([], text) if objective.maximize else (text, [])))
    found = space.best(aim, 1)
    return float(found[0].values[0]) if found else None


def strength(ranking: Ranking, runs: int, bounds: Sequence[float | None], definition: StudyDefinition) -> str:
    """Among how many runs the best ones are, and what bounds them: *bounds* are one for each objective."""
    designs = f"{ranking.designs:,} design{'s' * (ranking.designs != 1)}"
    said = [f"best of {runs:,} run{'s' * (runs != 1)} of {designs}"]
    for column, (objective, bound) in enumerate(zip(ranking.objectives, bounds, strict=True)):
        unit = unit_of_objective(definition, objective)
        if bound is None:
            said += [] if objective.is_total else [f"nothing but simulation bounds {objective.name}"]
            continue
        values = [one.values[column] for one in ranking.best]
        word, best = ("more", max) if objective.maximize else ("less", min)
        shown = f"{parse_unit(unit).from_si(bound):.6g} {short_symbol(unit)}".rstrip()
        proven = ", which is reached" if values and best(values) == bound else ""
        said.append(f"no configuration has {word} than sum({objective.name}) = {shown}{proven}")
    return "; ".join(said)


def stages(table: RunTable, objectives: Sequence[Objective], ends: Sequence[int]) -> tuple[Stage, ...]:
    """The study after its runs with numbers below each of *ends*, as those of its asks; a design counts with its last
    run."""
    definition = table.header.definition
    totals = [name for each in objectives for name in each.totals]
    outcomes = with_composites(table.outcomes(table.numbers.tolist(), totals), objectives, definition)
    designs = designs_of(outcomes, tuple(map(design_variable, definition.variables)), objectives)
    values = np.array([-1.0 if each.maximize else 1.0 for each in objectives]) * designs.objectives
    feasible = designs.feasible & ~np.isnan(values).any(axis=1)
    last = np.array([int(table.numbers[rows].max()) for rows in designs.rows], dtype=np.int64)
    reference = values[feasible].max(axis=0).tolist() if feasible.any() else []
    whole = hypervolume(values[feasible].tolist(), reference) if reference else 0.0

    def stage(end: int) -> Stage:
        there = feasible & (last < end)
        volume = hypervolume(values[there].tolist(), reference) / whole if whole else float("nan")
        return Stage(int((table.numbers < end).sum()), int(there.sum()), volume)

    return tuple(map(stage, ends))
