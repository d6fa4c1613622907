"""The best designs of a study on the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from dse.api import share_text
from dse.cli.terminal import plain_table, print_line, print_table
from dse.domain.sampler import Role

if TYPE_CHECKING:
    from dse.analysis import Ranking
    from dse.api import Results
    from dse.domain.definition import StudyDefinition
    from dse.domain.study import Study

_PLACES, _RUNS = 4, 3
"""Places in which configurations differ, and runs of a design, that a table has room for."""


def show_ranking(results: Results, found: Ranking, study: Study | None = None) -> None:
    """The designs as a table, how strong it is that they are best, and what would have to change for others.

    What bounds sums of properties is told if the *study* is known.
    """
    from dse.analysis import claim, what_would_change

    order = " and ".join(map(str, found.objectives)) or "without objectives, by their least margin"
    print_line(f"{claim(found)}; {order}", style="bold")
    if found.best:
        _print_table(results, found)
    for line in results.strength(found, study):
        print_line(f"  {line}")
    for sentence in what_would_change(found, results.definition):
        print_line(f"  {sentence}")


def _print_table(results: Results, found: Ranking) -> None:
    from dse.analysis import unit_of_objective
    from dse.api import difference, quantity

    definition = results.definition
    choices = [definition.configuration(each.configuration).choices for each in found.best]
    paths = list(dict.fromkeys(path for chosen in choices for path in chosen))
    differing = [path for path in paths if len({chosen.get(path) for chosen in choices}) > 1]
    shown = differing[:_PLACES]
    units = {variable.name: variable.unit for variable in definition.variables}
    varied = list(dict.fromkeys(name for each in found.best for name in each.point))
    margins = [entry.name for entry in definition.requirements]
    over, of_margin = _aggregations(definition)
    headings = [
        f"sum({each.name})" if each.is_total else each.name if each.is_expected else f"{over}{each.name}"
        for each in found.objectives
    ]
    ordered = headings or ["least margin, of the bound"]
    table = plain_table(
        "", "configuration", *ordered, *varied, *shown, *(f"{of_margin}{m} margin" for m in margins), "runs"
    )
    for place, each in enumerate(found.best):
        mark = "knee" if found.knee == place else f"{place + 1}." if len(headings) < 2 else ""
        values = zip(each.values, found.objectives, strict=True)
        requirements = {entry.name: entry.unit for entry in definition.requirements}
        table.add_row(
            mark,
            each.configuration,
            *(quantity(value, unit_of_objective(definition, objective)) for value, objective in values),
            *([] if headings else [share_text(each.slack)]),
            *(quantity(each.point[name], units[name]) if name in each.point else "–" for name in varied),
            *(choices[place].get(path, "–") for path in shown),
            *(
                difference(each.margins[name], requirements[name]) + " (doubtful)" * (name in each.doubtful)
                for name in margins
            ),
            ", ".join(map(str, each.runs[:_RUNS])) + (", …" if len(each.runs) > _RUNS else ""),
        )
    print_table(table)
    for line in _worst_conditions(found, definition):
        print_line(f"  {line}")
    if len(differing) > len(shown):
        print_line(f"they differ in {len(differing) - len(shown)} more places; --format json lists all")


def _worst_conditions(found: Ranking, definition: StudyDefinition) -> Iterator[str]:
    """At which conditions each objective has the values of the table, and in which of its rows."""
    from dse.api import quantity

    variables = {each.name: each for each in definition.variables}

    def value_at(name: str, value: float) -> str:
        variable = variables[name]
        return f"{name} = {variable.label(value) if variable.labels else quantity(value, variable.unit)}"

    for number, objective in enumerate(found.objectives):
        rows: dict[str, list[int]] = {}
        for place, each in enumerate(found.best, start=1):
            told = ", ".join(value_at(name, value) for name, value in each.at[number].items())
            rows.setdefault(told, []).append(place)
        for told, places in rows.items():
            where = f" ({', '.join(f'{place}.' for place in places)})" if len(rows) > 1 else ""
            if told:
                yield f"worst condition of {objective.name}: {told}{where}"


def _aggregations(definition: StudyDefinition) -> tuple[str, str]:
    """What an objective and a margin of a design are of its runs, as the headings name it; nothing if it has one."""
    roles = {variable.role for variable in definition.variables}
    over = "worst condition: " if Role.CONDITION in roles else "mean: " if Role.UNCERTAIN in roles else ""
    return over, "worst run: " if over else ""
