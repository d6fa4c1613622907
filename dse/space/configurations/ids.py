"""The id of a configuration: ten letters and digits that depend on what is chosen where, and on nothing else.

It is the start of the SHA-256 of the choices as text, sorted by path. So it survives another order of the file,
new alternatives, new optional parts that are left out, and any change of constraints, properties or connections. It
changes with the path of a decision, with the name of what is chosen, and with a new decision that must be made.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dse.space.configurations.lookup import Lookup
from dse.space.decisions import Choices
from dse.space.flat import Rows, Variable

LENGTH = 10
"""Characters of an id; 50 bits."""

_ALPHABET = np.frombuffer(b"abcdefghijklmnopqrstuvwxyz234567", np.uint8)
"""That of base32 (RFC 4648), in lower case."""

_READ = 8
_BITS = 5


def identify(choices: Choices) -> str:
    """The id of the configuration with these choices."""
    text = "\n".join(f"{path}={choice}" for path, choice in sorted(choices.items()))
    return _spelled([hashlib.sha256(text.encode("utf-8")).digest()])[0]


@dataclass(frozen=True, slots=True)
class IdentifiedChoices:
    """What is chosen in one configuration."""

    choices: Choices

    @property
    def id(self) -> str:
        """The configuration's id."""
        return identify(self.choices)


class Identifier:
    """Ids of rows over *variables*, a block at a time; the same as `identify` gives for their choices."""

    def __init__(self, variables: Sequence[Variable]) -> None:
        order = sorted(range(len(variables)), key=lambda number: variables[number].path)
        self._fragments = Lookup([(number, _fragments(variables[number])) for number in order])

    def ids(self, rows: Rows) -> list[str]:
        """The id of each row of a block, shape (rows, variables)."""
        join, sha256 = b"".join, hashlib.sha256
        # Every fragment starts a line, so the text starts with a line break too much.
        return _spelled([sha256(join(fragments)[1:]).digest() for fragments in self._fragments.of(rows)])


def _fragments(variable: Variable) -> list[bytes]:
    named = [b"" if name is None else f"\n{variable.path}={name}".encode() for name in variable.values]
    return [*named, b""]


def _spelled(digests: Sequence[bytes]) -> list[str]:
    numbers = np.frombuffer(b"".join(digest[:_READ] for digest in digests), ">u8").astype(np.uint64)
    shifts = np.uint64(8 * _READ) - np.uint64(_BITS) * np.arange(1, LENGTH + 1, dtype=np.uint64)
    letters = _ALPHABET[(numbers[:, None] >> shifts) & np.uint64(2**_BITS - 1)]
    text = letters.tobytes().decode("ascii")
    return [text[start : start + LENGTH] for start in range(0, len(text), LENGTH)]
