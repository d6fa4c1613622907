"""How a system is simulated: the co-simulation algorithm and its options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum


class Algorithm(StrEnum):
    """The order in which elements exchange values and step (Kübler and Schiehlen, 2000)."""

    JACOBI = "jacobi"
    """All step over the same interval with what was known at its beginning."""

    GAUSS_SEIDEL = "gauss_seidel"
    """One after the other: an element's inputs are the newest there are."""


class Extrapolation(StrEnum):
    """What an input does during a step."""

    HOLD = "hold"
    LINEAR = "linear"
    """On along the line through the last two communication points: as a slope where the FMU takes one (FMI 2
    canInterpolateInputs, model exchange) or asks for values in between (FMI 3 intermediate update), else its value at
    mid-step. An output that follows such an input directly then lags half a step, unless values are propagated. Inputs
    and sources that are not continuous real numbers are held."""


class Coupling(StrEnum):
    """What happens at a communication point, before values are recorded and passed on."""

    NONE = "none"
    """Outputs are taken as the last step left them."""

    PROPAGATE = "propagate"
    """Values are carried along the direct dependencies in their order; algebraic loops are refused.

    FMI 2.0 (4.2.4) does not oblige an FMU to show what its inputs do before it has stepped; one that does not is
    recorded as under NONE.
    """

    SOLVE = "solve"
    """As PROPAGATE, and algebraic loops are solved with Newton's method."""


@dataclass(frozen=True, slots=True)
class Adaptive:
    """Error control by step doubling: the bench's step is halved until a step and two half steps agree.

    *tolerance* is relative to the largest magnitude an output has had so far, *absolute* in the output's unit. A
    step that an FMU discards is halved, too. One that needs to be shorter than *smallest* (seconds) fails by name.
    """

    tolerance: float = 1e-4
    absolute: float = 1e-6
    smallest: float = 1e-6


@dataclass(frozen=True, slots=True)
class Bond:
    """Two outputs that are each an input of the other's element and whose product is the power between them, in W.

    Both are labels, ``element.variable``. The residual energy is what the coupling adds to the system by itself: the
    sum over steps of ``h * (effort_used * flow - effort * flow_used)``, outputs taken at the end of a step and inputs
    as they were used during it (Sadjina, Kyllingstad, Skjong and Pedersen, 2017). It is recorded as ``bonds.NAME``, J.
    """

    name: str
    effort: str
    flow: str


@dataclass(frozen=True, slots=True)
class Method:
    """The algorithm of a run; what is not said is the plain one: Jacobi, one fixed step, inputs held.

    *steps* gives elements a communication step of their own, in seconds: a whole multiple or a whole fraction of the
    run's step. An element with a longer one takes its inputs at the beginning and shows its outputs at the end of its
    step; one with a shorter one makes several steps with its inputs extrapolated. *extrapolation* is the one of all
    elements, *extrapolations* those of single ones.

    *leading* elements are the system's first. With Jacobi they go ahead of all others in every step, and what they show
    then is of the step's beginning: the others take it for this step. So goes what waits outside for the values of its
    own step (`dse.domain.udp`, the role server).
    """

    algorithm: Algorithm = Algorithm.JACOBI
    coupling: Coupling = Coupling.NONE
    extrapolation: Extrapolation = Extrapolation.HOLD
    extrapolations: Mapping[str, Extrapolation] = field(default_factory=dict)
    steps: Mapping[str, float] = field(default_factory=dict)
    adaptive: Adaptive | None = None
    bonds: tuple[Bond, ...] = ()
    leading: tuple[str, ...] = ()

    @property
    def is_plain_but_for_order(self) -> bool:
        """Whether the algorithm is all that may differ from the plain method."""
        return replace(self, algorithm=Algorithm.JACOBI) == PLAIN


PLAIN = Method()

BONDS = "bonds"
"""What stands before the name of a bond where signals are named: ``bonds.axle``."""
