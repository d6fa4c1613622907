"""The noun of components that are classes in Python."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from dse.domain.component import Source


@dataclass(frozen=True, slots=True)
class PythonSource(Source):
    """The class called *name* in the first of *files*; with *step* it is sampled, every *step* seconds."""

    kind = "python"
    label = "Python"

    files: tuple[Path, ...]
    name: str
    step: float | None = None

    @property
    def sample_time(self) -> float | None:
        """The *step*."""
        return self.step


def class_name(component: str) -> str:
    """What the class of *component* is called unless its source says it: ``my_acc`` is ``MyAcc``."""
    return "".join(word.capitalize() for word in component.split("_"))
