"""The sorted model: what has to be computed in which order. Made by `structure`, turned into C by `emit`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from dse.errors import Location
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.flat_model import FlatModel


@dataclass(frozen=True, slots=True)
class Explicit:
    """``unknown := value``."""

    unknown: Symbol
    value: Expression


@dataclass(frozen=True, slots=True)
class System:
    """Equations to be solved together, torn: Newton's method over *unknowns* (or one linear solve).

    For trial values of *unknowns*, *inner* assignments are made in order; then *residuals* (as many as *unknowns*)
    must vanish. *jacobian* has one row a residual and one column an unknown, with the inner assignments differentiated
    through: its entries refer to *unknowns*, to what *inner* assigns and to what is known. If *is_linear* they do not
    refer to *unknowns* or *inner*, and one solve is exact. If *is_continued* they refer to how far ``homotopy`` is
    continued: to be solved from its simplified expressions to the actual ones.
    """

    unknowns: tuple[Symbol, ...]
    inner: tuple[Explicit, ...]
    residuals: tuple[Expression, ...]
    jacobian: tuple[tuple[Expression, ...], ...]
    is_linear: bool
    where: tuple[Location, ...] = ()
    is_continued: bool = False


Block = Explicit | System


@dataclass(frozen=True, slots=True)
class When:
    """Discrete variable *target* at an event: value of the first of *branches* whose trigger is active, else its pre.

    A branch with trigger None is always active.
    """

    target: Symbol
    branches: tuple[tuple[int | None, Expression], ...]


@dataclass(frozen=True, slots=True)
class Activation:
    """Decide whether trigger number *trigger* is active now; before anything that depends on it."""

    trigger: int


EventBlock = Explicit | System | When | Activation
B = TypeVar("B", bound=EventBlock)


@dataclass(frozen=True, slots=True)
class Selection:
    """States that are selected during the run among *candidates*; as many as there are *rows* of them become no states.

    The first *never* candidates are never states. The states are sums of the others, each over its unit, by `shares`,
    one of which is not 0. Together with their derivatives below order *levels* they are states of the model. `matrix`
    has the rows' coefficients of the candidates, and of other states behind them; they are compared after being
    multiplied by *weights*. *subject* are the rows' equations.
    """

    number: int
    candidates: tuple[Symbol, ...]
    levels: int
    rows: int
    never: int
    units: tuple[float, ...]
    weights: tuple[float, ...]
    subject: str
    where: tuple[Location, ...] = ()

    @property
    def every(self) -> list[Symbol]:
        """The candidates, then their derivatives, as far as they may be states."""
        return [Symbol(one.name, one.order + level) for level in range(self.levels) for one in self.candidates]

    @property
    def states(self) -> list[str]:
        """Names of the variables that become states."""
        return [f"stateSelect.set{self.number}.x[{k + 1}]" for k in range(len(self.candidates) - self.rows)]

    @property
    def shares(self) -> list[list[str]]:
        """Names of the discrete factors of the candidates, for each state."""
        columns = range(len(self.candidates) - self.never)
        return [[f"${state}.share[{column + 1}]" for column in columns] for state in self.states]

    @property
    def matrix(self) -> list[str]:
        """Names of the coefficients, row by row."""
        return [f"$set{self.number}[{k + 1}]" for k in range(self.rows * len(self.weights))]


@dataclass(frozen=True, slots=True)
class Solved:
    """Everything in order. Symbols of eliminated variables occur only in *aliases*.

    *states*: independent ones; each has its derivative (order + 1) among the unknowns of *derivatives*. A state may be
    itself a derivative: for ``der(der(s)) = a`` the states are s and der(s), the latter a symbol of order 1.
    *constants*: values of variables that depend on numbers alone, folded already.
    *parameters*: dependent parameters, once after the initialization and whenever a parameter is set.
    *derivatives*: enough for the states' derivatives and all relations' sides; hot.
    *outputs*: the other unknowns; only when somebody looks.
    *event*: everything at an event, continuous and discrete, given pre-values and which clocks tick.
    *initial*: everything at the start, states and parameters that are not fixed included; discrete variables too.
    *aliases*: eliminated variable -> (kept symbol, sign +1 or -1).
    *guesses*: starting values of unknowns of Newton's method, states and discrete variables, before *initial*.
    *dependencies*: for each output and each state's derivative, the inputs and states it depends on (may be more
    than needed); keys are names or symbols' texts.
    *selections*: states that are selected during the run.
    """

    flat: FlatModel
    states: tuple[Symbol, ...]
    parameters: tuple[Explicit, ...]
    derivatives: tuple[Block, ...]
    outputs: tuple[Block, ...]
    event: tuple[EventBlock, ...]
    initial: tuple[EventBlock, ...]
    aliases: Mapping[str, tuple[Symbol, int]]
    guesses: tuple[Explicit, ...]
    dependencies: Mapping[str, frozenset[str]]
    notes: tuple[str, ...] = ()
    selections: tuple[Selection, ...] = ()


def targets(blocks: Iterable[EventBlock]) -> Iterator[Symbol]:
    """What *blocks* compute, in their order."""
    for block in blocks:
        match block:
            case Explicit(unknown):
                yield unknown
            case System(unknowns, inner):
                yield from unknowns
                yield from (assignment.unknown for assignment in inner)
            case When(target):
                yield target


def expressions(block: EventBlock, flat: FlatModel) -> tuple[Expression, ...]:
    """Everything *block* evaluates."""
    match block:
        case Explicit(_, value):
            return (value,)
        case System(_, inner, residuals, jacobian):
            rows = (entry for row in jacobian for entry in row)
            return (*(assignment.value for assignment in inner), *residuals, *rows)
        case When(_, branches):
            return tuple(value for _, value in branches)
        case Activation(trigger):
            return flat.triggers[trigger].conditions


def all_expressions(solved: Solved) -> Iterator[Expression]:
    """Every expression of the model that becomes code."""
    flat = solved.flat
    for blocks in (solved.parameters, solved.derivatives, solved.outputs, solved.event, solved.initial, solved.guesses):
        for block in blocks:
            yield from expressions(block, flat)
    yield from (condition for trigger in flat.triggers for condition in trigger.conditions)
    yield from (root for root, _ in flat.at_events())


def mapped(block: B, new: Callable[[Expression], Expression]) -> B:
    """The same with *new* of every expression it holds."""
    if isinstance(block, Explicit):
        return replace(block, value=new(block.value))
    if isinstance(block, System):
        return replace(
            block,
            inner=tuple(mapped(one, new) for one in block.inner),
            residuals=tuple(map(new, block.residuals)),
            jacobian=tuple(tuple(map(new, row)) for row in block.jacobian),
        )
    if isinstance(block, When):
        return replace(block, branches=tuple((trigger, new(value)) for trigger, value in block.branches))
    return block
