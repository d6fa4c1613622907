"""Functions that leave a loop by `return` or `break`, written without: with Booleans that say that it was left.

The front-end refuses such jumps. What follows one is put into ``if not left then … end if``, in its loop and behind it,
which is the same because a function has no other effects than its values. Lines stay where they are.

A loop by `while` whose number of turns the front-end does not find is one by `for` that is left where the condition is
false, and an assertion that it was left.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from dse.modelica.frontend.source_text import SourceText, code
from dse.modelica.frontend.used_classes import Classes

_TOKEN = re.compile(r"[()\[\]{};]|\b(?:if|then|elseif|else|for|while|when|loop|return|break)\b|\bend\s+\w+")
_JUMP = re.compile(r"\b(?:return|break)\s*;")
_WHILE = re.compile(r"\bwhile\b")
_ANNOTATION = re.compile(r"(?<=;)\s*annotation\b")
_RETURNED = "dse_returned"
_MOST_TURNS = 100
OPEN_LOOP = "a loop by while"
"""What the front-end's refusal of a loop by `while` says."""


def without_open_loops(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """*files* whose functions have no loops by `while`."""
    return {
        name: without_jumps(content.decode("utf-8", "replace"), whiles=True).encode()
        if b"while" in content
        else content
        for name, content in files.items()
    }


def without_jumps(text: str, *, whiles: bool = False) -> str:
    """*text* of a file with such functions rewritten, *whiles*: of such loops; what cannot be read stays as it is."""
    wanted = _WHILE if whiles else _JUMP
    if not wanted.search(text):
        return text
    clean = code(text)
    found = Classes([SourceText("", clean)])
    changes: list[_Change] = []
    for own in found.classes:
        if own.kind != "function" or own.inside:
            continue
        begins = re.compile(r"\balgorithm\b").search(clean, own.body, own.finish)
        if begins is None or not wanted.search(clean, begins.end(), own.finish):
            continue
        last = _ANNOTATION.search(clean, begins.end(), own.finish)
        body = _Body(clean, begins.end(), last.start() if last else own.finish, whiles)
        try:
            block = body.block()
        except (IndexError, ValueError):
            continue
        if body.place < len(body.tokens) or not (body.jumps_from_loop or whiles):
            continue
        declared = "".join(f"Boolean {name} = false; " for name in (*body.left, *(() if whiles else (_RETURNED,))))
        changes.append((begins.start(), begins.start(), f"protected {declared}"))
        changes += [*body.jumps, *_rewritten(block, frozenset())]
    for start, end, new in sorted(changes, key=lambda change: change[0], reverse=True):
        text = text[:start] + new + text[end:]
    return text


_Change = tuple[int, int, str]
"""Start and end of a piece of text, and what stands there instead."""


@dataclass(slots=True)
class _Statement:
    """From *start* to *end*; of a loop, *blocks* is its body, and *left* the name that says that a `break` ended it.

    Of one by `while` that is to be replaced, *words* are the places of `while`, `loop` and `end while`.
    """

    start: int
    end: int = -1
    blocks: list[_Block] = field(default_factory=list)
    is_loop: bool = False
    left: str = ""
    words: list[tuple[int, int]] = field(default_factory=list)
    flags: frozenset[str] = frozenset()
    """What the statement may set: that the function, or a loop around it, was left."""


@dataclass(slots=True)
class _Block:
    statements: list[_Statement] = field(default_factory=list)


def _rewritten(block: _Block, flags: frozenset[str]) -> Iterator[_Change]:
    """Changes so that the statements of *block* are carried out while none of *flags* is true.

    Of two texts at one place, the one before is the later one. A loop has its condition in its statements: the
    front-end takes no loop in a condition.
    """
    before = [
        frozenset(flags.union(*(one.flags for one in block.statements[:k]))) for k in range(len(block.statements))
    ]
    for statement, own in reversed(list(zip(block.statements, before, strict=True))):
        start, end = statement.start, statement.end
        inside = frozenset(flag for inner in statement.blocks for one in inner.statements for flag in one.flags)
        around = own | inside | {statement.left} - {""}
        if own and not statement.is_loop:
            yield end, end, " end if;"
        if statement.words:
            yield end, end, f' assert({" or ".join(sorted(around))}, "a loop of more than {_MOST_TURNS} turns");'
            yield *statement.words[2], "end for"
        for inner in reversed(statement.blocks):
            yield from _rewritten(inner, around if statement.is_loop else frozenset())
        if statement.words:
            turns = f"for {statement.left}_turn in 1:{_MOST_TURNS + 1} loop"
            yield *statement.words[1], "); end if;"
            yield *statement.words[0], f"{turns} {_if_none(around)}{statement.left} := not ("
        if own and not statement.is_loop:
            yield start, start, _if_none(own)
        if statement.left:
            yield start, start, f"{statement.left} := false; "


def _if_none(flags: frozenset[str]) -> str:
    return f"if {' and '.join(f'not {flag}' for flag in sorted(flags))} then "


class _Body:
    """The statements of a function's algorithm: text from *start* to *end*. Raises ValueError where it is not one."""

    def __init__(self, text: str, start: int, end: int, whiles: bool) -> None:
        self.text, self.start, self.end = text, start, end
        self.tokens = list(_TOKEN.finditer(text, start, end))
        self.place = 0
        self.left: list[str] = []
        self.jumps: list[_Change] = []
        self._whiles = whiles
        self.jumps_from_loop = False
        self._loops: list[_Statement] = []

    def block(self) -> _Block:
        """Statements up to a word that ends them, which is not taken."""
        block = _Block()
        while self.place < len(self.tokens) and not self._word().startswith(("end ", "else")):
            statement = _Statement(self._begin())
            self._statement(statement)
            statement.end = self._after()
            block.statements.append(statement)
        return block

    def _statement(self, statement: _Statement) -> None:
        word = self._word() if self.tokens[self.place].start() == statement.start else ""
        flags: set[str] = set()
        if word in ("return", "break"):
            start = self.tokens[self.place].start()
            self.place += 1
            self._take(";")
            flag = _RETURNED if word == "return" else self._left()
            self.jumps_from_loop |= bool(self._loops)
            self.jumps.append((start, self._after(), f"{flag} := true;"))
            flags = {flag}
        elif word in ("for", "while"):
            statement.is_loop = True
            begun = self.place
            self._until("loop")
            opened = self.place - 1
            self._loops.append(statement)
            statement.blocks.append(self.block())
            flags = {flag for one in statement.blocks[0].statements for flag in one.flags}
            if word == "while" and (flags or self._whiles):
                self._left()
                statement.words = [self.tokens[one].span() for one in (begun, opened, self.place)]
            self._loops.pop()
            self._take(f"end {word}")
            self._take(";")
            flags -= {statement.left}
        elif word == "if":
            self._until("then")
            statement.blocks.append(self.block())
            while self._word() in ("elseif", "else"):
                if self._word() == "elseif":
                    self._until("then")
                else:
                    self.place += 1
                statement.blocks.append(self.block())
            self._take("end if")
            self._take(";")
            flags = {flag for block in statement.blocks for one in block.statements for flag in one.flags}
        elif word:
            raise ValueError(word)
        else:
            self._until(";")
        statement.flags = frozenset(flags)

    def _left(self) -> str:
        loop = self._loops[-1]
        if not loop.left:
            loop.left = f"dse_{'done' if self._whiles else 'left'}_{len(self.left) + 1}"
            self.left.append(loop.left)
        return loop.left

    def _word(self) -> str:
        return re.sub(r"\s+", " ", self.tokens[self.place][0])

    def _take(self, word: str) -> None:
        if self._word() != word:
            raise ValueError(word)
        self.place += 1

    def _until(self, word: str) -> None:
        """Go behind *word*, but for one in brackets or in an expression with `if`."""
        if self._word() in ("if", "elseif", "for", "while"):
            self.place += 1
        depth = inner = 0
        while True:
            found = self._word()
            self.place += 1
            depth += (found in "([{") - (found in ")]}")
            if depth == 0 and found == word and not (inner and word == "then"):
                return
            if depth == 0 and found in ("if", "then", "elseif"):
                inner += 1 if found != "then" else -1

    def _after(self) -> int:
        return self.tokens[self.place - 1].end() if self.place else self.start

    def _begin(self) -> int:
        match = re.compile(r"\S").search(self.text, self._after(), self.end)
        if match is None:
            raise ValueError
        return match.start()
