"""The variables of the FMU that a Modelica model becomes: what the description lists and the C code keeps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

from dse.errors import Location, Problem, closest, fail, raise_if_any
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.emit.expressions.setting import MemoryLayout, memory_layout
from dse.modelica.flat_model import Role, ScalarType, Variable
from dse.modelica.solved_model import Solved, targets


class Causality(StrEnum):
    """FMI's word for what a variable is to the outside."""

    PARAMETER = "parameter"
    CALCULATED_PARAMETER = "calculatedParameter"
    INPUT = "input"
    OUTPUT = "output"
    LOCAL = "local"


class Variability(StrEnum):
    """FMI's word for when a variable's value may change."""

    CONSTANT = "constant"
    FIXED = "fixed"
    TUNABLE = "tunable"
    DISCRETE = "discrete"
    CONTINUOUS = "continuous"


@dataclass(frozen=True, slots=True)
class FmuVariable:
    """One variable of the FMU. *reference* is its value reference, its own alone; *place* is where its value lives in
    ``v``, shared by variables that are equal.

    Numbers are as the model has them: *unit* is the model's attribute ("" if it has none), an enumeration's values
    count from 1 in the order of *items*, a Boolean is 0 or 1. *start* is set for parameters, inputs and constants, and
    for nothing else. *derivative_of* is the reference of the state whose time derivative it is.
    """

    name: str
    reference: int
    place: int
    kind: ScalarType
    causality: Causality
    variability: Variability
    start: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    unit: str = ""
    description: str = ""
    items: tuple[str, ...] = ()
    derivative_of: int | None = None
    where: Location | None = None


_SETTABLE = (Causality.PARAMETER, Causality.INPUT)
_INTERNAL = "$"


def variables(solved: Solved, starts: Mapping[str, float] | None = None) -> tuple[FmuVariable, ...]:
    """The FMU's variables by reference: parameters, inputs, outputs, then states, derivatives of states and the others.

    What the translation added for itself is left out. *starts* are values for parameters and inputs instead of the
    model's own. A parameter that nobody can set (structural, final or protected) is a constant. Raises DseError: a
    parameter without a value, a start of something that cannot be set, a start that is no finite number.
    """
    given = dict(starts or {})
    memory = memory_layout(solved)
    free = _free_parameters(solved)
    values = _start_values(solved, free, given)
    listed = (declared for name, declared in solved.flat.variables.items() if not name.startswith(_INTERNAL))
    found = [_declared(memory, free, values, declared) for declared in listed]
    _refuse_unusable(solved, found, given)
    ordered = sorted([*found, *_derivatives(solved, memory)], key=lambda listed: _ORDER.index(listed.causality))
    references = {listed.name: reference for reference, listed in enumerate(ordered)}
    states = {str(state.derivative): references[str(state)] for state in solved.states}
    return tuple(
        replace(listed, reference=reference, derivative_of=states.get(listed.name))
        for reference, listed in enumerate(ordered)
    )


def _free_parameters(solved: Solved) -> frozenset[str]:
    """Parameters whose value is given, not computed."""
    computed = {symbol.name for blocks in (solved.parameters, solved.initial) for symbol in targets(blocks)}
    return frozenset(
        name
        for name, declared in solved.flat.variables.items()
        if declared.role is Role.PARAMETER and name not in computed and name not in solved.aliases
    )


def _start_values(solved: Solved, free: frozenset[str], given: Mapping[str, float]) -> Callable[[Symbol], float]:
    """Values of parameters, as far as they follow from the starts, and of inputs; NaN for everything else."""
    values: dict[Symbol, float] = {}

    def known(symbol: Symbol) -> float:
        return values.get(symbol, math.nan)

    for name, declared in solved.flat.variables.items():
        if name in free:
            own = declared.start if declared.binding is None else declared.binding
            if own is None and name not in given:
                hint = "give it a value in the model, or under 'parameters'"
                raise fail(f"parameter '{name}' has no value", declared.where, hint)
            values[Symbol(name)] = given[name] if own is None else given.get(name, evaluate([own], known)[0])
    for assignment in solved.parameters:
        values[assignment.unknown] = evaluate([assignment.value], known)[0]
    for name, declared in solved.flat.variables.items():
        if declared.role is Role.INPUT:
            least = 1.0 if declared.kind is ScalarType.ENUMERATION else 0.0
            own_start = least if declared.start is None else evaluate([declared.start], known)[0]
            values[Symbol(name)] = given.get(name, own_start)
    return known


