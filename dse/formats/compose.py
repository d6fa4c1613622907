"""YAML text → nodes; what is no YAML is told where its repair is."""

from __future__ import annotations

import re
from typing import Any

from dse.errors import DseError, Location, fail

MOST_LEVELS = 100

_OPENED = ("while parsing a flow sequence", "while parsing a flow mapping", "while scanning a quoted scalar")
_CLOSING = {"[": "]", "{": "}"}

# Invisible, or turning round what stands beside them: no terminal and no page should be given these.
UNSAFE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\u202a-\u202e\u2066-\u2069]")


def compose(text: str, file: str) -> Any:
    """The nodes of *text*, the content of *file*; None if there is nothing. Raises DseError where it is no YAML."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError
    from ruamel.yaml.reader import ReaderError

    try:
        return YAML(typ="safe", pure=True).compose(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        is_open = str(error.context) in _OPENED
        opening = error.context_mark if is_open else _quote_before(text, mark)
        if opening and mark and opening.line != mark.line:
            where = Location(file, opening.line + 1, opening.column + 1)
            sign = text[opening.index : opening.index + 1]
            raise fail(f"not valid YAML: {sign} is never closed", where, f"add {_CLOSING.get(sign, sign)}") from None
        where = Location(file, mark.line + 1, mark.column + 1) if mark else Location(file)
        what = visible(" ".join(str(error.problem or error.context or "unreadable").split()))
        raise fail(
            f"not valid YAML: {what}", where, "check indentation, quotes and brackets here and just above"
        ) from None
    except ReaderError as error:
        before = text[: error.position]
        where = Location(file, before.count("\n") + 1, len(before) - before.rfind("\n"))
        raise unsafe(chr(error.character), where) from None
    except (YAMLError, ValueError) as error:
        first = str(error).strip().splitlines()[0]
        raise fail(f"not valid YAML: {visible(first)}", Location(file)) from None
    except RecursionError:
        raise fail("nested too deeply", Location(file), f"use at most {MOST_LEVELS} levels") from None


def unsafe(text: str, where: Location) -> DseError:
    """The DseError that *text* holds a character that no text may hold."""
    found = UNSAFE.search(text)
    sign = found[0] if found else text
    return fail(f"the character U+{ord(sign):04X} cannot be used in a text", where, "remove it; it does not show")


def visible(text: str) -> str:
    """*text* with its unsafe characters as codes."""
    return UNSAFE.sub(lambda found: f"U+{ord(found[0]):04X}", text)


def _quote_before(text: str, mark: Any) -> Any:
    """Where the quote stands that ends just before *mark* in another line than it began: likely one that is not closed.

    None if there is none.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    last = None
    try:
        for token in YAML(typ="safe", pure=True).scan(text):
            if mark is None or token.start_mark.index >= mark.index:
                break
            if getattr(token, "style", None) in ("'", '"'):
                last = token
    except YAMLError:
        pass
    if last is None or last.end_mark.line != mark.line or last.start_mark.line == mark.line:
        return None
    return last.start_mark
