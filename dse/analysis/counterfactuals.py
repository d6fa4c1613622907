"""What would have to change for another design to win, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from dse.analysis.design_ranking import Missed, Ranking, Standing, unit_of_objective
from dse.analysis.phrases import listed, outwards
from dse.domain.definition import StudyDefinition
from dse.units import parse_unit, short_symbol, shown


def claim(ranking: Ranking) -> str:
    """How strong it is what is said: among how many designs these are the best."""
    looked = f"{ranking.designs} designs" if ranking.designs != 1 else "the only design"
    said = f"of {looked} {ranking.feasible} meet all requirements wherever they were run"
    if ranking.open:
        said += f"; {ranking.open} more were not run at all conditions and are not counted"
    return said


def what_would_change(ranking: Ranking, definition: StudyDefinition) -> Iterator[str]:
    """A sentence for each runner-up, and for each design that only a requirement keeps from winning."""
    best = ranking.best
    if len(ranking.objectives) == 1:
        for place, other in enumerate(best[1:], 2):
            yield f"{place}. {_name(other)} wins if its {_must(ranking, definition, best[0], other)}"
    for other in ranking.better:
        if not ranking.objectives:
            wins, what = "meets all requirements", ""
        else:
            wins = "wins" if len(ranking.objectives) == 1 else "is on the front"
            what = f", with {_values(ranking, definition, other)},"
        needs = [_needs(missed, definition) for missed in other.missed]
        if not other.is_whole:
            needs.append("it does no worse at the conditions it was not run at")
        yield f"{_name(other)}{what} {wins} if {listed(needs)}"


def _name(design: Standing) -> str:
    runs = f"run {design.runs[0]}" if len(design.runs) == 1 else f"runs {', '.join(map(str, design.runs[:4]))}"
    return f"{design.configuration} ({runs}{', …' if len(design.runs) > 4 else ''})"


def _must(ranking: Ranking, definition: StudyDefinition, winner: Standing, other: Standing) -> str:
    (objective,) = ranking.objectives
    unit = unit_of_objective(definition, objective)
    apart = abs(other.values[0] - winner.values[0])
    change = "rises" if objective.maximize else "falls"
    if not apart:
        return f"{_label(objective.name, definition)} {change} at all: they are equal"
    share = f" ({shown(100 * apart / abs(other.values[0]), 2)} %)" if other.values[0] else ""
    by = f"{shown(outwards(apart / float(parse_unit(unit).factor), math.ceil))} {short_symbol(unit)}".rstrip()
    return f"{_label(objective.name, definition)} {change} by more than {by}{share}"


def _needs(missed: Missed, definition: StudyDefinition) -> str:
    requirement = next(entry for entry in definition.requirements if entry.name == missed.requirement)
    if missed.worst is None:
        return f"{missed.requirement} is met once it is exercised"
    is_above = requirement.at_most is not None and missed.worst > requirement.at_most
    bound = (requirement.at_most if is_above else requirement.at_least) or 0.0
    word, towards = ("at most", math.ceil) if is_above else ("at least", math.floor)
    enough = shown(outwards(parse_unit(requirement.unit).from_si(missed.worst), towards))
    instead = f"{enough} {short_symbol(requirement.unit)}".rstrip()
    return f"{missed.requirement} were {word} {instead} instead of {_quantity(bound, requirement.unit)}"


def _values(ranking: Ranking, definition: StudyDefinition, design: Standing) -> str:
    told = zip(ranking.objectives, design.values, strict=True)
    return listed([f"{_label(o.name, definition)} {_quantity(v, unit_of_objective(definition, o))}" for o, v in told])


def _quantity(si: float, unit: str) -> str:
    return f"{shown(parse_unit(unit).from_si(si))} {short_symbol(unit)}".rstrip()


def _label(name: str, definition: StudyDefinition) -> str:
    titles = {metric.name: metric.title for metric in definition.metrics}
    return titles.get(name, name)
