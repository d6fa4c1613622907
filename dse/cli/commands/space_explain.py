"""``dse space explain``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from dse.cli.app import console, plain, print_json
from dse.cli.arguments import Design, Format, Output
from dse.cli.asking import ask
from dse.cli.commands.space_conflict import constraint_data, show_constraints
from dse.cli.space import Choose, Off, On, Where, space_app

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dse.cli.asking import Question
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
    from dse.space.choosing import completed, read_choices

    if not choose:
        raise typer.BadParameter("name the choices, as --choose sensor=radar", param_hint="--choose")
    # Its engine is that of the whole space: a configuration is compared with all others.
    whole = ask(design, [], where, on, off)
    chosen = read_choices(whole.space, choose)
    configuration = completed(whole.space, chosen)
    if configuration is not None:
        _explain_whole(whole, configuration, output)
    else:
        _explain_part(ask(design, choose, where, on, off), output)


def _explain_whole(question: Question, choices: dict[str, str], output: Output) -> None:
    from dse.space.questions.explain import explain
    from dse.space.questions.nearest import nearest
    from dse.space.resolve import identify

    broken = explain(question.space, choices)
    near = nearest(question.engine, choices) if broken and not question.engine.is_empty() else None
    if output is Output.JSON:
        data = {**question.data(), "chosen": choices, "id": identify(choices), "valid": not broken}
        print_json({**data, "broken": [_broken_data(entry) for entry in broken], "nearest": _nearest_data(near)})
        return
    if not broken:
        _say(f"{identify(choices)} is valid: it meets all {len(question.space.constraints)} constraints")
        return
    _say(f"{identify(choices)} breaks {len(broken)} of {len(question.space.constraints)} constraints")
    for entry in broken:
        show_constraints([entry.constraint])
        _columns([(seen.what, seen.value) for seen in entry.seen], " = ")
    if near is None:
        _say(f"no configuration is valid; ask why: dse space conflict {question.space.name}")
        return
    _say(f"the nearest valid configuration is {identify(near.choices)}:")
    _columns([(change.path, _arrow(change)) for change in near.changes], "  ")


def _explain_part(question: Question, output: Output) -> None:
    from dse.space.questions.conflict import conflict
    from dse.space.resolve import identify

    row = question.engine.first()
    found = conflict(question.engine) if row is None else ()
    choices = question.engine.flat.choices(row) if row is not None else None
    if output is Output.JSON:
        blamed = [constraint_data(constraint) for constraint in found]
        print_json({**question.data(), "possible": row is not None, "first": choices, "conflict": blamed})
    elif choices is not None:
        _say(f"these choices can be completed; the first configuration that has them is {identify(choices)}:")
        _columns(list(choices.items()), " = ")
    elif found:
        _say("no valid configuration has these choices, because of")
        show_constraints(found)
    else:
        _say(f"these choices exclude each other in '{question.space.name}', whatever the constraints")


def _say(text: str) -> None:
    console().print(plain(text), soft_wrap=True)


def _columns(entries: Sequence[tuple[str, str]], between: str) -> None:
    width = max((len(name) for name, _ in entries), default=0)
    for name, value in entries:
        _say(f"      {name:<{width}}{between}{value}")


def _arrow(change: Change) -> str:
    return f"{change.before or 'absent'} -> {change.after or 'absent'}"


def _broken_data(entry: Broken) -> dict[str, object]:
    return {**constraint_data(entry.constraint), "seen": {seen.what: seen.value for seen in entry.seen}}


def _nearest_data(near: Nearest | None) -> dict[str, object] | None:
    from dse.space.resolve import identify

    if near is None:
        return None
    changes = [{"place": c.path, "before": c.before, "after": c.after} for c in near.changes]
    return {"id": identify(near.choices), "choices": dict(near.choices), "changes": changes}