def _declared(
    memory: MemoryLayout, free: frozenset[str], values: Callable[[Symbol], float], declared: Variable
) -> FmuVariable:
    causality, variability = _role(declared, declared.name in free)
    has_start = causality in _SETTABLE or variability is Variability.CONSTANT
    return FmuVariable(
        name=declared.name,
        reference=0,
        place=memory.of(declared.name),
        kind=declared.kind,
        causality=causality,
        variability=variability,
        start=values(Symbol(declared.name)) if has_start else None,
        minimum=_number(declared.minimum),
        maximum=_number(declared.maximum),
        nominal=_number(declared.nominal),
        unit=declared.unit,
        description=declared.description,
        items=declared.items,
        where=declared.where,
    )


def _role(declared: Variable, is_free: bool) -> tuple[Causality, Variability]:
    match declared.role:
        case Role.PARAMETER if not is_free:
            return Causality.CALCULATED_PARAMETER, Variability.TUNABLE
        case Role.PARAMETER if declared.is_structural or declared.is_final or declared.is_protected:
            return Causality.LOCAL, Variability.CONSTANT
        case Role.PARAMETER:
            return Causality.PARAMETER, Variability.TUNABLE
    is_discrete = declared.role is Role.DISCRETE or declared.kind is not ScalarType.REAL
    variability = Variability.DISCRETE if is_discrete else Variability.CONTINUOUS
    if declared.role is Role.INPUT:
        return Causality.INPUT, variability
    return Causality.OUTPUT if declared.is_output else Causality.LOCAL, variability


def _number(expression: Expression | None) -> float | None:
    """A limit that holds whatever the parameters are; others depend on values that can be set."""
    if expression is None or not expression.is_constant or not math.isfinite(expression.value):
        return None
    return expression.value


def _derivatives(solved: Solved, memory: MemoryLayout) -> list[FmuVariable]:
    """The states' derivatives, and the states that are derivatives themselves."""
    found: dict[Symbol, FmuVariable] = {}
    for state in solved.states:
        for symbol in (state, state.derivative):
            if symbol.order > 0:
                found[symbol] = FmuVariable(
                    name=str(symbol),
                    reference=0,
                    place=memory.places[symbol],
                    kind=ScalarType.REAL,
                    causality=Causality.LOCAL,
                    variability=Variability.CONTINUOUS,
                    description=f"time derivative of {Symbol(symbol.name, symbol.order - 1)}",
                )
    return list(found.values())


# What a user looks for first comes first; the sort is stable, so that the model's own order stays.
_ORDER = (Causality.PARAMETER, Causality.INPUT, Causality.OUTPUT, Causality.LOCAL, Causality.CALCULATED_PARAMETER)


def _refuse_unusable(solved: Solved, found: Iterable[FmuVariable], given: Mapping[str, float]) -> None:
    by_name = {listed.name: listed for listed in found}
    problems = [
        Problem(f"the start of '{listed.name}' is not a finite number", listed.where)
        for listed in by_name.values()
        if listed.start is not None and not math.isfinite(listed.start)
    ]
    for name in given:
        listed = by_name.get(name)
        if listed is None:
            problems.append(Problem(f"the model has no variable '{name}'", None, closest(name, by_name)))
        elif listed.causality not in _SETTABLE and not solved.flat.variables[name].is_structural:
            what = f"'{name}' cannot be given a start: it is not a parameter or input that can be set"
            problems.append(Problem(what, listed.where))
    raise_if_any(problems)
