"""Modelica text as a tree of classes, declarations and modifications. All else in it stays words.

The front-end has a tree of its own but does not give it away; what it takes for something else is looked for in this
one.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from dse.errors import Location, fail
from dse.modelica.frontend.source_text import CLASS_KINDS, SourceText, code, place

_TOKEN = re.compile(r"'(?:\\.|[^'\\])*'|[A-Za-z_]\w*|\d+(?:\.\d*)?(?:[eE][+-]?\d+)?|[:<>=]=|<>|\S")
KINDS = frozenset((*CLASS_KINDS.split("|"), "operator"))
_PREFIXES = {"redeclare", "final", "inner", "outer", "replaceable", "each", "flow", "stream", "discrete", "parameter"}
_PREFIXES |= {"constant", "input", "output", "partial", "encapsulated", "expandable", "pure", "impure"}
_SECTIONS = ("equation", "algorithm", "initial", "external", "annotation")
_OPENING, _CLOSING = ("(", "[", "{"), (")", "]", "}")
_BRACKETS = frozenset((*_OPENING, *_CLOSING))
UNREADABLE = (ValueError, LookupError, RecursionError)
"""What a text that is not Modelica raises."""
_CONTROLS = ("if", "for", "when", "while")


@dataclass(slots=True, eq=False)
class Element:
    """A declaration or a modification: words number *start* up to *end* of *tree*, its name at *named*.

    *kind*: "component", "extends", "import", "modifier", or the kind of a class. *type*: the full name of a component's
    type, of the class that is extended, or of the one that a short class is made from. *arguments* modify it, and are
    *written* so, without blanks; *constraint* is what follows `constrainedby`, and *elements* are a class's own.
    """

    tree: Tree
    kind: str
    prefixes: frozenset[str]
    start: int
    parent: Element | None
    is_argument: bool
    """Whether it is in the list of modifications of its parent."""
    name: str = ""
    type: str = ""
    named: int = 0
    end: int = 0
    arguments: list[Element] = field(default_factory=list)
    written: str = ""
    is_given: bool = False
    """Whether it has a value: `= …`."""
    constraint: Element | None = None
    elements: list[Element] = field(default_factory=list)

    @property
    def last(self) -> str:
        """The last word of the type's name."""
        return self.type.rpartition(".")[2]

    @property
    def full(self) -> str:
        """Its name with those of the classes around it."""
        return f"{self.parent.full if self.parent else self.tree.within}.{self.name}".lstrip(".")

    @property
    def where(self) -> Location:
        """The place of its name."""
        return self.tree.place(self.named)


