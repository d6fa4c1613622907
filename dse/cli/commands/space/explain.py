"""``dse space explain``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from dse.api import opened
from dse.cli.arguments import Choose, Design, Format, Off, On, Output, Where
from dse.cli.commands.space import space_app
from dse.cli.spaces import constraint_data, show_constraints
from dse.cli.terminal import print_json, print_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dse.space import Broken, Change, Explanation, Nearest, OpenedSpace


@space_app.command("explain")
def space_explain(
    design: Design,
    choose: Choose = [],
    where: Where = None,
    on: On = [],
    off: Off = [],
    output: Format = Output.TABLE,
) -> None:
    """Explain why a configuration is excluded, and show the nearest valid one.

    If only some choices are given: whether they can be completed, and if not, which constraints prevent it.
    """
    if not choose:
        raise typer.BadParameter("name the choices, as --choose sensor=radar", param_hint="--choose")
    part = opened(design, [], where, on, off)
    found = part.explain(choose)
    if found.is_whole:
        _show_whole(part, found, output)
    else:
        _show_part(part, found, output)


def _show_whole(part: OpenedSpace, found: Explanation, output: Output) -> None:
    broken, near = found.broken, found.nearest
    if output is Output.JSON:
        data = {**part.data(), "chosen": found.choices, "id": found.id, "valid": not broken}
        print_json({**data, "broken": [_broken_data(entry) for entry in broken], "nearest": _nearest_data(near)})
        return
    if not broken:
        print_line(f"{found.id} is valid: it meets all {len(part.space.constraints)} constraints")
        return
    print_line(f"{found.id} breaks {len(broken)} of {len(part.space.constraints)} constraints")
    for entry in broken:
        show_constraints([entry.constraint])
        _columns([(seen.what, seen.value) for seen in entry.seen], " = ")
    if near is None:
        print_line(f"no configuration is valid; ask why: dse space conflict {part.space.name}")
        return
    print_line(f"the nearest valid configuration is {near.id}:")
    _columns([(change.path, _arrow(change)) for change in near.changes], "  ")


def _show_part(part: OpenedSpace, found: Explanation, output: Output) -> None:
    choices = found.choices
    if output is Output.JSON:
        blamed = [constraint_data(constraint) for constraint in found.conflict]
        data = {**part.data(), "chosen": found.chosen}
        print_json({**data, "possible": found.is_valid, "first": choices, "conflict": blamed})
    elif choices is not None:
        print_line(f"these choices can be completed; the first configuration that has them is {found.id}:")
        _columns(list(choices.items()), " = ")
    elif found.conflict:
        print_line("no valid configuration has these choices, because of")
        show_constraints(found.conflict)
    else:
        print_line(f"these choices exclude each other in '{part.space.name}', whatever the constraints")


def _columns(entries: Sequence[tuple[str, str]], between: str) -> None:
    width = max((len(name) for name, _ in entries), default=0)
    for name, value in entries:
        print_line(f"      {name:<{width}}{between}{value}")


def _arrow(change: Change) -> str:
    return f"{change.before or 'absent'} -> {change.after or 'absent'}"


def _broken_data(entry: Broken) -> dict[str, object]:
    return {**constraint_data(entry.constraint), "seen": {seen.what: seen.value for seen in entry.seen}}


def _nearest_data(near: Nearest | None) -> dict[str, object] | None:
    if near is None:
        return None
    changes = [{"place": c.path, "before": c.before, "after": c.after} for c in near.changes]
    return {"id": near.id, "choices": dict(near.choices), "changes": changes}
