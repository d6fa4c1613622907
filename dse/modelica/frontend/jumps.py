"""Functions that leave a loop by `return` or `break`, written without: with Booleans that say that it was left.

The front-end refuses such jumps. What follows one is put into ``if not left then … end if``, in its loop and behind it,
which is the same because a function has no other effects than its values. Lines stay where they are.

A loop by `while` whose number of turns the front-end does not find is one by `for` that is left where the condition is
false, and an assertion that it was left.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

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
    changes: list[_Change] = []
    for own in Classes([SourceText("", clean)]).classes:
        if own.kind != "function" or own.inside:
            continue
        begins = re.compile(r"\balgorithm\b").search(clean, own.body, own.finish)
        if begins is None or not wanted.search(clean, begins.end(), own.finish):
            continue
        last = _ANNOTATION.search(clean, begins.end(), own.finish)
        body = _Body(clean, begins.end(), last.start() if last else own.finish, whiles)
        try:
            new, flags = body.block(frozenset(), "")
        except (IndexError, ValueError):
            continue
        if body.place == len(body.tokens) and body.is_left:
            names = sorted(body.loops | flags)
            declared = "".join(f"Boolean {name} = false; " for name in names)
            changes += [(begins.start(), begins.start(), f"protected {declared}"), *new]
    parts, at = [], 0
    for start, end, replacement in sorted(changes, key=lambda change: change[0]):
        parts += [text[at:start], replacement]
        at = end
    return "".join([*parts, text[at:]])


_Change = tuple[int, int, str]
"""Start and end of a piece of text, and what stands there instead."""
_Flags = frozenset[str]
"""Names that say that the function, or a loop, was left."""


def _if_none(flags: _Flags) -> str:
    return f"if {' and '.join(f'not {flag}' for flag in sorted(flags))} then "


class _Body:
    """The statements of a function's algorithm: text from *start* to *end*. Raises ValueError where it is not one.

    *loops* are the flags of loops, and *is_left* says whether one is left, or replaced.
    """

    def __init__(self, text: str, start: int, end: int, whiles: bool) -> None:
        self.text, self.start, self.end, self._whiles = text, start, end, whiles
        self.tokens = list(_TOKEN.finditer(text, start, end))
        self.place = 0
        self.loops: set[str] = set()
        self.is_left = False

    def block(self, flags: _Flags, loop: str) -> tuple[list[_Change], _Flags]:
        """Changes so that the statements up to a word that ends them are carried out while none of *flags* is true; and
        the flags that they may set. *loop* is that of the loop around them.

        A loop has its condition in its statements: the front-end takes no loop in a condition.
        """
        changes: list[_Change] = []
        found: _Flags = frozenset()
        while self.place < len(self.tokens) and not self._word().startswith(("end ", "else")):
            start, own = self._begin(), flags | found
            word = self._word() if self.tokens[self.place].start() == start else ""
            is_loop = word in ("for", "while")
            new, new_flags = self._loop(word, own) if is_loop else self._statement(word, loop)
            end = self._after()
            is_guarded = bool(own) and not is_loop
            changes += [(start, start, _if_none(own)), *new, (end, end, " end if;")] if is_guarded else new
            found |= new_flags
        return changes, found

    def _loop(self, word: str, own: _Flags) -> tuple[list[_Change], _Flags]:
        begun = self.place
        self._until("loop")
        opened = self.place
        name = f"dse_{'done' if self._whiles else 'left'}_{begun}"
        _, inside = self.block(frozenset(), name)
        while_, loop, ended = (self.tokens[place].span() for place in (begun, opened - 1, self.place))
        is_replaced = word == "while" and (self._whiles or bool(inside))
        around = own | inside | ({name} if is_replaced else set())
        self.place = opened
        changes, _ = self.block(around, name)
        self._take(f"end {word}")
        self._take(";")
        if is_replaced:
            turns = f"for {name}_turn in 1:{_MOST_TURNS + 1} loop {_if_none(around)}{name} := not ("
            left = f' assert({" or ".join(sorted(around))}, "a loop of more than {_MOST_TURNS} turns");'
            end = self._after()
            changes = [(*while_, turns), (*loop, "); end if;"), *changes, (*ended, "end for"), (end, end, left)]
        self.is_left |= bool(inside) or is_replaced
        if name in inside or is_replaced:
            self.loops.add(name)
            changes.insert(0, (while_[0], while_[0], f"{name} := false; "))
        return changes, inside - {name}

    def _statement(self, word: str, loop: str) -> tuple[list[_Change], _Flags]:
        changes: list[_Change] = []
        flags: _Flags = frozenset()
        if word in ("return", "break"):
            start = self.tokens[self.place].start()
            self.place += 1
            self._take(";")
            flags = frozenset({_RETURNED if word == "return" else loop})
            changes.append((start, self._after(), f"{next(iter(flags))} := true;"))
        elif word == "if":
            self._until("then")
            while True:
                new, new_flags = self.block(frozenset(), loop)
                changes += new
                flags |= new_flags
                if self._word() == "elseif":
                    self._until("then")
                elif self._word() == "else":
                    self.place += 1
                else:
                    break
            self._take("end if")
            self._take(";")
        elif word:
            raise ValueError(word)
        else:
            self._until(";")
        return changes, flags

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
