"""``dse space conflict``."""

from __future__ import annotations

from dse.api import opened
from dse.cli.arguments import Choose, Design, Format, Off, On, Output, Where
from dse.cli.commands.space import space_app
from dse.cli.spaces import constraint_data, show_constraints
from dse.cli.terminal import console, plain, print_json, print_line


@space_app.command("conflict")
def space_conflict(
    design: Design,
    choose: Choose = [],
    where: Where = None,
    on: On = [],
    off: Off = [],
    output: Format = Output.TABLE,
) -> None:
    """Explain why no configuration is valid.

    Shows a smallest set of constraints that cannot be met together: dropping any one of them resolves this conflict.
    """
    part = opened(design, choose, where, on, off)
    if not part.is_empty():
        if output is Output.JSON:
            print_json({**part.data(), "empty": False, "conflict": []})
        else:
            console().print(plain(f"{part.title()}: there are valid configurations, nothing conflicts"))
        return
    found = part.conflict()
    if output is Output.JSON:
        print_json({**part.data(), "empty": True, "conflict": [constraint_data(constraint) for constraint in found]})
        return
    what = f"these {len(found)} constraints cannot all be met; without any one of them the others can"
    if len(found) < 2:
        what = "this constraint excludes everything" if found else "the choices exclude each other without constraints"
    print_line(f"{part.title()}: {what}")
    show_constraints(found)