class Tree:
    """The classes of one text that has neither comments nor strings. Raises one of UNREADABLE."""

    def __init__(self, source: SourceText) -> None:
        found = list(_TOKEN.finditer(source.text))
        self.source, self.words = source, [*(match[0] for match in found), "", ""]
        self.starts = [*(match.start() for match in found), len(source.text), len(source.text)]
        self.closing: dict[int, int] = {}
        """The closing bracket of each opening one, and the other way round."""
        self.sizes: list[int] = []
        """The brackets of the sizes of arrays in declarations."""
        opened: list[int] = []
        for number, word in enumerate(self.words):
            if word not in _BRACKETS:
                continue
            if word in _OPENING:
                opened.append(number)
            else:
                start = opened.pop()
                self.closing[start], self.closing[number] = number, start
        self._at = 0
        self.elements: list[Element] = []
        """All elements, each behind the one it is in."""
        self._open: list[Element] = []
        self.within = ""
        if self._word == "within":
            self._at += 1
            self.within = self._path() if self._word != ";" else ""
        self._body()
        if self._word or opened:
            raise ValueError(f"'{self._word}' is not expected")

    def place(self, word: int) -> Location:
        """Line and column of a word."""
        return place(self.source, self.starts[word])

    def until(self, start: int, *ends: str) -> int:
        """The number of the next word from *start* on that is one of *ends*, or closes a bracket from before."""
        while self.words[start] not in ("", *ends, *_CLOSING):
            start = self.closing[start] + 1 if self.words[start] in _OPENING else start + 1
        return start

    def parts(self, bracket: int) -> Iterator[list[str]]:
        """The words between the commas in a bracket."""
        end = bracket
        while end < self.closing[bracket]:
            start, end = end + 1, self.until(end + 1, ",")
            yield self.words[start:end]

    @property
    def _ahead(self) -> str:
        return self.words[self._at + 1]

    @property
    def _word(self) -> str:
        return self.words[self._at]

    def _next(self) -> str:
        self._at += 1
        return self.words[self._at - 1]

    def _path(self) -> str:
        parts = [self._next()] if self._word == "." else []
        parts.append(self._name())
        while self._word == ".":
            parts += [self._next(), self._name()]
        return "".join(parts)

    def _name(self) -> str:
        if not (self._word[:1].isalpha() or self._word[:1] in ("_", "'")):
            raise ValueError(f"a name is expected, not '{self._word}'")
        return self._next()

    def _size(self) -> None:
        if self._word == "[":
            self.sizes.append(self._at)
            self._at = self.closing[self._at] + 1

    def _skip(self, *ends: str) -> None:
        self._at = self.until(self._at, *ends)

    def _new(self, kind: str, start: int, *, is_argument: bool = False) -> Element:
        """A new element from word *start* on, whose name comes next; it is in the one that is open."""
        parent = self._open[-1] if self._open else None
        own = Element(self, kind, frozenset(self.words[start : self._at]), start, parent, is_argument, named=self._at)
        if parent and kind != "constrainedby":
            (parent.arguments if is_argument else parent.elements).append(own)
        self.elements.append(own)
        return own

    def _body(self) -> None:
        """The elements up to the word `end` that closes a class, which is not taken."""
        while self._word and self._word != "end":
            if self._word in ("public", "protected", ";"):
                self._at += 1
            elif self._word in _SECTIONS:
                self._section()
            else:
                self._element()

    def _section(self) -> None:
        if self._word in ("external", "annotation"):
            self._skip(";")
            return
        while self._word:
            before = self._next()
            is_statement = before in (";", "equation", "algorithm")
            is_end = self._word == "end" and self._ahead not in _CONTROLS
            if is_statement and (is_end or self._word in ("public", "protected")):
                return

    def _element(self, *, is_argument: bool = False) -> None:
        start = self._at
        while self._word in _PREFIXES or (self._word == "operator" and self._ahead in ("record", "function")):
            self._at += 1
        if self._word in KINDS:
            found = [self._class(start, is_argument=is_argument)]
        elif self._word in ("import", "extends"):
            found = [self._new(self._next(), start)]
            found[0].is_given, found[0].name = self._ahead == "=", self._word
            if found[0].kind == "extends":
                self._of(found[0])
        else:
            found = self._components(start, is_argument=is_argument)
        if self._word == "constrainedby":
            limit = self._new(self._next(), self._at - 1)
            self._of(limit)
            for each in found:
                each.constraint = limit
        self._skip(*((",", ")") if is_argument else (";",)))
        if found[0].kind != "component":
            found[0].end = self._at

    def _of(self, own: Element) -> None:
        """The name of a class, and modifications of it."""
        own.type = self._path()
        self._size()
        self._modification(own)

    def _components(self, start: int, *, is_argument: bool) -> list[Element]:
        begun, kind = self._at, self._path()
        prefixes = frozenset(self.words[start:begun])
        self._size()
        found: list[Element] = []
        while not found or (self._word == "," and not is_argument):
            self._at += bool(found)
            own = self._new("component", start, is_argument=is_argument)
            own.prefixes, own.type, own.name = prefixes, kind, self._name()
            self._size()
            self._modification(own)
            own.is_given = self._word in ("=", ":=")
            self._skip(",", ";", ")", "constrainedby", "annotation")
            own.end = self._at
            found.append(own)
        return found

    def _class(self, start: int, *, is_argument: bool) -> Element:
        own = self._new(self._word, start, is_argument=is_argument)
        extends = self._ahead == "extends"
        self._at += 1 + extends
        own.named, own.name = self._at, self._name()
        if extends:
            own.type = own.name
            self._modification(own)
        if self._word != "=":
            self._open.append(own)
            self._body()
            self._open.pop()
            if (self._next(), self._next()) != ("end", own.name):
                raise ValueError(f"no end of '{own.name}'")
            return own
        self._at += 1
        while self._word in _PREFIXES:
            self._at += 1
        if self._word in ("enumeration", "der"):
            self._at = self.closing[self._at + 1] + 1
        else:
            self._of(own)
        return own

    def _modification(self, own: Element) -> None:
        """The list of modifications that follows, if one does."""
        if self._word != "(":
            return
        start, end = self._at, self.closing[self._at]
        own.written = "".join(self.words[start + 1 : end])
        self._open.append(own)
        while self._at + 1 < end:
            self._at += 1
            first = self._at
            while self._word in ("each", "final"):
                self._at += 1
            if self._word in ("redeclare", "replaceable"):
                self._element(is_argument=True)
                continue
            changed = self._new("modifier", first, is_argument=True)
            while not changed.name or self._word == ".":  # behind an index
                changed.name += self._path()
                self._size()
            self._modification(changed)
            changed.is_given = self._word in ("=", ":=")
            self._skip(",", ")")
            changed.end = self._at
        self._open.pop()
        self._at = end + 1


def read_tree(text: str) -> Tree | None:
    """The tree of *text*, but for comments and strings; None if it is not Modelica."""
    return read_code(code(text))


def read_code(text: str) -> Tree | None:
    """The tree of *text*, which has neither comments nor strings; None if it is not Modelica."""
    try:
        return Tree(SourceText("", text))
    except UNREADABLE:
        return None


class Forest:
    """The trees of *texts*. Raises DseError for one that cannot be read."""

    def __init__(self, texts: Iterable[SourceText]) -> None:
        self.trees = [_tree(text) for text in texts]
        self.elements = [element for tree in self.trees for element in tree.elements]


def _tree(text: SourceText) -> Tree:
    try:
        return Tree(text)
    except UNREADABLE as error:
        what = f"text that cannot be read: {error if isinstance(error, ValueError) else 'brackets'}"
        raise fail(what, Location(text.path, 1, 1), "write the declarations in simpler words") from error
