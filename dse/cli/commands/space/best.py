"""``dse space best`` and ``dse space pareto``."""

from __future__ import annotations

from typing import Annotated

import typer

from dse.api import Ranking, aims_of, opened
from dse.cli.arguments import Choose, Design, Format, Maximize, Minimize, Off, On, Output, Where
from dse.cli.commands.space import space_app
from dse.cli.terminal import plain_table, print_json, print_line, print_table, status_line

_PLACES = 6
"""Places in which the configurations differ that a table has room for."""


@space_app.command("best")
def space_best(
    design: Design,
    minimize: Minimize = None,
    maximize: Maximize = None,
    number: Annotated[int, typer.Option("--number", "-n", min=1, help="How many.")] = 10,
    choose: Choose = [],
    where: Where = None,
    on: On = [],
    off: Off = [],
    output: Format = Output.TABLE,
) -> None:
    """List the best valid configurations under one objective.

    Exact and complete: the best are proven to be the best.
    """
    if len(minimize or []) + len(maximize or []) != 1:
        raise typer.BadParameter("give one objective; for several ask 'dse space pareto'", param_hint="--minimize")
    part = opened(design, choose, where, on, off)
    wanted = aims_of(minimize or [], maximize or [], part.space)
    with status_line() as tell:
        found = part.best(wanted[0], number, tell)
    _show(Ranking(part, wanted, found), output)


@space_app.command("pareto")
def space_pareto(
    design: Design,
    minimize: Minimize = None,
    maximize: Maximize = None,
    choose: Choose = [],
    where: Where = None,
    on: On = [],
    off: Off = [],
    output: Format = Output.TABLE,
) -> None:
    """List the configurations that no other one beats in every objective.

    The complete Pareto set over sums of properties, with one configuration for each of its points.
    """
    if len(minimize or []) + len(maximize or []) < 2:
        raise typer.BadParameter("give two objectives or more", param_hint="--minimize, --maximize")
    part = opened(design, choose, where, on, off)
    wanted = aims_of(minimize or [], maximize or [], part.space)
    _show(Ranking(part, wanted, part.pareto(wanted)), output)


def _show(ranking: Ranking, output: Output) -> None:
    part, values = ranking.opened, ranking.shown()
    if output is Output.JSON:
        aims = [
            {"value": str(aim), "aim": "greatest" if aim.largest else "least", "unit": str(unit)}
            for aim, unit in zip(ranking.aims, ranking.units, strict=True)
        ]
        configurations = [
            {"id": entry.id, "values": row, "choices": dict(entry.choices)}
            for entry, row in zip(ranking, values, strict=True)
        ]
        print_json({**part.data(), "aims": aims, "configurations": configurations})
        return
    if not ranking:
        what = "no configuration is valid, or the objective is undefined for all that are"
        print_line(f"{part.title()}: {what}")
        return
    _print_ranking(ranking)


def _print_ranking(found: Ranking) -> None:
    """The choices in which they differ as columns, as far as there is room; those they share below."""
    paths = list(dict.fromkeys(path for entry in found for path in entry.choices))
    differing = [path for path in paths if len({entry.choices.get(path) for entry in found}) > 1]
    shown = differing[:_PLACES]
    aims = [f"{'greatest' if aim.largest else 'least'} {aim}" for aim in found.aims]
    table = plain_table("id", *aims, *shown, right=aims)
    for entry, row in zip(found, found.texts(), strict=True):
        table.add_row(entry.id, *row, *(entry.choices.get(path, "–") for path in shown))
    print_table(table)
    if len(differing) > len(shown):
        more = len(differing) - len(shown)
        print_line(f"they differ in {more} more places; --format json lists all")
    same = {path: found[0].choices[path] for path in paths if path not in differing}
    if same:
        has = "all have" if len(found) > 1 else "it has"
        listed = ", ".join(f"{path}={choice}" for path, choice in same.items())
        print_line(f"{has} {listed}")
