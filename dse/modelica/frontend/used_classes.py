"""Which classes of the sources a model may use: by name, so that rather too many are found than one too few."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from dse.modelica.frontend.source_text import CLASS_KINDS, SourceText, code

_NAME = r"(?:[A-Za-z_]\w*|'(?:[^'\\]|\\.)*')"
_WORD = re.compile(_NAME)
_WITHIN = re.compile(rf"\bwithin\b\s*({_NAME}(?:\s*\.\s*{_NAME})*)?\s*;")
_BEFORE = "expandable|encapsulated|partial|final|replaceable|redeclare|inner|outer|pure|impure|operator"
_CLASS = re.compile(
    rf"\bend\s+(?P<end>{_NAME})"
    rf"|\b(?:(?:{_BEFORE})\s+)*(?P<kind>{CLASS_KINDS}|operator)\s+"
    rf"(?!record\b|function\b)(?:extends\s+)?(?P<name>{_NAME})\s*(?P<next>[=(.]?)"
)


@dataclass(slots=True)
class Class:
    """A class from *start* to *end* of text number *source*, with its prefixes and the semicolon.

    Without its name, it is from *body* to *finish*, and what may follow the name once more is from *tail* to *end*.

    *name* is the full one; *inside*: the classes declared in it.
    """

    name: str
    kind: str
    source: int
    start: int
    body: int
    around: int
    finish: int = -1
    tail: int = -1
    end: int = -1
    inside: list[int] = field(default_factory=list)


def used(sources: Iterable[SourceText], model: str) -> list[SourceText]:
    """As `reached`, without comments and strings."""
    return reached([replace(source, text=code(source.text)) for source in sources], model)


def reached(sources: Sequence[SourceText], model: str) -> list[SourceText]:
    """*sources* with blanks in place of the classes that *model* does not use; texts without any others are left out.

    A class counts as used if its name occurs in the text of one that is used, and so is the class around it: there is
    no other way to it. All that is declared in a class is used with it unless it is a package, and so is what the
    classes around it declare themselves. What cannot be read is kept whole; so is everything if *model* is not found.
    """
    found = Classes([SourceText(source.path, code(source.text)) for source in sources])
    kept = zip(sources, found.pieces(found.reached(model)), strict=True)
    return [SourceText(source.path, _blanked(source.text, pieces)) for source, pieces in kept if pieces]


class Classes:
    """All classes of *texts*. The first of each text stands for the text itself, and all that is in no class."""

    def __init__(self, texts: list[SourceText]) -> None:
        self.texts = texts
        self.classes: list[Class] = []
        self.named: dict[str, list[int]] = {}
        self.unread: list[int] = []
        for number in range(len(texts)):
            self._read(number)

    def _read(self, source: int) -> None:
        text = self.texts[source].text
        within = _WITHIN.search(text)
        top = self._add(Class(re.sub(r"\s", "", within[1] or "") if within else "", "", source, 0, 0, -1))
        open_ = [top]
        for match in _CLASS.finditer(text):
            own = self.classes[open_[-1]]
            if match["end"] is not None:
                if len(open_) > 1 and own.name.rpartition(".")[2] == match["end"]:
                    own.finish, own.tail = match.span()
                    own.end = text.find(";", own.tail) + 1 or len(text)
                    open_.pop()
            elif not match["next"]:
                name = f"{own.name}.{match['name']}".lstrip(".")
                open_.append(self._add(Class(name, match["kind"], source, match.start(), match.end(), open_[-1])))
            elif len(open_) == 1:  # a short class that is a file of its own, like a type
                name = f"{own.name}.{match['name']}".lstrip(".")
                ends = text.find(";", match.end()) + 1 or len(text)
                new = Class(name, match["kind"], source, match.start(), match.end(), top, ends, ends, ends)
                self._add(new)
        if len(open_) > 1:  # it ends where no end is seen: nothing is known of it but the text
            del self.classes[top + 1 :]
            self.classes[top].inside.clear()
            self.unread.append(top)
        for number in range(top + 1, len(self.classes)):
            self.named.setdefault(self._last(number), []).append(number)
        self.classes[top].finish = self.classes[top].tail = self.classes[top].end = len(text)

    def _add(self, new: Class) -> int:
        self.classes.append(new)
        number = len(self.classes) - 1
        if new.around >= 0:
            self.classes[new.around].inside.append(number)
        return number

    def reached(self, model: str) -> set[int]:
        """The classes that *model* may use, by number; all of them if it is not among them."""
        whole: dict[str, list[int]] = {}
        for number, own in enumerate(self.classes):
            if own.kind:
                whole.setdefault(own.name, []).append(number)
        if model not in whole:
            return set(range(len(self.classes)))
        around = [self._around(own, whole) for own in self.classes]
        within: dict[int, list[int]] = {}
        for number, outer in enumerate(around):
            for each in outer:
                within.setdefault(each, []).append(number)
        pending = [*whole[model], *self.unread]
        words: set[str] = set()
        seen: set[int] = set()
        while pending:
            number = pending.pop()
            if number in seen:
                continue
            seen.add(number)
            own = self.classes[number]
            pending += [*around[number], *([own.around] if own.around >= 0 else ())]
            is_whole = own.kind not in ("", "package")
            pending += [inner for inner in within.get(number, ()) if is_whole or self._last(inner) in words]
            new = self._words(number) - words
            words |= new
            named = [found for word in new for found in self.named.get(word, ())]
            pending += [found for found in named if not around[found] or not seen.isdisjoint(around[found])]
        return seen

    def _around(self, own: Class, whole: dict[str, list[int]]) -> list[int]:
        """The classes around one, where they are known: one in the same text, or the package the text is within."""
        if own.around >= 0 and self.classes[own.around].kind:
            return [own.around]
        return whole.get(self.classes[own.around].name if own.around >= 0 else own.name, [])

    def _last(self, number: int) -> str:
        own = self.classes[number]
        return own.name.rpartition(".")[2] if own.kind else ""

    def _words(self, number: int) -> set[str]:
        """The names in a class's own text; that around a file's outermost class names the packages around the file."""
        own = self.classes[number]
        text = self.texts[own.source].text
        found = set(_WORD.findall(text, own.tail, own.end))
        for start, end in self._own(number, own.body, own.finish):
            found.update(_WORD.findall(text, start, end))
        return found

    def _own(self, number: int, start: int, end: int) -> Iterator[tuple[int, int]]:
        """Pieces from *start* to *end* of the text of a class that belong to no class in it."""
        for inner in self.classes[number].inside:
            yield start, self.classes[inner].start
            start = self.classes[inner].end
        yield start, end

    def pieces(self, numbers: set[int]) -> list[list[tuple[int, int]]]:
        """Of each text, where the pieces that belong to the classes *numbers* start and end, in order."""
        pieces: list[list[tuple[int, int]]] = [[] for _ in self.texts]
        for number in numbers:
            own = self.classes[number]
            pieces[own.source] += self._own(number, own.start, own.end)
        return [sorted(each) for each in pieces]


def _blanked(text: str, pieces: list[tuple[int, int]]) -> str:
    """*text* with nothing but line ends, and blanks before what follows in a line, around *pieces*."""
    parts, last = [], 0
    for start, end in pieces:
        parts += [_without(text, last, start), text[start:end]]
        last = end
    return "".join([*parts, _without(text, last, len(text))])


def _without(text: str, start: int, end: int) -> str:
    line = max(text.rfind("\n", start, end) + 1, start)
    return "\n" * text.count("\n", start, end) + " " * (end - line)
