"""What the front-end gives: the flat system as it writes it, and the texts it was read from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from dse.errors import Location
from dse.modelica.frontend.source_text import SourceText

SCHEMA = 43
"""The layout of the flat system the reader knows."""


@dataclass(frozen=True, slots=True)
class FrontEndResult:
    """*dae* and *flat* as the front-end's ``to_dict`` gives them; *sources* by the numbers that spans refer to.

    *structural* names the parameters whose values the front-end used: another value needs another compilation.
    """

    model: str
    dae: Mapping[str, Any]
    flat: Mapping[str, Any]
    sources: Mapping[int, SourceText]
    structural: frozenset[str] = frozenset()
    description: str = ""

    def location(self, source: int, offset: int) -> Location | None:
        """Where the byte *offset* of source number *source* stands in the user's files; None for other sources."""
        text = self.sources.get(source)
        return text.location(offset) if text is not None else None
