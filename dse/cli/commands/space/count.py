"""``dse space count``."""

from __future__ import annotations

from typing import Annotated

import typer

from dse.api import opened
from dse.cli.arguments import Choose, Design, Format, Off, On, Output, Seed, Where
from dse.cli.commands.space import space_app
from dse.cli.spaces import number_text, tally_data, tally_text
from dse.cli.terminal import print_json, print_line


@space_app.command("count")
def space_count(
    design: Design,
    choose: Choose = [],
    where: Where = None,
    exact: Annotated[bool, typer.Option("--exact", help="No estimate, however long it takes.")] = False,
    on: On = [],
    off: Off = [],
    seed: Seed = 0,
    output: Format = Output.TABLE,
) -> None:
    """Count the valid configurations.

    Exact if that takes only seconds; otherwise an estimate, marked as such, with its 95 % interval.
    """
    part = opened(design, choose, where, on, off)
    tally = part.count(seed, exact=exact)
    if output is Output.JSON:
        print_json({**part.data(), "total": part.total, **tally_data(tally)})
        return
    print_line(f"{part.title()}: {tally_text(tally)} of {number_text(part.total)} configurations are valid")
