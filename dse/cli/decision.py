"""Two designs of a study, on the terminal: which is ahead, where they differ, what would change the order.

The sentences are those of the report's page (`words.ts`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from dse.api import assumed_text, certainty_text, order_text, title_of
from dse.cli.terminal import plain, plain_table, print_line, print_table

if TYPE_CHECKING:
    from dse.analysis import BoundChange, Decision, Interval, PairedDraws
    from dse.domain.definition import DefinedRequirement, StudyDefinition

_NAMES = {1: "A", 0: "neither", -1: "B"}
_CHANGED = "if A's is {} by more than {}, or B's {} by more than that, {}"


def decision_as_data(decision: Decision) -> dict[str, Any]:
    """*decision* as plain data in SI, what is undefined as null; cases are listed in ``pairs``."""
    data = asdict(decision)
    for name in ("first", "second"):
        for field in ("margins", "rates", "misses", "key"):
            del data[name][field]
    return {**_finite(data), "ahead": _NAMES[decision.ahead]}


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def show_decision(decision: Decision, definition: StudyDefinition) -> None:
    """Print *decision*."""
    from dse.api import quantity, requirement_labels
    from dse.units import short_symbol

    sides = decision.first, decision.second
    both = [definition.configuration(side.configuration) for side in sides]
    for name, design, other in zip("AB", both, reversed(both), strict=True):
        own = (f"{place} {what}" for place, what in design.choices.items() if other.choices.get(place) != what)
        totals = (
            f"{what} {quantity(total.value, '')} {short_symbol(total.unit)}" for what, total in design.totals.items()
        )
        print_line(f"{name}  {design.id}: {', '.join((*totals, *own))}", style="bold")
    print_line(order_text(decision, definition))
    print_line(certainty_text(decision))
    named = requirement_labels(definition)
    for name, title in named.items():
        about = [each for each in decision.pairs if each.requirement == name]
        if about:
            print_line(f"{title}: {_counted(about, decision.leading.get(name))}")
    _show_cases(decision, definition, named)
    print_line("What would change the order", style="bold")
    for text in _changes(decision, definition):
        print_line(f"  {text}")
    _show_effects(decision, definition, named)
    print_line(assumed_text(decision, definition))


def _counted(pairs: list[PairedDraws], leading: Interval | None) -> str:
    both, a, b, neither = (
        sum(getattr(each, what) for each in pairs) for what in ("both", "first", "second", "neither")
    )
    of = f"{len(pairs)} verdict{'s' * (len(pairs) != 1)}"
    text = f"both meet it in {both} draws, only A in {a}, only B in {b}, neither in {neither} ({of})"
    if leading is None or math.isnan(leading.value):
        return text
    share = " … ".join(f"{100 * end:.0f}" for end in (leading.low, leading.high))
    return f"{text}; of those in which they differ A meets {100 * leading.value:.0f} % ({share} %)"


def _show_cases(decision: Decision, definition: StudyDefinition, named: Mapping[str, str]) -> None:
    certain = [each for each in decision.pairs if each.is_certain]
    if not certain:
        return
    requirements = {each.name: each for each in definition.requirements}
    heads = ("rate of A less B", "from", "to", "only A", "only B", "of draws", "margin of A less B")
    table = plain_table("requirement", "condition", *heads, "a bound that only one meets", right=heads)
    for each in sorted(certain, key=lambda one: -abs(one.difference)):
        shares = (f"{100 * share:+.0f} %" for share in (each.difference, each.low, each.high))
        unit = requirements[each.requirement].unit
        sides = (side.margins[each.requirement].get(each.case, math.nan) for side in (decision.first, decision.second))
        table.add_row(
            *(named[each.requirement], plain(each.label), *shares),
            *map(str, (each.first, each.second, each.draws)),
            plain(_difference(each.margin, unit)),
            plain(_between(requirements[each.requirement], *sides)),
        )
    print_table(table)


def _between(requirement: DefinedRequirement, a: float, b: float) -> str:
    """Between which bounds only one of them meets a requirement."""
    from dse.api import quantity

    if math.isnan(a - b) or a == b:
        return "none"
    name, most, least = ("A", a, b) if a > b else ("B", b, a)
    low, high, unit = requirement.at_least, requirement.at_most, requirement.unit
    if low is not None and high is not None:
        return f"only {name}: {_difference(-most, unit)} … {_difference(-least, unit)} at both ends"
    ends = (low + least, low + most) if low is not None else ((high or 0.0) - most, (high or 0.0) - least)
    return f"only {name}: {' … '.join(quantity(end, unit) for end in ends)}"


def _changes(decision: Decision, definition: StudyDefinition) -> Iterator[str]:
    from dse.api import requirement_labels

    requirements, named = {each.name: each for each in definition.requirements}, requirement_labels(definition)
    for change in decision.bounds:
        bound = _bound(requirements[change.requirement], change)
        yield f"{named[change.requirement]}: with {bound}, {_NAMES[change.ahead]} is ahead"
    if not decision.bounds:
        yield "no other bound of a single requirement changes the order"
    if decision.ahead and decision.by <= 2 * len(decision.first.counts):
        if decision.objectives:
            names = ", ".join(title_of(each.name, definition) for each in decision.objectives)
            yield f"the order follows from the verdicts: no other value of {names} changes it"
        return
    units = dict(zip((each.name for each in decision.objectives), decision.units, strict=True))
    for each in decision.changes:
        ways = ("higher", "lower") if each.change > 0 else ("lower", "higher")
        by = _difference(abs(each.change), units[each.objective]).lstrip("+")
        then = f"{_NAMES[each.ahead]} is ahead"
        yield f"{title_of(each.objective, definition)}: {_CHANGED.format(ways[0], by, ways[1], then)}"


def _bound(requirement: DefinedRequirement, change: BoundChange) -> str:
    from dse.api import quantity

    low, high, unit, looser = requirement.at_least, requirement.at_most, requirement.unit, change.shift < 0
    if low is not None and high is not None:
        by = _difference(abs(change.shift), unit).lstrip("+")
        return f"both bounds {'' if looser else 'more than '}{by} {'looser' if looser else 'tighter'}"
    bound, side = (low, 1) if low is not None else (high or 0.0, -1)
    how = ("at least" if looser else "more than") if side > 0 else "at most" if looser else "less than"
    return f"{how} {quantity(bound + side * change.shift, unit)} instead of {quantity(bound, unit)}"


def _show_effects(decision: Decision, definition: StudyDefinition, named: Mapping[str, str]) -> None:
    from dse.api import quantity

    units = {each.name: each.unit for each in definition.requirements}
    variables = {variable.name: variable for variable in definition.variables}
    shown = [each for each in decision.effects if each.change.low > 0 or each.change.high < 0]
    if not shown:
        names = dict.fromkeys(variables[each.variable].title or each.variable for each in decision.effects)
        print_line(
            f"no certain change of the difference with {', '.join(names)}"
            if names
            else "the study varies nothing that both have in common"
        )
        return
    heads = ("A less B, smallest", "A less B, largest", "change", "from", "to")
    table = plain_table("varied number", "margin of", *heads, "reverses", right=heads)
    for each in shown:
        variable, unit = variables[each.variable], units[each.requirement]
        means = [level.value for level in each.levels]
        ends = (0, 1) if each.is_line else (means.index(min(means)), means.index(max(means)))
        at = (variable.label(each.values[end]) or quantity(each.values[end], variable.unit) for end in ends)
        levels = (f"{_difference(means[end], unit)} at {value}" for end, value in zip(ends, at, strict=True))
        change = (_difference(value, unit) for value in (each.change.value, each.change.low, each.change.high))
        cells = (variable.title or variable.name, named[each.requirement], *levels, *change)
        table.add_row(*map(plain, cells), "yes" if each.reverses else "no")
    print_table(table)


def _difference(value: float, unit: str) -> str:
    """A difference (SI) in *unit*, signed."""
    from dse.units import parse_unit, short_symbol, shown

    return f"{'+' if value > 0 else ''}{shown(value / float(parse_unit(unit).factor), 3)} {short_symbol(unit)}".rstrip()
