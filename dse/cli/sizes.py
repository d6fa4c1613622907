"""Amounts of memory, as people read and write them."""

from __future__ import annotations

import re

import typer

_SIZES = {"TB": 1e12, "GB": 1e9, "MB": 1e6, "kB": 1e3, "B": 1.0}


def size_text(number: float) -> str:
    """So many bytes, to three digits."""
    for unit, size in _SIZES.items():
        if number >= size:
            return f"{number / size:.3g} {unit}"
    return f"{number:.0f} B"


def read_size(text: str) -> float:
    """The bytes that *text* means (``500 MB``). Raises BadParameter."""
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([kMGT]?B)\s*", text)
    if found is None:
        raise typer.BadParameter(f"'{text}' is not an amount of memory; write it as '500 MB'")
    return float(found[1]) * _SIZES[found[2]]
