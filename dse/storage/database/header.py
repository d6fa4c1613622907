"""What a study folder is about: its definition, and the runs that were asked for so far."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dse.domain.definition import StudyDefinition
from dse.storage.database.definition import fingerprint
from dse.storage.rows import Measures


@dataclass(frozen=True)
class StudyHeader:
    """*runs* were asked for so far, those of an extended study's earlier eras among them.

    *asked* of them are what the present definition asks for, *earlier* were there when the present *era* began;
    numbers from *base* on belong to it. *numbers* is one more than the largest number of a run. *first* runs of the
    present era are new ones of its first ask.
    """

    definition: StudyDefinition
    runs: int = 0
    asked: int = 0
    era: int = 0
    base: int = 0
    earlier: int = 0
    numbers: int = 0
    first: int = 0

    @cached_property
    def fingerprint(self) -> str:
        """Studies with equal fingerprints ask for the same runs and results."""
        return fingerprint(self.definition)

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the design variables, in order."""
        return tuple(variable.name for variable in self.definition.variables)

    @property
    def metrics(self) -> tuple[str, ...]:
        """Names of the metrics, in order."""
        return tuple(metric.name for metric in self.definition.metrics)

    @property
    def requirements(self) -> tuple[str, ...]:
        """Names of the requirements, in order."""
        return tuple(requirement.name for requirement in self.definition.requirements)

    @property
    def measures(self) -> Measures:
        """What every run gives."""
        return Measures(self.metrics, self.requirements)

    @property
    def configurations(self) -> tuple[str, ...]:
        """Ids of the configurations of which there may be runs."""
        return tuple(configuration.id for configuration in self.definition.configurations)

    def has(self, configuration: str) -> NDArray[np.bool_]:
        """Which of the variables the *configuration* has, (variables,); KeyError if there is none of that id."""
        return self._variables_by_configuration[configuration]

    def total(self, configuration: str, name: str) -> float:
        """The sum of the property *name* over *configuration*, SI; 0 where nothing has it."""
        return self._totals[configuration].get(name, 0.0)

    @cached_property
    def _totals(self) -> dict[str, dict[str, float]]:
        from dse.units import parse_unit

        return {
            each.id: {name: parse_unit(total.unit).to_si(total.value) for name, total in each.totals.items()}
            for each in self.definition.configurations
        }

    @cached_property
    def _variables_by_configuration(self) -> dict[str, NDArray[np.bool_]]:
        # Definitions that tell no constants are of studies whose configurations had all variables.
        configurations = self.definition.configurations
        tells = any(each.constants for each in configurations)
        return {
            each.id: np.array([not tells or name in each.constants for name in self.variables], dtype=np.bool_)
            for each in configurations
        }

    @property
    def slices(self) -> tuple[tuple[str, ...], ...] | None:
        """Variables that were varied together, if the runs lie on their grid; None if they lie anywhere."""
        return self.definition.sampler.slices if self.asked == self.runs else None
