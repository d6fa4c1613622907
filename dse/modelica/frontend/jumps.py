"""Functions that leave a loop by `return` or `break`, written without: with Booleans that say that it was left.

The front-end refuses such jumps. What follows one is put into ``if not left then … end if``, in its loop and behind it,
which is the same because a function has no other effects than its values. Lines stay where they are.

A loop by `while` whose number of turns the front-end does not find is one by `for` that is left where the condition is
false, and an assertion that it was left.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from dse.modelica.frontend.source_text import Change, changed, edited
from dse.modelica.frontend.syntax import KINDS, UNREADABLE, Tree, read_tree

_RETURNED = "dse_returned"
_MOST_TURNS = 100
OPEN_LOOP = "a loop by while"
"""What the front-end's refusal of a loop by `while` says."""


def without_jumps(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """*files* with such functions rewritten; what cannot be read stays as it is."""
    return changed(files, partial(_changed, False))


def without_open_loops(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """*files* with all loops by `while` in functions rewritten."""
    return changed(files, partial(_changed, True))


def _changed(whiles: bool, text: str) -> str:
    wanted = {"while"} if whiles else {"return", "break"}
    tree = read_tree(text) if any(word in text for word in wanted) else None
    if tree is None:
        return text
    changes: list[Change] = []
    for own in tree.elements:
        words = tree.words[own.start : own.end] if own.kind == "function" else []
        if "algorithm" not in words or wanted.isdisjoint(words) or any(each.kind in KINDS for each in own.elements):
            continue
        begins = own.start + words.index("algorithm")
        body = _Body(tree, begins + 1, whiles)
        try:
            new, flags = body.block(frozenset(), "")
        except UNREADABLE:
            continue
        if body.is_left:
            declared = "".join(f"Boolean {name} = false; " for name in sorted(body.loops | flags))
            changes += [(tree.starts[begins], tree.starts[begins], f"protected {declared}"), *new]
    return edited(text, changes)


_Flags = frozenset[str]
"""Names that say that the function, or a loop, was left."""


def _if_none(flags: _Flags) -> str:
    return f"if {' and '.join(f'not {flag}' for flag in sorted(flags))} then "


class _Body:
    """The statements of a function from a word of *tree* on. What is not one raises one of UNREADABLE.

    *loops* are the flags of loops, and *is_left* says whether one is left, or replaced.
    """

    def __init__(self, tree: Tree, at: int, whiles: bool) -> None:
        self._tree, self._at, self._whiles = tree, at, whiles
        self.loops: set[str] = set()
        self.is_left = False

    def block(self, flags: _Flags, loop: str) -> tuple[list[Change], _Flags]:
        """Changes so that the statements up to a word that ends them are carried out while none of *flags* is true; and
        the flags that they may set. *loop* is that of the loop around them.

        A loop has its condition in its statements: the front-end takes no loop in a condition.
        """
        changes: list[Change] = []
        found: _Flags = frozenset()
        while (word := self._tree.words[self._at]) not in ("end", "else", "elseif", "annotation"):
            start, own, is_loop = self._tree.starts[self._at], flags | found, word in ("for", "while")
            new, new_flags = self._loop(own) if is_loop else self._statement(loop)
            end = self._after()
            is_guarded = bool(own) and not is_loop
            changes += [(start, start, _if_none(own)), *new, (end, end, " end if;")] if is_guarded else new
            found |= new_flags
        return changes, found

    def _loop(self, own: _Flags) -> tuple[list[Change], _Flags]:
        begun, word = self._at, self._tree.words[self._at]
        self._until("loop")
        opened = self._at
        name = f"dse_{'done' if self._whiles else 'left'}_{begun}"
        _, inside = self.block(frozenset(), name)
        ended = self._at
        is_replaced = word == "while" and (self._whiles or bool(inside))
        around = own | inside | ({name} if is_replaced else set())
        self._at = opened
        changes, _ = self.block(around, name)
        self._take("end", word, ";")
        start, loop, end, after = (*(self._tree.starts[at] for at in (begun, opened - 1, ended + 1)), self._after())
        if is_replaced:
            turns = f"for {name}_turn in 1:{_MOST_TURNS + 1} loop {_if_none(around)}{name} := not ("
            left = f' assert({" or ".join(sorted(around))}, "a loop of more than {_MOST_TURNS} turns");'
            changes = [(start, start + 5, turns), (loop, loop + 4, "); end if;"), *changes, (end, end + 5, "for")]
            changes.append((after, after, left))
        self.is_left |= bool(inside) or is_replaced
        if name in inside or is_replaced:
            self.loops.add(name)
            changes.insert(0, (start, start, f"{name} := false; "))
        return changes, inside - {name}

    def _statement(self, loop: str) -> tuple[list[Change], _Flags]:
        start, word = self._tree.starts[self._at], self._tree.words[self._at]
        changes: list[Change] = []
        flags: _Flags = frozenset()
        if word in ("return", "break"):
            self._take(word, ";")
            flags = frozenset({_RETURNED if word == "return" else loop})
            changes.append((start, self._after(), f"{next(iter(flags))} := true;"))
        elif word == "if":
            while self._tree.words[self._at] != "end":
                if self._tree.words[self._at] == "else":
                    self._at += 1
                else:
                    self._until("then")
                new, new_flags = self.block(frozenset(), loop)
                changes += new
                flags |= new_flags
            self._take("end", "if", ";")
        elif word == "when":
            raise ValueError(word)
        else:
            self._at = self._tree.until(self._at, ";")
            self._take(";")
        return changes, flags

    def _take(self, *words: str) -> None:
        if tuple(self._tree.words[self._at : self._at + len(words)]) != words:
            raise ValueError(words)
        self._at += len(words)

    def _until(self, word: str) -> None:
        """Go behind *word*, which ends a condition or a range, but for one of an expression with `if`."""
        inner = 0
        self._at += 1
        while True:
            self._at = self._tree.until(self._at, word, "if", "elseif", "then") + 1
            found = self._tree.words[self._at - 1]
            if found == word and not (inner and word == "then"):
                return
            inner += {"if": 1, "elseif": 1, "then": -1}[found]

    def _after(self) -> int:
        return self._tree.starts[self._at - 1] + 1
