"""What was learnt, on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from dse.cli.terminal import print_line

if TYPE_CHECKING:
    from dse.analysis import Finding


def print_findings(found: Sequence[Finding]) -> None:
    """Line by line, under what they are about."""
    for plane, those in groupby(found, lambda each: each.plane):
        if plane:
            print_line(f"varied: {', '.join(plane)}; all else held", style="bold")
        for topic, some in groupby(those, lambda each: each.topic):
            print_line(f"{topic}:", style="bold")
            for each in some:
                print_line(f"  {each.text}")
