"""``dse rate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import new_folder, opened, workspace_of
from dse.cli.app import app
from dse.cli.arguments import Configuration, Design, Format, Output, Where, Workers
from dse.cli.completion import ratings
from dse.cli.configurations import chosen_configurations
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.exploration import progress_shown
from dse.cli.terminal import plain_table, print_json, print_line, print_table
from dse.errors import fail
from dse.places import RATING

if TYPE_CHECKING:
    from dse.loading import Rating, Workspace
    from dse.rating import RatedConfiguration, RatedDesign


@app.command()
def rate(
    design: Design,
    rating: Annotated[
        str | None, typer.Option("--rating", metavar="NAME", autocompletion=ratings, help="Which one, if several fit.")
    ] = None,
    configuration: Configuration = None,
    where: Where = None,
    best: Annotated[int | None, typer.Option("--best", min=1, metavar="N", help="The N of the least cost.")] = None,
    folder: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="DIR", help="Default: out/RATING-DESIGN in the workspace.")
    ] = None,
    at_least: Annotated[
        float | None, typer.Option("--at-least", metavar="POINTS", help="Name the cheapest with so many points.")
    ] = None,
    layers: Annotated[bool, typer.Option("--layers", help="Simulate the robustness layers as well.")] = False,
    reports: Annotated[
        bool, typer.Option("--reports", help="Write the studies' reports, whose runs the cells of the page link to.")
    ] = False,
    workers: Workers = 0,
    form: Format = Output.TABLE,
) -> None:
    """Predict the points of a rating protocol by simulation.

    Simulates the cells of the protocol's matrices that a *.rating.yaml maps to test benches, fills the workbook of the
    official calculator, and shows its points. No rating is claimed. Without -c, --where or --best, the first valid
    configuration is rated. Needs the extra 'ncap'.
    """
    from dse.api import ExploreOptions, Results
    from dse.rating import rate as rate_design, write_page

    space = workspace_of(design)
    part = opened(design, where=where)
    wanted = _rating(space, rating, part.space.name)
    chosen = chosen_configurations(part, [] if configuration is None else [configuration], where, best)
    place = folder or new_folder(space, f"{wanted.name}-{part.space.name}")
    with progress_shown(place) as watched:
        rated = rate_design(wanted, part.space, chosen, place, ExploreOptions(workers), layers=layers, **watched)
    if reports:
        for study in rated.folders:
            Results(study).report()
    write_page(rated, place / "rating.html")
    if form is Output.JSON:
        print_json(_data(rated, at_least, place))
    else:
        _show(rated, at_least)
        more = f" and {len(rated.rated) - 1} more" if len(rated.rated) > 1 else ""
        print_line(f"workbooks: {rated.rated[0].workbook}{more}")
        print_line(f"page: {place / 'rating.html'}")
    raise typer.Exit(RUNS_FAILED if any(each.failed for each in rated.rated) else DONE)


def _rating(space: Workspace, name: str | None, design: str) -> Rating:
    """The rating of that *name*; without, the only one that is for *design*. Raises DseError."""
    if name is not None:
        return space.rating(name)
    paths = [path for path in space.files("testbenches") if path.name.endswith(RATING)]
    read = [space.rating(str(path)) for path in paths]
    found = [each for each in read if any(test.bench.design.name == design for test in each.tests)]
    if len(found) != 1:
        names = ", ".join(each.name for each in found or read)
        what = f"there are {len(found)} ratings of '{design}'" if found else f"there is no rating of '{design}'"
        raise fail(what, hint=f"--rating, one of {names}" if names else "write testbenches/NAME.rating.yaml")
    return found[0]


def _show(rated: RatedDesign, at_least: float | None) -> None:
    from dse.rating import HEADING

    title = rated.rating.title or rated.rating.name
    print_line(f"{title}: {rated.design.name}. {HEADING}.", style="bold")
    if len(rated.rated) == 1:
        _show_one(rated.rated[0])
    else:
        _show_several(rated)
    for each in rated.rated:
        for rule in each.filled.rules:
            print_line(f"{each.id}: rule of the protocol: {rule}")
        if each.failed:
            print_line(
                f"{each.id}: {len(each.failed)} runs failed, their cells have no points: {each.failed[0].problem}"
            )
    if rated.gaps:
        print_line(f"not simulated, 0 points: {rated.gaps}")
    if rated.undeclared:
        print_line(f"0 points, as 'inputs' of the rating does not declare: {rated.undeclared}")
    if rated.layers_left:
        print_line(f"robustness layers that are not simulated: {rated.layers_left}")
    print_line(f"{rated.not_assessed}.")
    if at_least is not None:
        print_line(_cheapest(rated, at_least))
    print_line(f"{rated.simulated} runs simulated now")


def _cheapest(rated: RatedDesign, at_least: float) -> str:
    found = rated.cheapest(at_least)
    if found is None:
        return f"no rated configuration with a cost has {at_least:g} points"
    return (
        f"cheapest with at least {at_least:g} points: {found.id}, {found.cost_text}, {found.filled.points:.3f} points"
    )


def _show_one(each: RatedConfiguration) -> None:
    table = plain_table("stage element", "category", "points", "of", "scenarios", right=("points", "of"))
    scores = each.filled.scores
    for total in each.filled.totals:
        stage = total.element, total.subelement
        table.add_row(f"{total.element}: {total.subelement}", "", f"{total.points:.3f}", f"{total.most:g}", "")
        for score in scores:
            if (score.element, score.subelement) == stage and score.category and not score.scenario:
                scenarios: dict[str, tuple[float, float]] = {}
                for own in scores:
                    if own.layer and (own.element, own.subelement, own.category) == (*stage, score.category):
                        points, most = scenarios.get(own.scenario, (0.0, 0.0))
                        scenarios[own.scenario] = points + own.points, most + own.most
                told = ", ".join(f"{name} {points:.3f} of {most:g}" for name, (points, most) in scenarios.items())
                table.add_row("", score.category, f"{score.points:.3f}", f"{score.most:g}", told)
    table.add_row("all", "", f"{each.filled.points:.3f}", f"{each.filled.most:g}", "")
    print_line(f"configuration {each.id}: {each.choices_text}")
    print_table(table)


def _show_several(rated: RatedDesign) -> None:
    from dse.rating import described

    totals = rated.rated[0].filled.totals
    heads = [f"{_short(s.element)} {s.subelement}" for s in totals]
    places = rated.differing
    table = plain_table("configuration", *places, "cost", "points", *heads, right=("cost", "points", *heads))
    for each in rated.best_first:
        row = [f"{score.points:.3f}" for score in each.filled.totals]
        choices = [each.configuration.choices.get(place) or "–" for place in places]
        table.add_row(each.id, *choices, each.cost_text, f"{each.filled.points:.3f}", *row)
    print_table(table)
    one, other = rated.best_first[:2]
    flips = list(rated.differences(one, other))
    print_line(f"cells that differ between {one.id} and {other.id}: {len(flips)}")
    for cell, mine, theirs in flips[:_SHOWN]:
        print_line(f"  {cell.test}, {described(cell)}: {mine or 'none'}, {theirs or 'none'}")
    if len(flips) > _SHOWN:
        print_line(f"  and {len(flips) - _SHOWN} more, on the page")


_SHOWN = 10


def _short(element: str) -> str:
    return "".join(word[0] for word in element.split())


def _data(rated: RatedDesign, at_least: float | None, place: Path) -> dict[str, object]:
    from dataclasses import asdict

    from dse.rating import HEADING

    cheapest = None if at_least is None else rated.cheapest(at_least)
    return {
        "note": HEADING,
        "rating": rated.rating.name,
        "design": rated.design.name,
        "protocol": f"{rated.protocol.name} {rated.protocol.version}",
        "not_assessed": rated.not_assessed,
        "not_simulated": list(rated.missing),
        "layers_not_simulated": rated.layers_left,
        "not_declared": list(rated.rated[0].filled.undeclared),
        "partly_simulated": {test: {"cells": there, "of": of} for test, (there, of) in rated.partly.items()},
        "simulated": rated.simulated,
        "page": str(place / "rating.html"),
        **({"cheapest": cheapest and cheapest.id} if at_least is not None else {}),
        "configurations": [
            {
                "id": each.id,
                "points": each.filled.points,
                "of": each.filled.most,
                "cost": each.cost,
                "rules": list(each.filled.rules),
                "failed": len(each.failed),
                "scores": [asdict(score) for score in each.filled.scores],
                "workbook": str(each.workbook),
            }
            for each in rated.rated
        ],
    }
