"""``dse space compare``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import opened
from dse.cli.arguments import Design, Format, Off, On, Output, Seed
from dse.cli.commands.space import space_app
from dse.cli.spaces import number_text, tally_data, tally_text
from dse.cli.terminal import print_json, print_line

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dse.space import Difference, Tally


@space_app.command("compare")
def space_compare(
    before: Design,
    after: Annotated[str, typer.Argument(metavar="OTHER", help="The design space to compare it with.")],
    on: On = [],
    off: Off = [],
    seed: Seed = 0,
    output: Format = Output.TABLE,
) -> None:
    """Show how two design spaces differ.

    Added and removed alternatives and constraints, and the number of configurations in both and in only one of them.
    """
    found = opened(before, on=on, off=off).difference(opened(after, on=on, off=off), seed)
    if output is Output.JSON:
        print_json({"before": before, "after": after, **_data(found)})
        return
    lines = [
        *(f"- {entry}" for entry in _alternatives(found.removed)),
        *(f"+ {entry}" for entry in _alternatives(found.added)),
        *(f"- constraint {name}" for name in found.constraints_removed),
        *(f"+ constraint {name}" for name in found.constraints_added),
        *(f"~ constraint {name}" for name in found.changed),
    ]
    lines = lines or ["the same alternatives and constraints"]
    for name, tally in ((before, found.before), (after, found.after)):
        lines.append(f"{name}: {tally_text(tally)} valid{_alone(tally, found.common)}")
    lines.append(f"in both: {tally_text(found.common)}")
    for line in lines:
        print_line(line)


def _alone(tally: Tally, common: Tally) -> str:
    # The difference of two estimates says little where the spaces are nearly the same.
    return f", {number_text(tally.value - common.value)} of them only here" if tally.exact and common.exact else ""


def _data(found: Difference) -> dict[str, object]:
    return {
        "alternatives_removed": _entries(found.removed),
        "alternatives_added": _entries(found.added),
        "constraints_removed": list(found.constraints_removed),
        "constraints_added": list(found.constraints_added),
        "constraints_changed": list(found.changed),
        "valid_before": tally_data(found.before),
        "valid_after": tally_data(found.after),
        "common": tally_data(found.common),
    }


def _entries(entries: Iterable[tuple[str, str | None]]) -> list[dict[str, str | None]]:
    return [{"place": path, "choice": choice} for path, choice in entries]


def _alternatives(entries: Iterable[tuple[str, str | None]]) -> list[str]:
    return [f"{path}={choice or 'absent'}" for path, choice in entries]
