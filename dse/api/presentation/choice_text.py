"""Which design to take, in sentences. They are those of the report's page (`choice.ts`)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from dse.api.presentation.decision_text import (
    assumed_text,
    certainty_text,
    class_of,
    order_text,
    share_text,
    title_of,
    verdicts,
)
from dse.api.presentation.quantities import quantity

if TYPE_CHECKING:
    from dse.analysis import Choice, Side
    from dse.domain.definition import StudyDefinition

_MOST_CASES, _MOST_CHANGES = 2, 6
_VERDICT = (
    "A verdict is that on a requirement at a condition. It is doubtful if more draws or finer numerics may change it."
)


def choice_lines(choice: Choice, definition: StudyDefinition) -> tuple[str, list[tuple[str, str]]]:
    """The name of the design, and lines with what they are about: its result, the next one with what decides, what is
    cheaper, how sure it is, and the order."""
    decision = choice.decision
    first, names = decision.first, ("This design", "The next one")
    what, *missed = _result(choice, definition)
    second = decision.second
    changes = _changes(definition, first, second.configuration, second.point) or second.configuration
    found = [("result", what), *(("misses", text) for text in missed), ("values", _values(choice, definition))]
    found.append(("next", f"{changes}. {order_text(decision, definition, names)}{_where(choice, definition)}"))
    if choice.cheaper:
        configuration, point, run = choice.cheaper
        cost, now = (_cost(definition, each, choice.price) for each in (configuration, first.configuration))
        what = f"{_changes(definition, first, configuration, point)} ({configuration}, run {run})"
        found.append(("cheaper", f"{what}: as few missed verdicts of each severity for {cost} instead of {now}."))
    unsure = f"{first.unsure or 'None'} of its {verdicts(first.judged)} {'are' if first.unsure > 1 else 'is'} doubtful"
    sure = [f"{unsure}.", certainty_text(decision)]
    sure += [*_reversed(choice, definition), assumed_text(decision, definition)]
    found += [("how sure", " ".join(sure)), ("order", f"{order_sentence(choice, definition)} {_VERDICT}")]
    return f"{design_name(definition, first)} ({first.configuration}, run {choice.run})", found


def order_sentence(choice: Choice, definition: StudyDefinition) -> str:
    """The order of designs."""
    counts, objectives = choice.decision.first.counts, choice.decision.objectives
    missed = [f"missed {class_of(each.severity, len(counts))}" for each in counts]
    aims = [f"{'larger' if each.maximize else 'smaller'} {title_of(each.name, definition)}" for each in objectives]
    first = f"Fewest {missed[0]} (certain ones before doubtful ones)"
    return f"{', then '.join([first, *missed[1:], *aims, 'larger least margin'])}."


def design_name(definition: StudyDefinition, side: Side) -> str:
    """What a design chooses where configurations differ, and its values of the design variables.

    What configurations choose at several of these places is named with its place: ``computer_1 at brake``.
    """
    from dse.analysis import value_label

    choices = [each.choices for each in definition.configurations]
    mine = definition.configuration(side.configuration).choices
    chosen = {path: {each.get(path, "") for each in choices} for path in definition.design.places}
    places = Counter(what for found in chosen.values() if len(found) > 1 for what in found)
    names = [
        f"{mine[path]} at {path}" if places[mine[path]] > 1 else mine[path]
        for path, found in chosen.items()
        if path in mine and len(found) > 1
    ]
    variables = {each.name: each for each in definition.variables}
    return ", ".join(names + [value_label(variables[name], value) for name, value in side.point.items()]) or (
        side.configuration
    )


def _changes(definition: StudyDefinition, first: Side, other: str, point: Mapping[str, float]) -> str:
    """What the configuration *other* with the values of *point* chooses differently."""
    from dse.analysis import value_label

    mine, theirs = (definition.configuration(each).choices for each in (first.configuration, other))
    paths = definition.design.places
    found = [
        f"{path} {theirs.get(path, 'none')} instead of {mine.get(path, 'none')}"
        for path in paths
        if mine.get(path) != theirs.get(path)
    ]
    variables = {each.name: each for each in definition.variables}
    found += [value_label(variables[name], at) for name, at in point.items() if first.point.get(name) != at]
    rest = len(found) - _MOST_CHANGES
    return ", ".join(found[:_MOST_CHANGES]) + (f" and {rest} more" if rest > 0 else "")


def _result(choice: Choice, definition: StudyDefinition) -> Iterator[str]:
    side, wanted = choice.decision.first, len(definition.requirements)
    all_ = "the requirement" if wanted == 1 else "both requirements" if wanted == 2 else f"all {wanted} requirements"
    all_of = "both" if choice.conditions == 2 else f"all {choice.conditions:,}"
    where = f" in {all_of} conditions" if choice.conditions > 1 else ""
    if not side.missed:
        yield f"It meets {all_}{where}: {verdicts(side.judged)}. {choice.feasible} of {choice.designs} designs do."
        return
    parts = (f"{each.missed} of {each.judged:,} {class_of(each.severity, len(side.counts))}" for each in side.counts)
    yield f"No design meets {all_}{where}. This one is the first in the order: it misses {', '.join(parts)}."
    for requirement in definition.requirements:
        if cases := [*side.misses[requirement.name].items()]:
            unsure = sum(is_doubtful for _, is_doubtful in cases)
            state = "" if not unsure else "doubtful" if unsure == len(cases) else f"{unsure} doubtful"
            told = _cases(definition, [case for case, _ in cases])
            yield f"{requirement.title or requirement.name}{f' ({state})' if state else ''}{told}."
        elif not side.margins[requirement.name]:
            yield f"{requirement.title or requirement.name}: no run exercises it."


def _cases(definition: StudyDefinition, cases: Sequence[tuple[float, ...]]) -> str:
    from dse.analysis import case_label

    told = [label for case in cases[:_MOST_CASES] if (label := case_label(definition, case))]
    rest = len(cases) - _MOST_CASES
    more = f" and {rest} more condition{'s' * (rest > 1)}" if rest > 0 else ""
    return f", at {'; '.join(told)}{more}" if told else ""


def _where(choice: Choice, definition: StudyDefinition) -> str:
    """The cases in which only the next design misses a requirement of the class that decides."""
    from dse.analysis import severity_levels

    decision = choice.decision
    for requirement, level in zip(definition.requirements, severity_levels(definition), strict=True):
        mine, theirs = (side.misses[requirement.name] for side in (decision.first, decision.second))
        cases = [case for case in theirs if case not in mine]
        if cases and (decision.by - 1) // 2 == level:
            return f" It alone misses {requirement.title or requirement.name}{_cases(definition, cases)}."
    return ""


def _values(choice: Choice, definition: StudyDefinition) -> str:
    decision, side = choice.decision, choice.decision.first
    told = [
        f"{title_of(each.name, definition)} {quantity(value, unit)}"
        for each, value, unit in zip(decision.objectives, side.objectives, decision.units, strict=True)
    ]
    if choice.price and all(each.name != choice.price for each in decision.objectives):
        told.append(f"{choice.price} {_cost(definition, side.configuration, choice.price)}")
    if math.isfinite(side.slack):
        told.append(f"least margin {share_text(side.slack)} of the bound")
    text = ", ".join(told) or "its margins are undefined"
    return f"{text[0].upper()}{text[1:]}."


def _cost(definition: StudyDefinition, configuration: str, price: str) -> str:
    from dse.units import short_symbol

    total = definition.configuration(configuration).totals[price]
    return f"{quantity(total.value, '')} {short_symbol(total.unit)}"


def _reversed(choice: Choice, definition: StudyDefinition) -> Iterator[str]:
    """The assumed numbers that alter which of both is better."""
    titles = {each.name: each.title or each.name for each in definition.requirements}
    titles |= {each.name: each.title or each.name for each in definition.variables}
    for each in choice.decision.effects:
        if each.is_assumed and each.reverses:
            margin, number = titles[each.requirement], titles[each.variable]
            yield f"Which one has the larger margin of {margin} depends on the assumed {number}."
