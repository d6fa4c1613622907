"""Which words can be names."""

from __future__ import annotations

import re

from dse.errors import Location, Problem
from dse.expression import KEYWORDS

_C = """
auto bool break case char const continue default do double else enum extern false float for goto if inline int long
register restrict return short signed sizeof static struct switch true typedef union unsigned void volatile while
"""
_C_KEYWORDS = frozenset(_C.split())
"""Keywords of C11, and the words <stdbool.h> adds."""

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def check_name(name: str, where: Location, problems: list[Problem]) -> None:
    """Add a problem unless *name* can stand in dotted paths and expressions."""
    if not _NAME.fullmatch(name):
        problems.append(Problem(f"'{name}' cannot be a name", where, "use letters, digits and _, not a digit first"))
    elif name in KEYWORDS:
        problems.append(Problem(f"'{name}' is a word of the expression language", where, "choose another name"))


def check_choice(name: str, where: Location, problems: list[Problem]) -> None:
    """Add a problem unless *name* can be that of what is chosen at a place: a component or an architecture."""
    if name in ("absent", "present"):
        what = f"'{name}' tests whether a part is present, so nothing can have that name"
        problems.append(Problem(what, where, "choose another name"))
    else:
        check_name(name, where, problems)


def check_member(name: str, where: Location, problems: list[Problem]) -> None:
    """Add a problem unless *name* can be that of a port or parameter: of a member of a C struct, too."""
    if name in _C_KEYWORDS:
        problems.append(Problem(f"'{name}' is a word of C, so C code cannot have it", where, "choose another name"))
    else:
        check_name(name, where, problems)


def is_identifier(name: str) -> bool:
    """Whether C code can define *name*."""
    return bool(_NAME.fullmatch(name)) and name not in _C_KEYWORDS
