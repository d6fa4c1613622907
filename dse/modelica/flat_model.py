"""The flat model: scalar variables, equations and events, as read from the front-end's flattened system."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction

from dse.errors import Location
from dse.modelica.algebra.expression import Expression, Graph


class ScalarType(StrEnum):
    """Modelica's scalar types."""

    REAL = "Real"
    INTEGER = "Integer"
    BOOLEAN = "Boolean"
    ENUMERATION = "enumeration"


class Role(StrEnum):
    """How a variable gets its value."""

    PARAMETER = "parameter"
    """From *binding* or *start*; or, if it is not fixed, from the initial equations."""
    INPUT = "input"
    CONTINUOUS = "continuous"
    """From the equations; whether it is a state is decided by the index reduction."""
    DISCRETE = "discrete"
    """Changes at events only, by the discrete assignments."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One scalar variable; an array's element is called ``name[1]`` or ``name[2,3]``.

    *start* is NaN-free where given. A parameter's *binding* may refer to other parameters; if it is absent or a
    number, the parameter can be set from outside. *is_structural*: the front-end used its value, so that another
    value needs another build. *items* name an enumeration's values 1, 2, …
    """

    name: str
    kind: ScalarType
    role: Role
    is_output: bool = False
    start: Expression | None = None
    is_fixed: bool = False
    binding: Expression | None = None
    minimum: Expression | None = None
    maximum: Expression | None = None
    nominal: Expression | None = None
    unit: str = ""
    description: str = ""
    prefers_state: int = 0
    """stateSelect: -2 never, -1 avoid, 0 default, 1 prefer, 2 always."""
    is_final: bool = False
    is_protected: bool = False
    is_structural: bool = False
    items: tuple[str, ...] = ()
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class Equation:
    """``residual = 0``."""

    residual: Expression
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class Relation:
    """A comparison that makes an event when its truth changes. Equations refer to it as ``held(<its place>)``.

    *truth* is the comparison itself (less, less_equal, greater, greater_equal; equal and not_equal of discrete values
    only) over quantities as they are now.
    """

    truth: Expression
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class Clock:
    """Ticks at *phase* + k * *period* seconds, for k = 0, 1, … (``sample(phase, period)``), of the time, or since the
    start of the simulation if *is_from_start*."""

    period: Fraction
    phase: Fraction
    is_from_start: bool = False


@dataclass(frozen=True, slots=True)
class Trigger:
    """When a when-clause becomes active: one of *conditions* becomes true, a clock ticks, or at the start.

    A condition is a truth value over held relations, discrete variables and pre-values. It becomes true if it is true
    now and was not in the event iteration before.
    """

    conditions: tuple[Expression, ...] = ()
    clocks: tuple[int, ...] = ()
    at_start: bool = False


@dataclass(frozen=True, slots=True)
class Assignment:
    """A discrete variable's equation, solved for it: at every event, or when *trigger* (its number) is active.

    Several may have one target: the first active one holds; if none is, the variable keeps ``pre``.
    """

    target: str
    value: Expression
    trigger: int | None = None
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class Reinitialization:
    """``reinit(state, value)``; of several for one state the first active one holds."""

    state: str
    value: Expression
    trigger: int
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class Check:
    """An assert: *condition* must be true whenever the model stands at an accepted point of time.

    With *is_warning* it is told, else the run fails. A terminate is a check of *condition* false under *trigger*.
    """

    condition: Expression
    message: str
    is_warning: bool = False
    trigger: int | None = None
    terminates: bool = False
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class FlatModel:
    """A whole model. Names are unique."""

    name: str
    graph: Graph
    variables: Mapping[str, Variable]
    equations: tuple[Equation, ...]
    initial_equations: tuple[Equation, ...] = ()
    relations: tuple[Relation, ...] = ()
    clocks: tuple[Clock, ...] = ()
    triggers: tuple[Trigger, ...] = ()
    assignments: tuple[Assignment, ...] = ()
    reinitializations: tuple[Reinitialization, ...] = ()
    checks: tuple[Check, ...] = ()

    def at_events(self) -> Iterator[tuple[Expression, Location | None]]:
        """What is looked at because of events, and where it stands: relations, new values, conditions of checks."""
        yield from ((one.truth, one.where) for one in self.relations)
        yield from ((one.value, one.where) for one in self.assignments)
        yield from ((one.value, one.where) for one in self.reinitializations)
        yield from ((one.condition, one.where) for one in self.checks)

    def mapped(self, new: Callable[[Expression], Expression]) -> FlatModel:
        """The same with *new* of every expression."""
        return replace(
            self,
            variables={name: _mapped(variable, new) for name, variable in self.variables.items()},
            equations=tuple(replace(one, residual=new(one.residual)) for one in self.equations),
            initial_equations=tuple(replace(one, residual=new(one.residual)) for one in self.initial_equations),
            relations=tuple(replace(one, truth=new(one.truth)) for one in self.relations),
            triggers=tuple(replace(one, conditions=tuple(map(new, one.conditions))) for one in self.triggers),
            assignments=tuple(replace(one, value=new(one.value)) for one in self.assignments),
            reinitializations=tuple(replace(one, value=new(one.value)) for one in self.reinitializations),
            checks=tuple(replace(one, condition=new(one.condition)) for one in self.checks),
        )


def _mapped(variable: Variable, new: Callable[[Expression], Expression]) -> Variable:
    given = (variable.start, variable.binding, variable.minimum, variable.maximum, variable.nominal)
    if all(one is None or one.is_constant for one in given):
        return variable
    start, binding, minimum, maximum, nominal = (None if one is None else new(one) for one in given)
    return replace(variable, start=start, binding=binding, minimum=minimum, maximum=maximum, nominal=nominal)
