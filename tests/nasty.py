"""JSON documents in which one value is replaced by what a stranger might send."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

NASTY = (
    "9" * 400, "-" + "9" * 400, str(1 << 63), "9" * 30, "1e999", "NaN", "Infinity", "-Infinity", "-0", "-0.0", "1e308",
    "5e-324", "true", "false", "null", "[]", "{}", '""', "[" * 60 + "]" * 60, "[" * 900 + "]" * 900, '{"a":' * 700,
    "[" * 100_000, json.dumps("x" * 3000), r'"\u0000"', r'"a\u0000b"', r'"\ud800"', r'"\udfff"', r'"\u202e"', '"1.5"',
    '["a", 1]', "'", "",
)  # fmt: skip
"""Texts to be put in the place of a value; not all of them are JSON."""

_MARK = "the value to be replaced"


def leaves(data: object) -> list[tuple[Any, ...]]:
    """Where the values are in *data* that hold no others, and empty lists and objects."""
    entries = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [(key, *rest) for key, entry in entries for rest in leaves(entry)] or [()]


def replaced(data: Any, place: tuple[Any, ...], text: str) -> str:
    """*data* as JSON with *text* at *place*."""

    def marked(part: Any, rest: tuple[Any, ...]) -> Any:
        if not rest:
            return _MARK
        copy = dict(part) if isinstance(part, dict) else list(part)
        copy[rest[0]] = marked(part[rest[0]], rest[1:])
        return copy

    return json.dumps(marked(data, place)).replace(f'"{_MARK}"', text)


def nasty_texts(data: object) -> Iterator[str]:
    """*data* with each leaf replaced by each nasty value."""
    return (replaced(data, place, text) for place in leaves(data) for text in NASTY)
