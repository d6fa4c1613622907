"""A language case: one model file, and what must come out of it, computed by other means."""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

CASES = Path(__file__).parent / "cases"

Given = Mapping[str, float]
"""Values of parameters and constant inputs by name, those of the model file where nothing else is set."""
Values = Mapping[str, float | Sequence[float]]
"""Outputs by name; a sequence stands for the elements of a vector."""


@dataclass(frozen=True)
class Steps:
    """A signal that is held between jumps: *values* from each of *times* on; the first time is 0."""

    times: tuple[float, ...]
    values: tuple[float, ...]

    def after(self, time: float) -> float:
        """The value at *time*, a jump there included."""
        return self.values[bisect_right(self.times, time + 1e-9) - 1]

    def before(self, time: float) -> float:
        """The value up to *time*, a jump there not yet made."""
        return self.values[max(bisect_left(self.times, time - 1e-9) - 1, 0)]


@dataclass(frozen=True)
class Case:
    """What *model* must give at every communication point.

    *solution* takes a time and the values given; *given* are the file's own values, *variants* what is set instead.
    *inputs* and *tuned* parameters change at communication points of *step*. *events* are times at which outputs may
    jump: points as near as 1e-6 s are not compared. *error* bounds the absolute deviation for values up to 1, the
    relative one beyond, at a solver's tolerance of 1e-9; a model without states must be exact but for rounding.
    *residuals* vanish when all variables of a communication point are put into them. Without *exchanged*, FMPy's solver
    cannot run it: it neither tunes parameters nor takes back a step that the model discards.
    """

    model: str
    solution: Callable[[float, Given], Values]
    stop: float = 1.0
    step: float = 0.07
    given: Given = field(default_factory=dict)
    variants: tuple[Given, ...] = ()
    inputs: Mapping[str, Steps] = field(default_factory=dict)
    tuned: Mapping[str, Steps] = field(default_factory=dict)
    events: tuple[float, ...] = ()
    error: float = 1e-7
    residuals: Callable[[Mapping[str, float]], Sequence[float]] | None = None
    exchanged: bool = True

    @property
    def file(self) -> Path:
        """Where the model stands."""
        return CASES / f"{self.model}.mo"

    @property
    def class_name(self) -> str:
        """The class to build: the file's own, or ``Test`` in the file's package."""
        return class_in(self.file)

    def expected(self, time: float, variant: Given | None = None) -> dict[str, float]:
        """Scalar outputs by name at *time*."""
        return scalars(self.solution(time, {**self.given, **(variant or {})}))

    @property
    def moved(self) -> Mapping[str, Steps]:
        """Everything that is set between communication steps."""
        return {**self.inputs, **self.tuned}

    def is_compared(self, time: float) -> bool:
        """Whether no output may jump at *time*."""
        return all(abs(time - event) > 1e-6 for event in self.events)

    def points(self) -> list[float]:
        """All communication points."""
        return [k * self.step for k in range(round(self.stop / self.step + 0.4999))]


class Cases(list[Case]):
    """Cases in the order of their definition; used as a decorator's maker by the modules of solutions."""

    def case(self, model: str, **fields: object) -> Callable[[Callable[..., Values]], Callable[..., Values]]:
        """Take the function below as the solution of *model*."""

        def take(solution: Callable[..., Values]) -> Callable[..., Values]:
            self.append(Case(model, solution, **fields))  # type: ignore[arg-type]  # fields are named as in Case
            return solution

        return take


def class_in(file: Path) -> str:
    """The class to build in *file*."""
    first = re.search(r"^(?:partial )?(package|model)\s+(\w+)", file.read_text(encoding="utf-8"), re.MULTILINE)
    assert first, f"no class in {file.name}"
    return f"{first[2]}.Test" if first[1] == "package" else first[2]


def scalars(values: Values) -> dict[str, float]:
    """Vectors taken apart into ``name[1]``, ``name[2]``, …"""
    found: dict[str, float] = {}
    for name, value in values.items():
        if isinstance(value, Iterable):
            found |= {f"{name}[{k}]": float(element) for k, element in enumerate(value, 1)}
        else:
            found[name] = float(value)
    return found
