"""What changes how exactly an FMU computes, as was seen: what an error bar can be made of, or why it cannot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import nan


class Lever(StrEnum):
    """What an FMU's outputs answer to, so that its own error shows."""

    STEP = "shorter steps"
    DOUBLED = "longer steps"
    TOLERANCE = "tolerance"
    EXCHANGE = "model exchange"


@dataclass(frozen=True, slots=True)
class FmuNumerics:
    """What was seen of an FMU that makes steps of *step* seconds, or what is told of it.

    *changes* says by how much outputs change with each lever that settles, on average over time and relative to their
    range: what is left of the FMU's own error. *divisor* is what the step is divided by for that, 0 without that lever;
    *tolerance* what it is told, of either interface. *inner_step* is about the step it makes inside whatever it is
    asked for (seconds), *floor* what outputs still change by between the two shortest steps that were tried; both NaN
    if there is none. *exact* tells why it has no error of its own; *unknown*, why nobody can say how large that is. If
    there is neither a lever nor one of these, no experiment was needed.
    """

    step: float
    changes: Mapping[Lever, float] = field(default_factory=dict)
    divisor: int = 0
    tolerance: float = 0.0
    inner_step: float = nan
    floor: float = nan
    exact: str = ""
    unknown: str = ""
    shows_coupled: bool = False
