"""``dse best`` and ``dse pareto``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from dse.cli.app import app
from dse.cli.arguments import Folder, Format, Maximize, Minimize, Output
from dse.cli.terminal import plain_table, print_json, print_table, say

if TYPE_CHECKING:
    from dse.analysis import Ranking
    from dse.api import Results

_PLACES = 4
"""Places in which configurations differ that a table has room for."""


@app.command()
def best(
    folder: Folder,
    number: Annotated[int, typer.Option("--number", "-n", min=1, help="How many.")] = 5,
    minimize: Minimize = None,
    maximize: Maximize = None,
    form: Format = Output.TABLE,
) -> None:
    """Rank the designs of a study, and say what would have to change for another one to win.

    A design is a configuration with values for its variables. It has to meet all requirements at all conditions.
    """
    from dse.api import Results

    results = Results(folder)
    found = results.best(number, minimize=minimize or (), maximize=maximize or ())
    if len(found.objectives) > 1:
        what = "there are several objectives: 'dse pareto' shows their front; for a ranking choose one"
        raise typer.BadParameter(what, param_hint="--minimize, --maximize")
    _show(results, found, form)


@app.command()
def pareto(
    folder: Folder,
    number: Annotated[int, typer.Option("--number", "-n", min=1, help="How many that miss a requirement.")] = 5,
    minimize: Minimize = None,
    maximize: Maximize = None,
    form: Format = Output.TABLE,
) -> None:
    """List the designs of a study that no other one beats in every objective.

    Those that meet all requirements at all conditions, and what would have to change for others to be among them.
    """
    from dse.api import Results

    results = Results(folder)
    found = results.best(number, minimize=minimize or (), maximize=maximize or ())
    if len(found.objectives) < 2:
        raise typer.BadParameter("give two objectives or more", param_hint="--minimize, --maximize")
    _show(results, found, form)


def _show(results: Results, found: Ranking, form: Output) -> None:
    from dse.analysis import claim, what_would_change

    definition = results.definition
    if form is Output.JSON:
        print_json(_data(found))
        return
    say(f"{claim(found)}; {' and '.join(map(str, found.objectives))}", style="bold")
    if found.best:
        _print_table(results, found)
    for sentence in what_would_change(found, definition):
        say(f"  {sentence}")


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
    headings = [f"sum({each.name})" if each.is_total else each.name for each in found.objectives]
    table = plain_table("", "configuration", *headings, *varied, *shown, *(f"{m} margin" for m in margins), "runs")
    for place, each in enumerate(found.best):
        mark = "knee" if found.knee == place else f"{place + 1}." if len(headings) == 1 else ""
        values = zip(each.values, found.objectives, strict=True)
        requirements = {entry.name: entry.unit for entry in definition.requirements}
        table.add_row(
            mark,
            each.configuration,
            *(quantity(value, unit_of_objective(definition, objective)) for value, objective in values),
            *(quantity(each.point[name], units[name]) if name in each.point else "–" for name in varied),
            *(choices[place].get(path, "–") for path in shown),
            *(difference(each.margins[name], requirements[name]) for name in margins),
            ", ".join(map(str, each.runs[:_RUNS])) + (", …" if len(each.runs) > _RUNS else ""),
        )
    print_table(table)
    if len(differing) > len(shown):
        say(f"they differ in {len(differing) - len(shown)} more places; --format json tells all")


_RUNS = 3


def _data(found: Ranking) -> dict[str, Any]:
    from dataclasses import asdict

    return asdict(found)
