"""Two designs of a study in sentences: which is ahead and why, and how sure that is.

The sentences are those of the report's page (`words.ts`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dse.api.presentation.quantities import quantity

if TYPE_CHECKING:
    from dse.analysis import Decision
    from dse.domain.definition import StudyDefinition


def order_text(decision: Decision, definition: StudyDefinition, names: tuple[str, str] = ("A", "B")) -> str:
    """Which design is ahead, and why; *names* of both begin a sentence."""
    if not decision.ahead:
        what = " and in ".join(
            ["their least margins", *(title_of(each.name, definition) for each in decision.objectives)]
        )
        return f"{_missed_by_both(decision)}. Neither is ahead: they are equal in {what}."
    sides, named = (decision.first, decision.second)[:: decision.ahead], names[:: decision.ahead]
    one, other = sides
    start, rival = f"{named[0]} is ahead", named[1][0].lower() + named[1][1:] if len(named[1]) > 1 else named[1]
    if not decision.by:
        return f"{start}: {rival} was not run at all conditions."
    level, is_doubtful = divmod(decision.by - 1, 2)
    if level < len(one.counts):
        a, b = one.counts[level], other.counts[level]
        of = f"{max(a.judged, b.judged):,} {class_of(a.severity, len(one.counts))}"
        if is_doubtful:
            both = f"both miss {a.certain or 'none'} of {of} for certain"
            return (
                f"{start}: {both}; of those that are doubtful it misses {a.doubtful or 'none'}, {rival} {b.doubtful}."
            )
        surely = " for certain" if a.doubtful or b.doubtful else ""
        return f"{start}: it misses {a.certain or 'none'} of {of}{surely}, {rival} {b.certain}."
    number = decision.by - 1 - 2 * len(one.counts)
    if number < len(decision.objectives):
        what, unit = title_of(decision.objectives[number].name, definition), decision.units[number]
        values = (quantity(side.objectives[number], unit) for side in sides)
    else:
        what, values = "least margin", (share_text(side.slack) for side in sides)
    mine, theirs = values
    return f"{_missed_by_both(decision)}. {start}: its {what} is {mine}, that of {rival} {theirs}."


def _missed_by_both(decision: Decision) -> str:
    side = decision.first
    return f"Both miss {side.missed or 'none'} of {verdicts(side.judged)}"


def verdicts(number: int) -> str:
    """So many verdicts in words."""
    return f"{number:,} verdict{'s' * (number != 1)}"


def class_of(severity: str, classes: int) -> str:
    """Verdicts of a class of severity: ``critical verdicts``; of the only one that has no name ``verdicts``."""
    return f"{severity} verdicts" if severity else "verdicts" if classes == 1 else "verdicts without a severity"


def share_text(slack: float) -> str:
    """A least margin, as a share of its bound."""
    from dse.units import shown

    return f"{shown(100 * slack, 3)} %" if math.isfinite(slack) else "undefined"


def title_of(name: str, definition: StudyDefinition) -> str:
    """What a metric is called; a sum of properties by its name."""
    return next((metric.title for metric in definition.metrics if metric.name == name and metric.title), name)


def certainty_text(decision: Decision) -> str:
    """How sure the differences are."""
    random = [each for each in decision.pairs if each.low < each.high]
    if not decision.pairs:
        return "They have no condition in common."
    if not random:
        return "These runs have no noise: the differences are exact."
    if all(each.draws == 1 for each in random):
        return "Each verdict rests on one draw of the noise, so that no difference of rates is certain."
    certain = sum(each.is_certain for each in random)
    where = f"the rates differ with 95 % confidence in {certain or 'none'} of {verdicts(len(random))}"
    return f"In the same draws, {where}{'.' if certain else ': with other draws the order may differ.'}"


def assumed_text(decision: Decision, definition: StudyDefinition) -> str:
    """Which of the assumed numbers of both designs the study varies."""
    varied = {variable.name for variable in definition.variables}
    if decision.assumed is None:
        return "Which numbers are assumed was not kept with this study."
    if not decision.assumed:
        return "No number of these designs is marked as assumed."
    count = (
        f"{len(decision.assumed)} number{'s' * (len(decision.assumed) > 1)} of these designs that are marked as assumed"
    )
    if among := [name for name in decision.assumed if name in varied]:
        return f"Of {count}, the study varies {', '.join(among)}."
    return f"The study varies none of the {count}: how the difference depends on them is not known."
