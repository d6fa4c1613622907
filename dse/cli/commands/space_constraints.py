"""``dse space constraints``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from dse.api.naming import opened
from dse.cli.app import console, print_json, print_table
from dse.cli.arguments import Design, Format, Output
from dse.cli.commands.space_conflict import constraint_data
from dse.cli.space import Choose, Off, On, Seed, Where, space_app
from dse.cli.tallies import tally_cell, tally_data, tally_text

if TYPE_CHECKING:
    from dse.space.questions.impact import Impact


@space_app.command("constraints")
def space_constraints(
    design: Design,
    constraint: Annotated[
        list[str], typer.Option("--constraint", metavar="NAME", help="Only this constraint; may be repeated.")
    ] = [],
    choose: Choose = [],
    where: Where = None,
    on: On = [],
    off: Off = [],
    seed: Seed = 0,
    output: Format = Output.TABLE,
) -> None:
    """Tell what each constraint does.

    How many configurations are left after it and those before it; how many combinations it excludes alone; how
    many configurations would become valid if it were dropped. A redundant one excludes nothing that others do not.
    """
    from rich.table import Table

    part = opened(design, choose, where, on, off)
    found = part.impact(constraint, seed)
    total = part.count_unconstrained(seed)
    if output is Output.JSON:
        constraints = [_data(entry) for entry in found]
        print_json({**part.data(), "total": tally_data(total), "constraints": constraints})
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("constraint", no_wrap=True)
    for heading in ("left after it", "removes alone", "frees if dropped"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("")
    for entry in found:
        numbers = [tally_cell(tally) for tally in (entry.after, entry.removes, entry.frees)]
        table.add_row(entry.constraint.name, *numbers, "redundant" if entry.is_redundant else "")
    if found:
        print_table(table)
    else:
        console().print(f"{part.space.name} has no constraints that are on", soft_wrap=True)
    estimated = any(not tally.exact for entry in found for tally in (entry.after, entry.removes, entry.frees))
    note = "; ≈ is an estimate, ± its 95 % interval" if estimated else ""
    console().print(f"{tally_text(total)} combinations before the constraints{note}", soft_wrap=True)


def _data(entry: Impact) -> dict[str, object]:
    return {
        **constraint_data(entry.constraint),
        "after": tally_data(entry.after),
        "removes_alone": tally_data(entry.removes),
        "frees_if_dropped": tally_data(entry.frees),
        "redundant": entry.is_redundant,
    }
