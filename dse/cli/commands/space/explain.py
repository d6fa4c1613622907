"""``dse space explain``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from dse.api.naming import space_of
from dse.api.spaces.question import ask
from dse.cli.arguments import Choose, Design, Format, Off, On, Output, Where
from dse.cli.commands.space import space_app
from dse.cli.spaces import constraint_data, show_constraints
from dse.cli.terminal import print_json, say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dse.api.spaces.explaining import Explanation
    from dse.space.questions.explain import Broken
    from dse.space.questions.nearest import Change, Nearest


@space_app.command("explain")
def space_explain(
    design: Design,
    choose: Choose = [],
    where: Where = None,
    on: On = [],
    off: Off = [],
    output: Format = Output.TABLE,
) -> None:
    """Tell why a configuration is excluded, and which valid one is nearest.

    With some of the choices only: whether they can be completed, and if not, which constraints stand in the way.
    """
    from dse.api.spaces.explaining import explain

    if not choose:
        raise typer.BadParameter("name the choices, as --choose sensor=radar", param_hint="--choose")
    found = explain(ask(space_of(design), [], where, on, off), choose)
    if found.is_whole:
        _show_whole(found, output)
    else:
        _show_part(found, output)


def _show_whole(found: Explanation, output: Output) -> None:
    question, broken, near = found.question, found.broken, found.nearest
    if output is Output.JSON:
        data = {**question.data(), "chosen": found.choices, "id": found.id, "valid": not broken}
        print_json({**data, "broken": [_broken_data(entry) for entry in broken], "nearest": _nearest_data(near)})
        return
    if not broken:
        _say(f"{found.id} is valid: it meets all {len(question.space.constraints)} constraints")
        return
    _say(f"{found.id} breaks {len(broken)} of {len(question.space.constraints)} constraints")
    for entry in broken:
        show_constraints([entry.constraint])
        _columns([(seen.what, seen.value) for seen in entry.seen], " = ")
    if near is None:
        _say(f"no configuration is valid; ask why: dse space conflict {question.space.name}")
        return
    _say(f"the nearest valid configuration is {near.id}:")
    _columns([(change.path, _arrow(change)) for change in near.changes], "  ")


def _show_part(found: Explanation, output: Output) -> None:
    question, choices = found.question, found.choices
    if output is Output.JSON:
        blamed = [constraint_data(constraint) for constraint in found.conflict]
        print_json({**question.data(), "possible": found.is_valid, "first": choices, "conflict": blamed})
    elif choices is not None:
        _say(f"these choices can be completed; the first configuration that has them is {found.id}:")
        _columns(list(choices.items()), " = ")
    elif found.conflict:
        _say("no valid configuration has these choices, because of")
        show_constraints(found.conflict)
    else:
        _say(f"these choices exclude each other in '{question.space.name}', whatever the constraints")


def _say(text: str) -> None:
    say(text)


def _columns(entries: Sequence[tuple[str, str]], between: str) -> None:
    width = max((len(name) for name, _ in entries), default=0)
    for name, value in entries:
        _say(f"      {name:<{width}}{between}{value}")


def _arrow(change: Change) -> str:
    return f"{change.before or 'absent'} -> {change.after or 'absent'}"


def _broken_data(entry: Broken) -> dict[str, object]:
    return {**constraint_data(entry.constraint), "seen": {seen.what: seen.value for seen in entry.seen}}


def _nearest_data(near: Nearest | None) -> dict[str, object] | None:
    if near is None:
        return None
    changes = [{"place": c.path, "before": c.before, "after": c.after} for c in near.changes]
    return {"id": near.id, "choices": dict(near.choices), "changes": changes}
