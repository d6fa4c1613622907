"""Cuts a UVL file into lines of tokens, each line with its indentation.

A line goes on until its brackets are closed. Blanks and comments, ``// …`` and ``/* … */``, are skipped. The
letters are those of the reference grammar, https://github.com/Universal-Variability-Language/uvl-parser; names
may also start with an underscore or any letter of Unicode, and numbers may have an exponent.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from pathlib import Path
from typing import NamedTuple

from dse.errors import DseError, Location, Problem, fail
from dse.expression import error_at
from dse.formats import UNSAFE, shown

MOST_BYTES = 100_000_000
"""Files beyond this are refused."""

MOST_PROBLEMS = 100
"""Problems after which reading a file stops."""


class Token(NamedTuple):
    """A piece of the text; *kind* is name, quoted (*text* without the quotes), number, text or symbol."""

    kind: str
    text: str
    start: int
    end: int

    def __str__(self) -> str:
        return f"'{self.text}'"


class Line(NamedTuple):
    """A logical line; *indent* is the column its first token starts in, a tab reaching to the next multiple of 8."""

    indent: int
    tokens: list[Token]


class Source:
    """The text of one file, and every problem found in it so far."""

    def __init__(self, file: str, text: str) -> None:
        self.file = file
        self.text = text
        self.problems: list[Problem] = []
        self._starts = [0, *(match.end() for match in re.finditer(r"\r\n|\n|\r", text))]

    def location(self, start: int) -> Location:
        """Where the character number *start* stands."""
        line = bisect_right(self._starts, start)
        return Location(self.file, line, start - self._starts[line - 1] + 1)

    def error(self, start: int, what: str, advice: str = "look here") -> DseError:
        """A DseError at the character number *start*, whose hint shows its line with a caret."""
        where = self.location(start)
        line = re.match(r"[^\r\n]*", self.text[start - where.column + 1 :])
        text = line[0] if line else ""
        return error_at(text, (where.column - 1,) * 2, what, Location(self.file, where.line, 1), advice)

    def note(self, start: int, what: str, advice: str = "look here") -> None:
        """Add a problem; raises DseError with all of them once there are `MOST_PROBLEMS`."""
        self.add(self.error(start, what, advice))

    def add(self, error: DseError) -> None:
        """Add the problems of *error*, like `note`."""
        self.problems += error.problems
        if len(self.problems) >= MOST_PROBLEMS:
            raise DseError(*self.problems)


def read_source(path: Path) -> Source:
    """The text of the file at *path*. Raises DseError, located, if it is not UTF-8 text or too large."""
    file = shown(path)
    try:
        if not path.is_file():
            what = "this is a folder, not a file" if path.is_dir() else "no such file"
            raise fail(what, Location(file), "name a UVL file")
        with path.open("rb") as stream:
            content = stream.read(MOST_BYTES + 1)
    except OSError as error:
        raise fail(f"cannot be read: {error.strerror or error}", Location(file), "check its permissions") from None
    if len(content) > MOST_BYTES:
        raise fail(f"the file is larger than {MOST_BYTES // 1_000_000} MB", Location(file), "split the model")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = Source(file, error.object[: error.start].decode("utf-8-sig"))
        where = before.location(len(before.text))
        raise fail("a character that is not UTF-8", where, "save the file as UTF-8") from None
    return Source(file, text)


def split(source: Source) -> list[Line]:
    """The logical lines of *source* that hold anything. What is no token is noted and left out."""
    if unsafe := UNSAFE.search(source.text.translate({0x0C: " ", 0x0D: " "})):
        what = f"the character U+{ord(unsafe[0]):04X} cannot be used in a text"
        raise source.error(unsafe.start(), what, "remove it; it does not show")
    text = source.text
    lines: list[Line] = []
    tokens: list[Token] = []
    opened: list[Token] = []
    line_start = 0
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup
        if kind == "blank":
            continue
        if kind == "newline":
            if not opened:
                line_start = match.end()
                tokens = []
            continue
        start, end = match.span()
        if kind in ("wrong", "foreign"):
            _note_foreign(source, match[0], start)
            continue
        token = Token(kind or "", text[start + 1 : end - 1] if kind in ("quoted", "text") else match[0], start, end)
        if not tokens:
            lines.append(Line(len(text[line_start:start].expandtabs(8)), tokens))
        tokens.append(token)
        if kind == "symbol":
            if token.text in _CLOSING:
                opened.append(token)
            elif token.text in _CLOSING.values():
                _close(source, opened, token)
    for token in opened:
        source.note(token.start, f"'{token.text}' is never closed", f"add '{_CLOSING[token.text]}'")
    return lines


_CLOSING = {"(": ")", "[": "]", "{": "}"}
_TOKEN = re.compile(
    r"""(?P<blank>[ \t\f]+|//[^\r\n]*|/\*(?:[^*]|\*(?!/))*\*/)
    |(?P<newline>\r\n|\n|\r)
    |(?P<name>[^\W\d][\w#§%?\\';]*)
    |(?P<number>(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)
    |(?P<quoted>"[^"\r\n]+")
    |(?P<text>'[^'\r\n]*')
    |(?P<wrong>/\*|&&|\|\||<->|->|"")
    |(?P<symbol><=>|=>|==|!=|<=|>=|\.\.|[-+*/!&|<>(){}\[\],.])
    |(?P<foreign>.)""",
    re.VERBOSE,
)
_FOREIGN_ADVICE = {
    "&&": "write &",
    "||": "write |",
    "->": "write =>",
    "<->": "write <=>",
    "=": "write == to compare",
    "~": "write !",
    "¬": "write !",
    "∧": "write &",
    "∨": "write |",
    "→": "write =>",
    "⇒": "write =>",
    "↔": "write <=>",
    "⇔": "write <=>",
    "≤": "write <=",
    "≥": "write >=",
    "≠": "write !=",
}


def _note_foreign(source: Source, text: str, start: int) -> None:
    if text in ('"', "'", "/*"):
        source.note(start, f"{text} is never closed", "close it" if text == "/*" else f"add {text} in the same line")
    elif text == '""':
        source.note(start, "a name without letters", "write a name between the quotes")
    else:
        advice = _FOREIGN_ADVICE.get(
            text, 'a name with characters other than letters, digits and _ is written in quotes: "A:B"'
        )
        source.note(start, f"'{text}' is not known here", advice)


def _close(source: Source, opened: list[Token], token: Token) -> None:
    if not opened:
        raise source.error(token.start, f"'{token.text}' closes nothing", "remove it")
    opening = opened.pop()
    if _CLOSING[opening.text] != token.text:
        where = source.location(opening.start)
        what = f"'{token.text}' does not close '{opening.text}' of {where.line}:{where.column}"
        raise source.error(token.start, what, f"write '{_CLOSING[opening.text]}'")
