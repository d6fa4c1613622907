"""``dse space constraints``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import opened
from dse.cli.arguments import Choose, Design, Format, Off, On, Output, Seed, Where
from dse.cli.commands.space import space_app
from dse.cli.spaces import constraint_data, tally_cell, tally_data, tally_text
from dse.cli.terminal import plain_table, print_json, print_line, print_table

if TYPE_CHECKING:
    from dse.space import Impact


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
    """Show the effect of each constraint.

    How many configurations are left after it and those before it; how many combinations it excludes alone; how many
    configurations would become valid without it. A redundant constraint excludes nothing that others do not exclude.
    """
    part = opened(design, choose, where, on, off)
    found = part.impact(constraint, seed)
    total = part.count_unconstrained(seed)
    if output is Output.JSON:
        constraints = [_data(entry) for entry in found]
        print_json({**part.data(), "total": tally_data(total), "constraints": constraints})
        return
    counted = ("left after it", "removes alone", "frees if dropped")
    table = plain_table("constraint", *counted, "", right=counted)
    for entry in found:
        numbers = [tally_cell(tally) for tally in (entry.after, entry.removes, entry.frees)]
        table.add_row(entry.constraint.name, *numbers, "redundant" if entry.is_redundant else "")
    if found:
        print_table(table)
    else:
        print_line(f"{part.space.name} has no constraints that are on")
    estimated = any(not tally.exact for entry in found for tally in (entry.after, entry.removes, entry.frees))
    note = "; ≈ is an estimate, ± its 95 % interval" if estimated else ""
    print_line(f"{tally_text(total)} combinations before the constraints{note}")


def _data(entry: Impact) -> dict[str, object]:
    return {
        **constraint_data(entry.constraint),
        "after": tally_data(entry.after),
        "removes_alone": tally_data(entry.removes),
        "frees_if_dropped": tally_data(entry.frees),
        "redundant": entry.is_redundant,
    }
