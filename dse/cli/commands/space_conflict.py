"""``dse space conflict``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dse.api.naming import opened
from dse.cli.app import console, plain, print_json
from dse.cli.arguments import Design, Format, Output
from dse.cli.space import Choose, Off, On, Where, space_app

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dse.domain.design import Constraint


@space_app.command("conflict")
def space_conflict(
    design: Design,
    choose: Choose = [],
    where: Where = None,
    on: On = [],
    off: Off = [],
    output: Format = Output.TABLE,
) -> None:
    """Tell why nothing is left.

    Names a smallest set of constraints that cannot be met together: dropping any one of them helps.
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
    console().print(plain(f"{part.title()}: {what}"), soft_wrap=True)
    show_constraints(found)


def constraint_data(constraint: Constraint) -> dict[str, object]:
    """A constraint for `print_json`."""
    where = str(constraint.where) if constraint.where else None
    return {
        "constraint": constraint.name,
        "text": constraint.rule.text,
        "because": constraint.because,
        "where": where,
    }


def show_constraints(constraints: Iterable[Constraint]) -> None:
    """Constraints in the user's words, the reason and the place in the file below each."""
    screen = console()
    for constraint in constraints:
        text = " ".join(constraint.rule.text.split())
        screen.print(plain(f"  {constraint.name}: {text}"), soft_wrap=True)
        beside = [constraint.because] if constraint.because and constraint.because != text else []
        beside += [str(constraint.where)] if constraint.where else []
        if beside:
            screen.print(plain(f"      {' · '.join(beside)}"), soft_wrap=True, style="dim")
