"""The texts of XML attributes as values, as XML Schema writes them."""

from __future__ import annotations

import re

_LONGEST = 100
_WHOLE = re.compile(r"[+-]?[0-9]+")
_REAL = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
# XML Schema's are INF, -INF and NaN; programs often write those of their language.
_SPECIAL = re.compile(r"[+-]?(?:inf|infinity)|nan", re.IGNORECASE)


def real_of(text: str) -> float | None:
    """The number an ``xs:double`` stands for (``INF``, ``-INF`` and ``NaN`` are some, in any case), or None."""
    text = text.strip()
    return float(text) if len(text) <= _LONGEST and (_REAL.fullmatch(text) or _SPECIAL.fullmatch(text)) else None


def whole_of(text: str) -> int | None:
    """The number an ``xs:integer`` stands for, or None."""
    text = text.strip()
    return int(text) if len(text) <= _LONGEST and _WHOLE.fullmatch(text) else None


def flag_of(text: str) -> bool | None:
    """The truth value an ``xs:boolean`` stands for, or None."""
    return {"true": True, "1": True, "false": False, "0": False}.get(text.strip())


def shortened(text: str) -> str:
    """*text*, cut to what a message can hold."""
    return text if len(text) <= 60 else f"{text[:60]}…"
