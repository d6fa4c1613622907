"""Problems as data: for a program, for code scanning (SARIF), and for the log of a GitHub workflow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import PurePath
from urllib.parse import quote

from dse import __version__
from dse.errors import Problem

_SARIF = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_RULES = {"error": "what cannot be used", "warning": "what is ignored", "note": "what is of no use here"}


class CheckFormat(StrEnum):
    """What ``dse check`` prints for."""

    TEXT = "text"
    JSON = "json"
    SARIF = "sarif"
    GITHUB = "github"


@dataclass(frozen=True, slots=True)
class Checked:
    """What a check found: *counts* of what was read, lines of *details*, and *more* to say behind the counts."""

    problems: Sequence[Problem] = ()
    ignored: Sequence[Problem] = ()
    counts: Mapping[str, int] = field(default_factory=dict)
    notes: Sequence[Problem] = ()
    details: Sequence[str] = ()
    more: str = ""

    def levels(self) -> list[tuple[str, Problem]]:
        """Everything found with how bad it is, in the words of SARIF."""
        found = zip(_RULES, (self.problems, self.ignored, self.notes), strict=True)
        return [(level, each) for level, problems in found for each in problems]


def as_data(found: Checked) -> dict[str, object]:
    """The problems with their places, and how many files of each kind were checked."""
    return {
        "problems": [
            {"level": level, **_place(each), "message": each.what, "hint": each.hint} for level, each in found.levels()
        ],
        "checked": dict(found.counts),
    }


def as_sarif(found: Checked) -> dict[str, object]:
    """A log of SARIF 2.1.0 with one run; places are relative to the current folder, as those in messages."""
    driver = {
        "name": "dse",
        "version": __version__,
        "rules": [{"id": rule, "shortDescription": {"text": text}} for rule, text in _RULES.items()],
    }
    results = []
    for level, each in found.levels():
        text = f"{each.what} ({each.hint})" if each.hint else each.what
        result: dict[str, object] = {"ruleId": level, "level": level, "message": {"text": text}}
        if each.where is not None:
            file = PurePath(each.where.file)
            place: dict[str, object] = {
                "artifactLocation": {"uri": file.as_uri() if file.is_absolute() else quote(file.as_posix())}
            }
            if each.where.line:
                place["region"] = {"startLine": each.where.line, "startColumn": max(each.where.column, 1)}
            result["locations"] = [{"physicalLocation": place}]
        results.append(result)
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return {"$schema": _SARIF, "version": "2.1.0", "runs": [run]}


def as_github(found: Checked) -> list[str]:
    """A workflow command for each problem, which GitHub shows beside the line that it is about."""
    lines = []
    for level, each in found.levels():
        names = {"file": "file", "line": "line", "column": "col"}
        values = (f"{names[key]}={_escaped(str(value), ':,')}" for key, value in _place(each).items() if value)
        text = f"{each.what}\nhint: {each.hint}" if each.hint else each.what
        lines.append(f"::{'notice' if level == 'note' else level} {','.join(values)}::{_escaped(text)}")
    return lines


def _place(problem: Problem) -> dict[str, object]:
    where = problem.where
    return {"file": where.file, "line": where.line, "column": where.column} if where else {}


def _escaped(text: str, more: str = "") -> str:
    """*text* for a workflow command, in which an end of line would begin another command."""
    for character in ("%", "\r", "\n", *more):
        text = text.replace(character, f"%{ord(character):02X}")
    return text
