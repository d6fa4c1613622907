"""``dse verify``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import condition_of, new_folder, workspace_of
from dse.cli.app import app
from dse.cli.arguments import Format, Gate, Output, Where, Workers
from dse.cli.completion import designs, procedures
from dse.cli.configurations import chosen_configurations
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.exploration import progress_shown
from dse.cli.terminal import plain, plain_table, print_json, print_line, print_table
from dse.errors import closest, fail

if TYPE_CHECKING:
    from dse.domain.design import DesignSpace
    from dse.loading import Procedure
    from dse.rating import CaseVerdict, Verification


@app.command()
def verify(
    procedure: Annotated[
        str,
        typer.Argument(
            metavar="PROCEDURE",
            autocompletion=procedures,
            help="A test procedure: its name, or its .procedure.yaml file.",
        ),
    ],
    design: Annotated[
        str | None,
        typer.Option("--design", "-d", metavar="DESIGN", autocompletion=designs, help="Which one, if several fit."),
    ] = None,
    configuration: Annotated[
        list[str] | None,
        typer.Option("--configuration", "-c", metavar="ID", help="A configuration's id, or a start of it; repeatable."),
    ] = None,
    where: Where = None,
    best: Annotated[int | None, typer.Option("--best", min=1, metavar="N", help="The N of the least cost.")] = None,
    folder: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Default: out/PROCEDURE-DESIGN in the workspace."),
    ] = None,
    gate: Gate = False,
    workers: Workers = 0,
    form: Format = Output.TABLE,
) -> None:
    """Check a design in the cases of a test procedure: an engineering check by simulation, no conformity.

    A *.procedure.yaml states the cases and the bounds in each. Lists the verdicts with value, bound and margin, the
    worst first. Makes one study for each test; only missing runs are simulated. Without -c, --where or --best, the
    first valid configuration is checked.
    """
    from dse.api import ExploreOptions
    from dse.rating import verify as verify_design
    from dse.space import open_space

    space = workspace_of(procedure)
    wanted = space.procedure(procedure)
    mine = _design(wanted, design)
    chosen = chosen_configurations(open_space(mine, where=condition_of(where, mine)), configuration or [], where, best)
    place = folder or new_folder(space, f"{wanted.name}-{mine.name}")
    with progress_shown(place) as watched:
        found = verify_design(wanted, mine, chosen, place, ExploreOptions(workers), **watched)
    if form is Output.JSON:
        print_json(_data(found))
    else:
        _show(found, place)
    from dse.domain.bench import Verdict

    failed = found.count(Verdict.FAILED_TO_RUN) or (gate and found.count(Verdict.FAIL))
    raise typer.Exit(RUNS_FAILED if failed else DONE)


def _design(procedure: Procedure, name: str | None) -> DesignSpace:
    """The design space of that *name*; without, the only one of *procedure*. Raises DseError."""
    from dse.rating import designs_of

    known = {each.name: each for each in designs_of(procedure)}
    if name is None and len(known) == 1:
        return next(iter(known.values()))
    if name not in known:
        what = f"'{procedure.name}' has no test on a bench of '{name}'"
        if name is None:
            what = f"'{procedure.name}' has tests on benches of {len(known)} design spaces"
        raise fail(what, procedure.where, f"--design, one of {', '.join(known)}" if not name else closest(name, known))
    return known[name]


def _show(found: Verification, place: Path) -> None:
    from dse.domain.bench import Verdict
    from dse.rating import CHECK

    title = found.procedure.title or found.procedure.name
    print_line(f"{title}: {found.design.name}. {CHECK}.", style="bold")
    if found.procedure.source:
        print_line(f"figures: {found.procedure.source}")
    ids = list(dict.fromkeys(each.configuration for each in found.verdicts))
    several = ["configuration"] if len(ids) > 1 else []
    right = ("value", "bound", "margin")
    table = plain_table("verdict", *several, "test", "case", "requirement", *right, "run", right=right)
    for each in found.verdicts:
        row = [str(each.verdict), *([each.configuration] if several else []), each.test, each.case, each.title]
        table.add_row(*map(plain, row), *_numbers(each), str(each.number))
    print_table(table)
    for id_ in ids:
        counts = ((verdict, found.count(verdict, id_)) for verdict in Verdict)
        print_line(f"{id_}: {', '.join(f'{count} {verdict}' for verdict, count in counts if count)}")
    problems = dict.fromkeys(each.problem for each in found.verdicts if each.problem)
    for problem in problems:
        print_line(f"failed to run: {problem}")
    if found.left_out:
        print_line(f"on benches of other design spaces, not checked: {', '.join(found.left_out)}")
    print_line(f"{found.simulated} runs simulated now; studies: {place}")


def _numbers(each: CaseVerdict) -> list[str]:
    from dse.api import difference, quantity

    signs = (("≥", each.at_least), ("≤", each.at_most))
    bounds = [f"{sign} {quantity(bound, each.unit)}" for sign, bound in signs if not math.isnan(bound)]
    return [quantity(each.value, each.unit), ", ".join(bounds) or "–", difference(each.margin, each.unit)]


def _data(found: Verification) -> dict[str, object]:
    from dataclasses import asdict

    from dse.domain.bench import Verdict
    from dse.rating import CHECK

    return {
        "note": CHECK,
        "procedure": found.procedure.name,
        "source": found.procedure.source,
        "design": found.design.name,
        "not_checked": list(found.left_out),
        "simulated": found.simulated,
        "counts": {str(verdict): found.count(verdict) for verdict in Verdict},
        "verdicts": [{**asdict(each), "folder": str(each.folder)} for each in found.verdicts],
    }
