"""Names for a design space from those of a feature model, which may be any text."""

from __future__ import annotations

import re
from collections.abc import Iterable

from dse.expression import KEYWORDS

_ODD = re.compile(r"[^A-Za-z0-9_]")
_NOT_NAMES = KEYWORDS | {"present", "absent"}


class Names:
    """Hands out names that can stand in dotted paths and expressions, each once; the same in every run."""

    def __init__(self, given: Iterable[str]) -> None:
        """Those of *given* that can be names stay as they are; the others are spelled with ``_``.

        None starts with ``_``: the files called so are only for including.
        """
        words = list(dict.fromkeys(given))
        self._taken = {word for word in words if word == _spelled(word)}
        self._names = {word: word for word in self._taken}
        for word in words:
            if word not in self._names:
                self._names[word] = self.new(word)

    def of(self, word: str) -> str:
        """The name of one of the words given at the start."""
        return self._names[word]

    def new(self, word: str) -> str:
        """A name like *word* that nothing has yet."""
        wanted = name = _spelled(word)
        number = 2
        while name in self._taken:
            name = f"{wanted}_{number}"
            number += 1
        self._taken.add(name)
        return name


def is_spelled(word: str, name: str) -> bool:
    """Whether *name* can be that of a feature called *word*."""
    wanted = _spelled(word)
    return name == wanted or (name.startswith(f"{wanted}_") and name[len(wanted) + 1 :].isdigit())


def _spelled(word: str) -> str:
    name = _ODD.sub("_", word)
    if not name[:1].isalpha():
        name = f"x{name}"
    return f"{name}_" if name in _NOT_NAMES else name
