"""Points and the unit cube: where in a variable's range, on its scale or in its distribution, a value lies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import TYPE_CHECKING

from dse.domain.definition import DefinedVariable
from dse.domain.distribution import Correlations, Distribution, correlation_matrix, cumulative, quantile
from dse.domain.expression import Expression
from dse.domain.sampler import Brief, DesignVariable, Point, Role, Scale
from dse.domain.study import types_of
from dse.metrics import compile_rule
from dse.units import parse_unit

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def scaled(unit: Array, variables: Sequence[DesignVariable], correlations: Correlations | None = None) -> Array:
    """Points of the unit cube, (n, variables), as values of *variables*.

    Correlated variables are joined by a Gaussian copula (Nelsen, An Introduction to Copulas, 2006, section 2.4); what
    has certain values only takes equal parts of its side.
    """
    import numpy as np

    joined = _correlated(unit, variables, correlations) if correlations else unit
    columns = [value_at(variable, joined[:, index]) for index, variable in enumerate(variables)]
    return np.column_stack(columns) if columns else np.zeros((len(unit), 0))


def unit_of(points: Array, variables: Sequence[DesignVariable]) -> Array:
    """The inverse of `scaled` without correlations, (n, variables); 0 … 1 within the ranges."""
    import numpy as np

    columns = [share_of(variable, points[:, index]) for index, variable in enumerate(variables)]
    return np.column_stack(columns) if columns else np.zeros((len(points), 0))


def design_variable(defined: DefinedVariable) -> DesignVariable:
    """A stored variable as a sampler knows it."""
    given = defined.distribution
    return DesignVariable(
        defined.name,
        defined.low,
        defined.high,
        defined.levels,
        defined.nominal,
        parse_unit(defined.unit),
        defined.title,
        scale=Scale(defined.scale),
        values=defined.values,
        role=Role(defined.role),
        distribution=Distribution(given.kind, given.numbers, given.values) if given else None,
        labels=defined.labels,
        weights=defined.weights,
    )


def free(brief: Brief) -> tuple[DesignVariable, ...]:
    """The brief's variables that are no conditions, in their order."""
    return tuple(variable for variable in brief.variables if variable.role is not Role.CONDITION)


def at_conditions(points: Array, brief: Brief) -> Array:
    """Each of *points*, (n, free variables), at each of the brief's conditions, (n * conditions, variables).

    All conditions of the first point come first.
    """
    import numpy as np

    conditions = np.array(brief.conditions or [()], dtype=np.float64).reshape(len(brief.conditions) or 1, -1)
    is_free = np.array([variable.role is not Role.CONDITION for variable in brief.variables], dtype=np.bool_)
    whole = np.empty((len(points) * len(conditions), len(brief.variables)))
    whole[:, is_free] = np.repeat(points, len(conditions), axis=0)
    whole[:, ~is_free] = np.tile(conditions, (len(points), 1))
    return whole


def conditions_of(variables: Sequence[DesignVariable]) -> tuple[Point, ...]:
    """Every combination of the conditions' levels, the last fastest; () if there is none."""
    axes = [levels(variable) for variable in variables if variable.role is Role.CONDITION]
    return tuple(product(*axes)) if axes else ()


def allowing(
    constraints: Sequence[Expression], variables: Sequence[DesignVariable]
) -> Callable[[Array], NDArray[np.bool_]] | None:
    """Tells of points, (n, variables), which meet all *constraints*; None if there are none.

    As in a design space, a constraint that is undefined, as it divides by zero, is met. DseError if one makes no sense.
    """
    if not constraints:
        return None
    import numpy as np

    types = types_of(variables)
    rules = [compile_rule(constraint, types) for constraint in constraints]

    def allowed(points: Array) -> NDArray[np.bool_]:
        columns = {variable.name: points[:, index] for index, variable in enumerate(variables)}
        return np.asarray(np.all([rule.rows(columns) != 0 for rule in rules], axis=0), dtype=np.bool_)

    return allowed


def levels(variable: DesignVariable) -> tuple[float, ...]:
    """The variable's values, or its levels from low to high, both included; its nominal value if it has only one.

    On a linear scale each is the float nearest to the level computed from the decimal numbers the bounds are written
    as, so that 25 levels of 0.1 … 3 hold 1.55 and not its neighbour.
    """
    if variable.values:
        return variable.values
    if variable.levels == 1:
        return (variable.nominal,)
    last = variable.levels - 1
    if variable.scale is Scale.LOG:
        ratio = variable.high / variable.low
        inner = (variable.low * ratio ** (i / last) for i in range(1, last))
        return (variable.low, *inner, variable.high)
    from fractions import Fraction

    low, high = Fraction(str(variable.low)), Fraction(str(variable.high))
    return tuple(float((low * (last - i) + high * i) / last) for i in range(variable.levels))


def once_each(points: Array) -> Array:
    """Each of *points* the first time only."""
    import numpy as np

    if not points.shape[1]:
        return points[:1]
    order = np.lexsort(points.T)  # the first of equals comes first
    is_new = np.ones(len(points), dtype=np.bool_)
    for column in points.T:
        is_new[order[1:]] &= column[order[1:]] == column[order[:-1]]
    is_new[order[1:]] = ~is_new[order[1:]]
    return points if is_new.all() else points[is_new]


def value_at(variable: DesignVariable, share: Array) -> Array:
    """The values at *share* (n,), 0 … 1, of the variable's range, values or distribution."""
    import numpy as np

    if variable.values:
        values = np.array(variable.values)
        return np.asarray(values[np.minimum((share * len(values)).astype(np.intp), len(values) - 1)])
    low, high = variable.low, variable.high
    if variable.distribution is not None:
        found = quantile(variable.distribution, low, high, share)
    elif variable.scale is Scale.LOG:
        found = low * np.exp(share * np.log(high / low))
    else:
        found = low + share * (high - low)
    # Rounding may carry a value past the end of its range.
    return np.asarray(np.clip(found, low, high))


def share_of(variable: DesignVariable, value: Array) -> Array:
    """Where *value* (n,) lies: 0 at the low end, 1 at the high one; beyond these where it is outside of a range."""
    import numpy as np

    if variable.values:
        values = np.array(variable.values)
        nearest = np.abs(np.asarray(value)[:, None] - values).argmin(axis=1)
        return np.asarray((nearest + 0.5) / len(values))
    low, high = variable.low, variable.high
    if variable.distribution is not None:
        return cumulative(variable.distribution, low, high, value)
    if variable.scale is Scale.LOG:
        return np.asarray(np.log(value / low) / (np.log(high / low) or 1.0))
    return np.asarray((value - low) / ((high - low) or 1.0))


def _correlated(unit: Array, variables: Sequence[DesignVariable], correlations: Correlations) -> Array:
    import numpy as np
    from scipy.special import ndtr, ndtri

    names = sorted({name for pair in correlations for name in pair})
    index = {variable.name: number for number, variable in enumerate(variables)}
    columns = [index[name] for name in names]
    factor = np.linalg.cholesky(correlation_matrix(names, correlations))
    tiny = np.finfo(np.float64).eps
    joined = unit.copy()
    # Sums are taken one after the other: a matrix product's last bits depend on the machine.
    normal = ndtri(np.clip(unit[:, columns], tiny, 1 - tiny))
    for row, column in enumerate(columns):
        joined[:, column] = ndtr(sum(factor[row, j] * normal[:, j] for j in range(row + 1)))
    return joined
