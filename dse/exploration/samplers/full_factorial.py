"""Every combination of levels."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import Field

from dse.domain.sampler import Brief, DesignVariable, Grid, Placing, Role
from dse.errors import Problem, closest, raise_if_any
from dse.exploration.one_shot_sampler import MOST_RUNS, ValueSampler, require_few
from dse.exploration.variables import levels, once_each
from dse.loading import Surroundings

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class FullFactorial(ValueSampler):
    """Every combination of levels, the last variable fastest; with *slices* the union of the slices' factorials.

    In a slice the other variables are at their nominal values. A point that several slices share is asked for once.
    """

    name: ClassVar[str] = "full_factorial"
    placing: ClassVar[Placing] = Placing.EVEN
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({},)

    slices: list[list[str]] = Field(default_factory=list)

    @property
    def grid(self) -> Grid | None:
        """The slices."""
        return tuple(tuple(names) for names in self.slices)

    def settled(self, around: Surroundings) -> Self:
        """Raises DseError for slices of what is no design variable, variables without levels, and too many runs."""
        problems = [*self._problems(around)]
        problems += [
            Problem(f"'{variable.name}' needs at least 2 levels", variable.where, _hint(variable))
            for variable in around.variables
            if variable.levels < 2
        ]
        runs = sum(
            math.prod(max(1, variable.levels) for variable in around.variables if variable.name in names)
            for names in self.slices or [list(around.names)]
        )
        if runs > MOST_RUNS:
            where = around.entry.document.top["sampler"].key
            problems.append(Problem(f"{runs} runs for each configuration", where, "use fewer levels or slices"))
        raise_if_any(problems)
        return self

    def values(self, brief: Brief) -> NDArray[np.float64]:
        """The points in order, each once."""
        import numpy as np

        free = [set(names) for names in self.slices] or [{variable.name for variable in brief.variables}]
        axes = [
            [levels(variable) if variable.name in names else (variable.nominal,) for variable in brief.variables]
            for names in free
        ]
        require_few(sum(math.prod(map(len, axis)) for axis in axes), None)
        # As arrays: a million tuples would take 400 MB.
        grids = [np.stack(np.meshgrid(*axis, indexing="ij"), axis=-1) if axis else np.empty((1, 0)) for axis in axes]
        whole = [grid.reshape(math.prod(map(len, axis)), len(axis)) for grid, axis in zip(grids, axes, strict=True)]
        return once_each(np.concatenate(whole))

    def _problems(self, around: Surroundings) -> Iterator[Problem]:
        for i, names in enumerate(self.slices):
            if not names:
                where = around.place("slices", i)
                yield Problem("a slice names no design variable", where, "remove it or name one")
            for j, name in enumerate(names):
                where = around.place("slices", i, j)
                if name in names[:j]:
                    yield Problem(f"'{name}' occurs twice in a slice", where, "remove one")
                if name not in around.names:
                    yield Problem(f"'{name}' is not a design variable", where, closest(name, around.names))


def _hint(variable: DesignVariable) -> str:
    return "take 'sobol', or vary it as a condition" if variable.role is Role.UNCERTAIN else "levels: 25"


SAMPLER = FullFactorial
