"""Modifications and redeclarations that the front-end drops or keeps against the language: found, and refused."""

from __future__ import annotations

import re
from collections.abc import Iterator

from dse.errors import Problem
from dse.modelica.frontend.source_text import (
    BRACKET,
    CLASS_KINDS,
    PREFIXES,
    SourceText,
    arguments,
    inside,
    occurring,
    place,
)
from dse.modelica.frontend.used_classes import Used

NO_TYPES = "and|or|not|if|then|else|elseif|when|elsewhen|while|loop|in|equation|algorithm|return|for|end|extends"
"""Words that cannot be the name of a type."""
_SIZE = r"(?:\[[^\]]*\])?"
_TYPED = rf"(?:(?!(?:{CLASS_KINDS})\b)\w+\s+)*?[\w.]+(?:\s*+\[[^\]]*\])?+\s+"


def misread_modifications(read: Used) -> Iterator[Problem]:
    """Each modification in what is used that rumoca 0.10.2 takes for something else."""
    yield from _redeclared_with_changes(read)
    yield from _constrained_with_changes(read)
    yield from _redeclared_component(read)
    yield from _dotted(read)


_REDECLARED_CLASS = re.compile(rf"\bredeclare\s+{PREFIXES}(?:{CLASS_KINDS})\s+(\w+)\s*=\s*[\w.]+\s*{_SIZE}\s*\(")


def _redeclared_with_changes(read: Used) -> Iterator[Problem]:
    """The modifications of a redeclared class are dropped."""
    for _, match, where in occurring(read.texts, _REDECLARED_CLASS):
        what = f"the redeclaration of class '{match[1]}' modifies what it takes, which the front-end does not see"
        yield Problem(what, where, "declare a class that extends it with these modifications, and redeclare to that")


_CONSTRAINED = re.compile(rf"\b(constrainedby)\s+[\w.]+\s*{_SIZE}\s*\(")
_STATEMENT = re.compile(r"[;]|\b(?:public|protected|equation)\b")
_CLASS = re.compile(rf"\breplaceable\s+{PREFIXES}(?:{CLASS_KINDS})\b")
_COMPONENT = re.compile(rf"[\w.]+\s*{_SIZE}\s+(\w+)\s*{_SIZE}\s*\(")


def _constrained_with_changes(read: Used) -> Iterator[Problem]:
    """Modifications of the constraining class are dropped; no matter where a component says the same itself."""
    for source, match, where in occurring(read.texts, _CONSTRAINED):
        before = max((found.end() for found in _STATEMENT.finditer(source.text, 0, match.start())), default=0)
        declaration = source.text[before : match.start()]
        component = _COMPONENT.search(declaration)
        own = inside(declaration, component.end() - 1) if component and not _CLASS.search(declaration) else ""
        if _bare(own) != _bare(inside(source.text, match.end() - 1)):
            what = "'constrainedby' with modifications, which the front-end does not see, is not supported"
            yield Problem(what, where, "constrain by a class that extends it with these modifications")


_REPLACEABLE = re.compile(rf"\breplaceable\s+{_TYPED}(\w+)\s*{_SIZE}\s*\(")


def _redeclared_component(read: Used) -> Iterator[Problem]:
    """A component redeclared in a modification keeps the modifications of the declaration before, even where a class
    constrains it; one redeclared as an element loses them."""
    for source, match, _ in occurring(read.texts, _REPLACEABLE):
        own = inside(source.text, match.end() - 1)
        is_constrained = re.match(r"\)\s*constrainedby\b", source.text[match.end() + len(own) :]) is not None
        yield from _redeclarations(read, match[1], own, is_element=not is_constrained)
    for name in {match[1] for _, match, _ in occurring(read.texts, re.compile(rf"\bredeclare\s+{_TYPED}(\w+)\b"))}:
        changed = re.compile(rf"[(,]\s*(?:(?:each|final)\s+)*{re.escape(name)}\s*(\()")
        for source, match, _ in occurring(read.texts, changed):
            yield from _redeclarations(read, name, inside(source.text, match.end() - 1), is_element=True)


def _redeclarations(read: Used, name: str, own: str, *, is_element: bool) -> Iterator[Problem]:
    again = re.compile(rf"\bredeclare\s+{_TYPED}({re.escape(name)})\b\s*{_SIZE}\s*")
    for text, found, where in occurring(read.texts, again):
        if is_element == (re.search(r"[(,]\s*(?:(?:each|final)\s+)*$", text.text[: found.start()]) is not None):
            continue
        new = inside(text.text, found.end()) if text.text[found.end() : found.end() + 1] == "(" else ""
        missing = sorted(_names(own) - _names(new))
        if missing:
            how = "drops" if is_element else "keeps"
            what = f"the redeclaration of '{name}', for which the front-end {how} the modifications made before,"
            yield Problem(f"{what} is not supported", where, f"modify the same again here: {', '.join(missing)}")


def _names(modifications: str) -> set[str]:
    """What a list of modifications gives values to; of nested ones the text."""
    found = set()
    for start, end in arguments(modifications):
        part = _bare(re.sub(r"^\s*(?:(?:each|final)\s+)*", "", modifications[start:end]))
        simple = re.match(r"(\w+)=", part)
        found.add(simple[1] if simple else part)
    return found - {""}


def _bare(text: str) -> str:
    return re.sub(r"\s", "", text)


_MODIFIED = re.compile(
    rf"(?:\bextends\s+|\b(?:{CLASS_KINDS})\s+\w+\s*=\s*|(?<![\w.])(?!(?:{NO_TYPES})\b)[A-Za-z_][\w.]*+(?:\s*+\[[^\]]*\])?+\s+)"
    rf"(?!(?:annotation|{NO_TYPES})\b)(?P<first>[\w.]+\s*{_SIZE}\s*[(,=])"
)
_MODIFIES = re.compile(rf"\s*(?:(?:each|final)\s+)*(?P<name>\w+(?:\s*\.\s*\w+)*)\s*{_SIZE}\s*(?P<next>\(|=(?!=))?")


def _dotted(read: Used) -> Iterator[Problem]:
    """Modifications by dotted names are dropped."""
    for source in read.texts:
        seen: set[int] = set()
        for match in _MODIFIED.finditer(source.text):
            first = match.start("first")
            ends = source.text.find(";", first)
            whole = source.text[first : ends if ends >= 0 else len(source.text)]
            for start, end in arguments(whole):
                opened = re.compile(rf"\s*[\w.]+\s*{_SIZE}\s*\(").match(whole, start, end)
                if opened is not None:
                    seen.update(_dotted_in(source, first + opened.end()))
        for start in sorted(seen):
            name = re.compile(r"[\w.\s]*[\w]").match(source.text, start)
            what = (
                f"the modification of '{name[0] if name else ''}', which the front-end does not see, is not supported"
            )
            yield Problem(what, place(source, start), "nest it: a(b = 1) in place of a.b = 1")


def _dotted_in(source: SourceText, start: int) -> Iterator[int]:
    """Places of dotted names in the modifications whose bracket opens before *start*, and in those inside them."""
    text = source.text
    lists = {start - 1}
    depth: list[bool] = []
    for match in BRACKET.finditer(text, start - 1):
        if match[0] in "([{":
            depth.append(match.start() in lists)
        elif match[0] in ")]}":
            depth.pop()
        if not depth:
            return
        if match[0] in "(," and depth[-1]:
            modified = _MODIFIES.match(text, match.end())
            if modified is not None and modified["next"] is not None:
                if "." in modified["name"]:
                    yield modified.start("name")
                if modified["next"] == "(":
                    lists.add(modified.end() - 1)
