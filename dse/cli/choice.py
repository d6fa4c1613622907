"""Which design to take, on the terminal. The sentences are those of the report's page (`choice.ts`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dse.api import choice_lines
from dse.cli.terminal import print_line

if TYPE_CHECKING:
    from dse.analysis import Choice
    from dse.domain.definition import StudyDefinition


def show_choice(choice: Choice | None, definition: StudyDefinition, *, briefly: bool = False) -> None:
    """Print which design to take; nothing if there is no choice. *briefly* only its result and what is cheaper."""
    if choice is None:
        return
    print_line("which design:", style="bold")
    name, lines = choice_lines(choice, definition)
    print_line(f"  {name}")
    for label, text in lines:
        if not briefly or label in ("result", "misses", "cheaper"):
            print_line(f"  {label + ':':<10}{text}")
