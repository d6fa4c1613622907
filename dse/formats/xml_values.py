"""Attributes of XML elements as values: as XML Schema writes them, or a problem where they stand."""

from __future__ import annotations

import re
from collections.abc import Collection

from dse.errors import Problem, closest
from dse.formats.xml import XmlElement

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


def required(element: XmlElement, name: str, problems: list[Problem]) -> str:
    """The attribute's text; "" and a problem if it is not there or empty."""
    text = element.get(name)
    if not text:
        problems.append(Problem(f"<{element.tag}> has no '{name}'", element.where))
    return text


def real(element: XmlElement, name: str, problems: list[Problem]) -> float | None:
    """The attribute as a number; None if it is not there, and a problem if it is no number."""
    text = element.attributes.get(name)
    value = None if text is None else real_of(text)
    if text is not None and value is None:
        problems.append(_unfit(element, name, text, "a number"))
    return value


def whole(
    element: XmlElement, name: str, problems: list[Problem], *, least: int | None = None, most: int | None = None
) -> int | None:
    """The attribute as a whole number from *least* to *most*; None if it is not there, and a problem if it is not."""
    text = element.attributes.get(name)
    value = None if text is None else whole_of(text)
    if text is not None and value is None:
        problems.append(_unfit(element, name, text, "a whole number"))
    elif value is not None and least is not None and value < least:
        problems.append(_unfit(element, name, str(value), f"at least {least}"))
        return None
    elif value is not None and most is not None and value > most:
        problems.append(_unfit(element, name, str(value), f"at most {most}"))
        return None
    return value


def flag(element: XmlElement, name: str, problems: list[Problem], *, default: bool = False) -> bool:
    """The attribute as a truth value; *default* if it is not there, and a problem if it is none."""
    text = element.attributes.get(name)
    value = default if text is None else flag_of(text)
    if value is None:
        problems.append(_unfit(element, name, text or "", "true or false"))
        return default
    return value


def word(element: XmlElement, name: str, words: Collection[str], problems: list[Problem], default: str = "") -> str:
    """The attribute as one of *words*; *default* if it is not there, and a problem if it is another."""
    text = element.attributes.get(name)
    if text is None:
        return default
    if text.strip() in words:
        return text.strip()
    what = f"<{element.tag}>: '{name}' cannot be '{shortened(text)}'"
    problems.append(Problem(what, element.where, closest(text, words)))
    return default


def shortened(text: str) -> str:
    """*text*, cut to what a message can hold."""
    return text if len(text) <= 60 else f"{text[:60]}…"


def _unfit(element: XmlElement, name: str, text: str, expected: str) -> Problem:
    return Problem(f"<{element.tag}>: '{name}' is '{shortened(text)}', not {expected}", element.where)
