"""``dse best`` and ``dse pareto``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import SI, Folder, Format, Maximize, Minimize, Output, units_word
from dse.cli.choice import show_choice
from dse.cli.ranking import show_ranking
from dse.cli.terminal import print_json

if TYPE_CHECKING:
    from dse.analysis import Ranking
    from dse.api import Results


@app.command()
def best(
    folder: Folder,
    number: Annotated[int, typer.Option("--number", "-n", min=1, help="How many.")] = 5,
    minimize: Minimize = None,
    maximize: Maximize = None,
    form: Format = Output.TABLE,
    si: SI = False,
) -> None:
    """Rank the designs of a study, and show what would have to change for another one to win.

    A design is a configuration with values for its variables. It must meet all requirements under all conditions.
    First names the design to take, also if none meets all requirements. Without an objective, designs are ordered by
    their smallest margin.
    """
    from dse.api import Results

    results = Results(folder)
    found = results.best(number, minimize=minimize or (), maximize=maximize or ())
    if len(found.objectives) > 1:
        what = "there are several objectives: 'dse pareto' shows their front; for a ranking choose one"
        raise typer.BadParameter(what, param_hint="--minimize, --maximize")
    _show(results, found, form, units_word(si))


@app.command()
def pareto(
    folder: Folder,
    number: Annotated[
        int, typer.Option("--number", "-n", min=1, help="Number of listed designs that miss a requirement.")
    ] = 5,
    minimize: Minimize = None,
    maximize: Maximize = None,
    form: Format = Output.TABLE,
    si: SI = False,
) -> None:
    """List the designs of a study that no other one beats in every objective.

    Lists those that meet all requirements under all conditions, and what would have to change for others to join them.
    """
    from dse.api import Results

    results = Results(folder)
    found = results.best(number, minimize=minimize or (), maximize=maximize or ())
    if len(found.objectives) < 2:
        raise typer.BadParameter("give two objectives or more", param_hint="--minimize, --maximize")
    _show(results, found, form, units_word(si))


def _show(results: Results, found: Ranking, form: Output, units: str) -> None:
    if form is Output.JSON:
        from dse.api import ranking_as_data

        print_json(ranking_as_data(found, results.definition, units))
    else:
        show_choice(results.choice(found), results.definition)
        show_ranking(results, found, results.study())
