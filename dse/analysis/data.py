"""The runs of a study as what is compared: where they lie, what came of them, and what each one counts."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import StudyDefinition
from dse.domain.sampler import DesignVariable, Role
from dse.errors import DseError, closest, fail

Floats = NDArray[np.float64]
Rows = NDArray[np.bool_]
Codes = NDArray[np.uint8]

ALL = "all requirements"
"""What the verdict on all requirements together is called."""

MET = VERDICTS.index(Verdict.PASS)
NOT_APPLICABLE = VERDICTS.index(Verdict.NOT_APPLICABLE)


@dataclass(frozen=True, slots=True)
class Factor:
    """Something in which runs differ: a number, *variable*, or one of *levels*, which have no order.

    These are choices, or with *given* a condition that names what every design has to do with.

    Its place is 0 … 1 in either case: where in the variable's range, values or distribution it is, as
    `dse.exploration.scaled` has it, or the middle of the level's part.
    """

    name: str
    unit: str = ""
    variable: DesignVariable | None = None
    levels: tuple[str, ...] = ()
    given: bool = False

    @property
    def is_choice(self) -> bool:
        """Whether it is one of levels."""
        return self.variable is None

    @property
    def is_decided(self) -> bool:
        """Whether it is for the designer to say, and neither a condition nor uncertain."""
        return not self.given if self.variable is None else self.variable.role is Role.DESIGN

    @property
    def is_condition(self) -> bool:
        """Whether every design has to do with it."""
        return self.given if self.variable is None else self.variable.role is Role.CONDITION

    def value(self, place: float) -> float:
        """The number (SI) at *place*; of one that has certain values only the nearest one. NaN of a choice."""
        from dse.exploration import scaled

        return float(scaled(np.array([[place]]), (self.variable,))[0, 0]) if self.variable else np.nan

    def level(self, place: float) -> str:
        """The level at *place*."""
        return self.levels[min(int(place * len(self.levels)), len(self.levels) - 1)]


@dataclass(frozen=True, slots=True, eq=False)
class StudyData:
    """n runs that are compared with each other, and the k *factors* in which they differ.

    *places*, (n, k), are 0 … 1, NaN where a factor is absent from the run's configuration. *metrics* and *margins* are
    in SI, NaN where undefined, *verdicts* positions in `VERDICTS`, each (n,) by name. The runs that are *even*, (n,),
    were drawn evenly over the space (`Placing`); only of these a share is one of the space. *weights*, (n,), are what
    runs count: 1, or on a grid how much of the space there is to a run, 1 on average. So many runs are *different*: of
    those that share their values with others, as blocks of a design do, each adds little; not so *on_grid*. *plane* are
    the variables that are varied where all others are held; () if none is. *apart* is how many runs of the study are
    not among them. Where they are designs at the worst of so many *conditions* (`dse.analysis.conditions`),
    *incomplete* were left out; a run is one at 0 conditions. *known* is what was computed of it already
    (`dse.analysis.memoize`).
    """

    definition: StudyDefinition
    factors: tuple[Factor, ...]
    places: Floats
    numbers: NDArray[np.int64]
    configurations: NDArray[np.str_]
    done: Rows
    metrics: Mapping[str, Floats]
    margins: Mapping[str, Floats]
    verdicts: Mapping[str, Codes]
    even: Rows
    weights: Floats
    different: int
    on_grid: bool = False
    plane: tuple[str, ...] = ()
    apart: int = 0
    conditions: int = 0
    incomplete: int = 0
    known: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False)

    def __len__(self) -> int:
        return len(self.numbers)

    @property
    def rows(self) -> str:
        """What its rows are: ``runs``, or ``designs``."""
        return "designs" if self.conditions else "runs"

    @property
    def judged_metrics(self) -> tuple[str, ...]:
        """Those that requirements and objectives are about; all if there are none."""
        definition = self.definition
        about = [entry.metric for entry in definition.requirements] + [entry.name for entry in definition.objectives]
        return tuple(dict.fromkeys(name for name in about if name in self.metrics)) or (*self.metrics,)

    def met(self, requirement: str = ALL) -> Rows:
        """Which runs meet *requirement*: neither those that did not exercise it nor those that failed to run."""
        return np.asarray(self.codes(requirement) == MET)

    def codes(self, requirement: str) -> Codes:
        """The verdicts on *requirement*, or on `ALL`, (n,); DseError if there is none."""
        from dse.metrics import overall_codes

        if requirement == ALL and self.verdicts:
            return overall_codes([*self.verdicts.values()], self.done)
        if requirement not in self.verdicts:
            raise fail(f"the study has no requirement '{requirement}'", None, closest(requirement, self.verdicts))
        return self.verdicts[requirement]

    def about(self, requirement: str) -> StudyData:
        """The rows to which *requirement* applies. DseError if there is none of that name."""
        rows = self.codes(requirement) != NOT_APPLICABLE
        if rows.all():
            return self
        key = ("about", rows.tobytes())
        if key not in self.known:
            self.known[key] = self.part(rows)
        found: StudyData = self.known[key]
        return found

    def factor(self, name: str) -> int:
        """The position of a factor; DseError if the runs do not differ in *name*."""

        names = [factor.name for factor in self.factors]
        if name not in names:
            raise fail(f"the runs do not differ in '{name}'", None, closest(name, names))
        return names.index(name)

    def part(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> StudyData:
        """Only these *rows*, with the same factors and weights."""
        return replace(
            self,
            places=self.places[rows],
            numbers=self.numbers[rows],
            configurations=self.configurations[rows],
            done=self.done[rows],
            metrics={name: values[rows] for name, values in self.metrics.items()},
            margins={name: values[rows] for name, values in self.margins.items()},
            verdicts={name: values[rows] for name, values in self.verdicts.items()},
            even=self.even[rows],
            weights=self.weights[rows],
        )

    def evenly(self, about: str, least: int) -> StudyData:
        """The runs that are drawn evenly over the space. DseError *about* something if these are less than *least*."""
        if self.even.all():
            return self
        if (count := int(self.even.sum())) < least:
            which = f"{count or 'none'} of the {len(self)} {self.rows} of '{self.definition.sampler.kind}'"
            what = f"{which} {'is' if count < 2 else 'are'} drawn evenly over the space, and {least} are needed"
            raise withheld(about, what, "next: a study with 'sobol'")
        found: StudyData = self.known.get("even") or self.part(self.even)
        self.known["even"] = found
        return found

    @property
    def points(self) -> NDArray[np.intp]:
        """The number of each run's point of the variables, (n,); one of its own on a grid, or if points are few."""
        if "points" not in self.known:
            first, which = distinct(self.places[:, [k for k, each in enumerate(self.factors) if not each.is_choice]])
            is_alone = self.on_grid or len(first) < _FEW_POINTS
            self.known["points"] = np.arange(len(self)) if is_alone else np.argsort(np.argsort(first))[which]
        return np.asarray(self.known["points"], dtype=np.intp)

    def half(self) -> Rows:
        """The runs at every other of the points by chance, (n,): what is found by these is judged by the others."""
        points = self.points
        chosen = np.random.default_rng(0).permutation(int(points.max(initial=-1)) + 1) % 2 == 0
        return np.asarray(chosen[points])

    def response(self, metric: str, least: int) -> tuple[StudyData, Floats]:
        """The runs in which *metric* is defined, and its values there.

        DseError if there is no such metric, if it is defined in fewer than *least* runs, or never changes.
        """

        if metric not in self.metrics:
            raise fail(f"the study has no metric '{metric}'", None, closest(metric, self.metrics))
        values = self.metrics[metric]
        there = np.isfinite(values)
        if (count := int(there.sum())) < least:
            raise withheld(metric, f"it is defined in {count} of {len(self)} runs, and {least} are needed")
        if np.ptp(values[there]) <= _NOISE * np.abs(values[there]).max():
            raise withheld(metric, "it is the same in every run in which it is defined")
        if count == len(self):
            return self, values
        key = ("response", there.tobytes())
        if key not in self.known:
            self.known[key] = self.part(there)
        return self.known[key], values[there]


def distinct(places: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The first row of each point of *places*, (n, factors), and the number of each row's point; NaN is a value."""
    _, first, which = np.unique(np.nan_to_num(places, nan=-1.0), axis=0, return_index=True, return_inverse=True)
    return first, which.reshape(-1)


def withheld(about: str, why: str, hint: str = "") -> DseError:
    """Why nothing is said *about* something."""
    return fail(f"{about}: {why}", None, hint)


_NOISE = 1e-12
"""Relative changes that are rounding."""

_FEW_POINTS = 10
"""Halves of fewer points are not alike."""
