"""Choosing one configuration in the terminal, and what comes of it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from dse.cli.terminal import print_line
from dse.errors import fail
from dse.scratch import write_whole

if TYPE_CHECKING:
    from dse.domain.design import DesignSpace
    from dse.space import IdentifiedChoices, OpenedSpace


def choose(part: OpenedSpace, target: Path | None) -> None:
    """Let the user choose one configuration; print its id and its choices, or save them to *target*, a YAML file.

    Raises DseError if this is not a terminal, if the extra ``interactive`` is not installed, or if *target* cannot be
    written.
    """
    if target is not None and target.suffix.lower() not in (".yaml", ".yml"):
        raise typer.BadParameter(f"'{target.name}' must end in .yaml", param_hint="--output")
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        hint = "without one, use --where, or dse space count … --choose PLACE=CHOICE"
        raise fail("--interactive needs a terminal", None, hint)
    space = part.space
    if part.is_empty():
        hint = f"ask why: dse space conflict {space.name}"
        raise fail(f"'{space.name}' has no valid configuration", space.where, hint)
    try:
        from dse.cli.interactive.picker import Picker
    except ModuleNotFoundError as error:
        raise fail("--interactive needs textual", hint='pip install "dse-workbench[interactive]"') from error
    chosen = Picker(space, part.picking()).run()
    if chosen is None:
        return
    print_line(outcome(chosen))
    if target is not None:
        write_whole(target, choices_yaml(space, chosen))
        print_line(f"choices: {target}")


def outcome(chosen: IdentifiedChoices) -> str:
    """The id of a configuration, and the options that name it on a command line."""
    options = " ".join(f"--choose {path}={name}" for path, name in chosen.choices.items())
    return f"configuration {chosen.id}\n{options}".rstrip()


def choices_yaml(space: DesignSpace, chosen: IdentifiedChoices) -> str:
    """The choices as a YAML document: ``design``, ``configuration`` (its id) and ``choices`` by path."""
    import io

    from ruamel.yaml import YAML

    writer = YAML()
    writer.default_flow_style = False
    stream = io.StringIO()
    writer.dump({"design": space.name, "configuration": chosen.id, "choices": dict(chosen.choices)}, stream)
    return stream.getvalue()
