"""Which classes of the sources a model may use: by name, so that rather too many are found than one too few."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from dse.modelica.frontend.source_text import CLASS_KINDS, code
from dse.modelica.frontend.sources import SourceText

_NAME = r"(?:[A-Za-z_]\w*|'(?:[^'\\]|\\.)*')"
_WORD = re.compile(_NAME)
_WITHIN = re.compile(rf"\bwithin\b\s*({_NAME}(?:\s*\.\s*{_NAME})*)?\s*;")
_CLASS = re.compile(
    rf"\bend\s+(?P<end>{_NAME})"
    rf"|\b(?P<kind>{CLASS_KINDS}|operator)\s+"
    rf"(?!record\b|function\b)(?:extends\s+)?(?P<name>{_NAME})\s*(?P<next>[=(.]?)"
)
_KEPT = re.compile(r"[^\n]")


@dataclass(slots=True)
class _Class:
    """A class from *start* to *end* of text number *source*, without its name from *body* to *finish*.

    *name* is the full one; *inside*: the classes declared in it.
    """

    name: str
    kind: str
    source: int
    start: int
    body: int
    around: int
    finish: int = -1
    end: int = -1
    inside: list[int] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Used:
    """The sources with blanks in place of all that a model does not use, comments and strings.

    *packages* are the same, but of packages (and what is only called a class), without the classes in them.
    """

    texts: tuple[SourceText, ...]
    packages: tuple[SourceText, ...]


def used(sources: Iterable[SourceText], model: str) -> Used:
    """What *model* may use of *sources*: lines and columns stay as they are.

    A class counts as used if its name occurs in the text of one that is used, and so is the class around it: there is
    no other way to it. All that is declared in a class is used with it unless it is a package, and so is what the
    classes around it declare themselves. What cannot be read is kept whole; so is everything if *model* is not found.
    """
    found = _Classes([SourceText(source.path, code(source.text)) for source in sources])
    reached = found.reached(model)
    packages = {number for number in reached if found.classes[number].kind in ("package", "class")}
    return Used(tuple(found.kept(reached)), tuple(found.kept(packages)))


class _Classes:
    """All classes of *texts*. The first of each text stands for the text itself, and all that is in no class."""

    def __init__(self, texts: list[SourceText]) -> None:
        self.texts = texts
        self.classes: list[_Class] = []
        self.named: dict[str, list[int]] = {}
        self.unread: list[int] = []
        for number in range(len(texts)):
            self._read(number)

    def _read(self, source: int) -> None:
        text = self.texts[source].text
        within = _WITHIN.search(text)
        top = self._add(_Class(re.sub(r"\s", "", within[1] or "") if within else "", "", source, 0, 0, -1))
        open_ = [top]
        for match in _CLASS.finditer(text):
            own = self.classes[open_[-1]]
            if match["end"] is not None:
                if len(open_) > 1 and own.name.rpartition(".")[2] == match["end"]:
                    own.finish, own.end = match.span()
                    open_.pop()
            elif not match["next"]:
                name = f"{own.name}.{match['name']}".lstrip(".")
                open_.append(self._add(_Class(name, match["kind"], source, match.start(), match.end(), open_[-1])))
        if len(open_) > 1:  # it ends where no end is seen: nothing is known of it but the text
            del self.classes[top + 1 :]
            self.classes[top].inside.clear()
            self.unread.append(top)
        for number in range(top + 1, len(self.classes)):
            self.named.setdefault(self._last(number), []).append(number)
        self.classes[top].finish = self.classes[top].end = len(text)

    def _add(self, new: _Class) -> int:
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

    def _around(self, own: _Class, whole: dict[str, list[int]]) -> list[int]:
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
        found: set[str] = set()
        for start, end in self._own(number, own.body, own.finish):
            found.update(_WORD.findall(text, start, end))
        return found

    def _own(self, number: int, start: int, end: int) -> Iterator[tuple[int, int]]:
        """Pieces from *start* to *end* of the text of a class that belong to no class in it."""
        for inner in self.classes[number].inside:
            yield start, self.classes[inner].start
            start = self.classes[inner].end
        yield start, end

    def kept(self, numbers: set[int]) -> list[SourceText]:
        """The texts with blanks where classes stand that are not among *numbers*."""
        pieces: dict[int, list[tuple[int, int]]] = {}
        for number in sorted(numbers):
            own = self.classes[number]
            pieces.setdefault(own.source, []).extend(self._own(number, own.start, own.end))
        return [
            SourceText(source.path, _blanked(source.text, pieces.get(k, []))) for k, source in enumerate(self.texts)
        ]


def _blanked(text: str, pieces: list[tuple[int, int]]) -> str:
    if not pieces:
        return ""
    parts, last = [], 0
    for start, end in sorted(pieces):
        parts += [_KEPT.sub(" ", text[last:start]), text[start:end]]
        last = end
    return "".join([*parts, _KEPT.sub(" ", text[last:])])
