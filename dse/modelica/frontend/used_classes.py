"""Which classes of the sources a model may use: by name, so that rather too many are found than one too few."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

from dse.modelica.frontend.source_text import CLASS_KINDS, SourceText, code, edited
from dse.modelica.frontend.syntax import KINDS, Element, read_code

_NAME = r"[A-Za-z_]\w*|'(?:[^'\\]|\\.)*'"
_WITHIN = re.compile(r"\s*within\s+([\w.]*)\s*;")
_DECLARED = re.compile(rf"\b(?:{CLASS_KINDS}|operator)\s+(?!record\b|function\b)(?:extends\s+)?({_NAME})")


def used(sources: Iterable[SourceText], model: str) -> list[SourceText]:
    """As `reached`, without comments and strings."""
    return list(_used(tuple(sources), model))


@lru_cache(maxsize=1)  # several passes ask for the same
def _used(sources: Sequence[SourceText], model: str) -> Sequence[SourceText]:
    texts = [code(source.text) for source in sources]
    return _reached([replace(source, text=text) for source, text in zip(sources, texts, strict=True)], texts, model)


def reached(sources: Sequence[SourceText], model: str) -> list[SourceText]:
    """*sources* with blanks in place of the classes that *model* does not use; texts without any others are left out.

    A class counts as used if its name occurs in the text of one that is used, and so is the class around it: there is
    no other way to it. All that is declared in a class is used with it unless it is a package, and so is what the
    classes around it declare themselves. What cannot be read is kept whole; so is everything if *model* is not found.
    """
    return _reached(sources, [code(source.text) for source in sources], model)


def _reached(sources: Sequence[SourceText], texts: Sequence[str], model: str) -> list[SourceText]:
    found = _Classes(texts)
    seen = found.reached(model)
    if not seen:
        return list(sources)
    kept = (replace(source, text=found.kept(number, source.text, seen)) for number, source in enumerate(sources))
    return [source for source in kept if source.text]


def _is_class(own: Element) -> bool:
    """Whether it is a class that others may name; a short one, ``type T = Real``, only if it is in no other."""
    is_short = own.parent is not None and own.tree.words[own.named + 1] == "="
    return own.kind in KINDS and not own.is_argument and not is_short


class _Classes:
    """The classes of *texts*. A text is read once a name is looked for that it may declare, and the package that it is
    within is used: most texts of a library are not read."""

    def __init__(self, texts: Sequence[str]) -> None:
        self._texts = texts
        self._declaring: dict[str, list[int]] = {}
        for number, text in enumerate(texts):
            for name in dict.fromkeys(_DECLARED.findall(text)):
                self._declaring.setdefault(name, []).append(number)
        self._names = frozenset(self._declaring)
        self._used_packages = {""}
        self._waiting: dict[str, list[int]] = {}
        self._read: dict[int, list[Element] | None] = {}
        self._named: dict[str, list[Element]] = {}
        self._whole: dict[str, list[Element]] = {}
        self._inside: dict[str, list[Element]] = {}

    def reached(self, model: str) -> set[Element]:
        """The classes that *model* may use; none if it is not among them."""
        words: set[str] = set()
        path = model.split(".")
        self._used_packages |= {".".join(path[:end]) for end in range(len(path))}
        new = [*self._look_for(model.rpartition(".")[2])]
        pending = list(self._whole.get(model, ()))
        seen: set[Element] = set()
        while pending:
            own = pending.pop()
            if own in seen:
                continue
            seen.add(own)
            pending += self._around(own)
            self._used_packages.add(own.full)
            for number in self._waiting.pop(own.full, ()):
                new += self._read_text(number)
            pending += [one for one in self._inside.get(own.full, ()) if own.kind != "package" or one.name in words]
            new += _words(own)
            while new:
                word = new.pop()
                if word not in words:
                    words.add(word)
                    new += self._look_for(word)
                    for one in self._named.get(word, ()):
                        around = self._around(one)
                        pending += [one] if not around or not seen.isdisjoint(around) else []
        return seen

    def _look_for(self, name: str) -> Iterator[str]:
        """Read what may declare *name*, and the packages around. The words of a text that cannot be read."""
        for number in self._declaring.pop(name, ()):
            within = _WITHIN.match(self._texts[number])
            package = within[1] if within else ""
            if package in self._used_packages or package.rpartition(".")[2] not in self._names:
                yield from self._read_text(number)
            else:
                self._waiting.setdefault(package, []).append(number)

    def _read_text(self, number: int) -> Iterator[str]:
        if number in self._read:
            return
        tree = read_code(self._texts[number])
        if tree is None:
            self._read[number] = None
            yield from re.findall(_NAME, self._texts[number])
            return
        self._read[number] = found = [own for own in tree.elements if _is_class(own)]
        for own in found:
            self._named.setdefault(own.name, []).append(own)
            self._whole.setdefault(own.full, []).append(own)
            self._inside.setdefault(own.full.rpartition(".")[0], []).append(own)
        yield from self._look_for(tree.within.rpartition(".")[2])

    def _around(self, own: Element) -> list[Element]:
        return self._whole.get(own.full.rpartition(".")[0], [])

    def kept(self, number: int, text: str, seen: set[Element]) -> str:
        """What is left of *text*, which is the text of that number, when only the classes *seen* are; or nothing."""
        found = self._read.get(number, [])
        if found is None:
            return text
        if seen.isdisjoint(found):
            return ""
        starts = found[0].tree.starts
        unused = [own for own in found if own not in seen and (own.parent is None or own.parent in seen)]
        pieces = [(starts[own.start], starts[own.end] + 1) for own in unused]
        return edited(text, [(start, end, _blank(text[start:end])) for start, end in pieces])


def _words(own: Element) -> Iterator[str]:
    """The words in a class's own text but its name."""
    words, at = own.tree.words, own.named + 1
    inner = {one.start: one.end for one in own.elements if _is_class(one)}
    while at < own.end:
        at = inner.get(at, at)
        if words[at - 1] != "end":
            yield words[at]
        at += 1


def _blank(text: str) -> str:
    """Nothing but the line ends of *text*, and blanks before what follows in the last line."""
    return "\n" * text.count("\n") + " " * (len(text) - text.rfind("\n") - 1)
