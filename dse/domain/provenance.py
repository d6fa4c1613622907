"""What is kept with a study besides its results: its files as they were run, and what its design space holds."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SourceText:
    """A file that a study is made of: a *kind* (``study``, ``test bench``, ``design space``), its name and its *text*.

    *digest* is the SHA-256 of the text.
    """

    kind: str
    file: str
    text: str
    digest: str

    @property
    def is_sound(self) -> bool:
        """Whether the text is the one that the digest was made of."""
        return self.digest == digest_of(self.text)


@dataclass(frozen=True, slots=True)
class Left:
    """What a static *constraint* and those before it leave of a design space: about *count*, as *text* has it."""

    constraint: str
    because: str
    rule: str
    count: float
    text: str


@dataclass(frozen=True, slots=True)
class Absent:
    """A *choice* at *place* that no valid configuration has; the *constraints* that stand in its way, by name."""

    place: str
    choice: str
    constraints: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Funnel:
    """How a *design* space of *count* combinations, *text*, is narrowed by its constraints in their order."""

    design: str
    count: float
    text: str
    steps: tuple[Left, ...]
    absent: tuple[Absent, ...]


@dataclass(frozen=True, slots=True)
class Provenance:
    """All of it, as of the last time the study was explored; *unfunnelled* says why there is no funnel.

    *assumed* are the parameters that components mark as assumed, as ``component.parameter``; None if that was not kept.
    """

    sources: tuple[SourceText, ...] = ()
    funnel: Funnel | None = None
    unfunnelled: str = ""
    assumed: tuple[str, ...] | None = None


def digest_of(text: str) -> str:
    """SHA-256 of *text*, in UTF-8."""
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
