"""Uncertain parameters of a study: how likely their values are, alone and together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from dse.domain.component import Kind
from dse.domain.distribution import Distribution, correlation_matrix, median, support
from dse.domain.sampler import DesignVariable, Role
from dse.errors import DseError, Problems, closest, fail
from dse.formats import Entry
from dse.loading.bench.variables import Place
from dse.loading.sections import Plain, Section
from dse.loading.values import read_number, read_quantity

_LEAST_EIGENVALUE = 1e-9


class NormalSection(Section):
    """A normal, or a lognormal distribution: mean and standard deviation of the variable itself."""

    mean: Plain
    sd: Plain


class BetaSection(Section):
    """A beta distribution between two ends."""

    alpha: float | int
    beta: float | int
    low: Plain
    high: Plain


class TriangularSection(Section):
    """A triangular distribution."""

    low: Plain
    mode: Plain
    high: Plain


class UniformSection(Section):
    """Everything between two ends is as likely."""

    low: Plain
    high: Plain


class UncertainSection(Section):
    """One uncertain parameter: exactly one distribution."""

    normal: NormalSection | None = None
    lognormal: NormalSection | None = None
    beta: BetaSection | None = None
    triangular: TriangularSection | None = None
    uniform: UniformSection | None = None
    empirical: list[Plain] | None = None
    title: str = ""


def read_uncertain(place: Place, entry: Entry, section: UncertainSection) -> DesignVariable:
    """An uncertain parameter, cut off at what its components allow. DseError with what is wrong with it."""
    if place.type.kind is not Kind.REAL:
        raise fail(f"'{place.name}' is {place.type}: only real parameters can be uncertain", entry.key)
    given = {name: value for name, value in section if value is not None and name != "title"}
    if len(given) != 1:
        raise fail(f"give '{place.name}' exactly one distribution", entry.key, "normal: {mean: 1, sd: 0.1}")
    ((kind, numbers),) = given.items()
    at = entry[kind]
    if isinstance(numbers, list):
        read = tuple(read_number(raw, place.unit, at[i].where) for i, raw in enumerate(numbers))
        distribution = Distribution(kind, values=read)
    else:
        distribution = Distribution(kind, {name: _number(place, at[name], name, raw) for name, raw in numbers})
    _require_proper(distribution, at)
    low, high = support(distribution)
    for _, least, most in place.limits():
        low, high = max(low, least), min(high, most)
    if not low < high:
        what = f"no value of the distribution of '{place.name}' is allowed by its component"
        raise fail(what, at.where, "give another one")
    nominal = min(max(median(distribution), low), high)
    title = place.title(section.title)
    variable = DesignVariable(place.name, low, high, 0, nominal, place.unit, title, entry.key)
    return replace(variable, role=Role.UNCERTAIN, distribution=distribution)


def read_correlations(
    entry: Entry, written: Sequence[Sequence[str | float | int]], variables: Sequence[DesignVariable]
) -> Mapping[tuple[str, str], float]:
    """Correlations of uncertain variables, by their names. DseError unless they can hold together."""
    uncertain = [variable.name for variable in variables if variable.role is Role.UNCERTAIN]
    found: dict[tuple[str, str], float] = {}
    problems = Problems()
    for i, line in enumerate(written):
        at = entry[i]
        match line:
            case [str(one), str(other), int() | float() as value] if one != other and -1 < value < 1:
                for name in (one, other):
                    if name not in uncertain:
                        problems.add(f"'{name}' is not uncertain", at.where, closest(name, uncertain))
                if {(one, other), (other, one)} & found.keys():
                    problems.add(f"'{one}' and '{other}' are listed there twice", at.where, "remove one")
                found[one, other] = float(value)
            case _:
                problems.add("expected two names and a number between -1 and 1", at.where, "[a.mass, b.mass, 0.6]")
    if problems:
        raise DseError(*problems)
    _require_possible(entry, found)
    return found


def _number(place: Place, entry: Entry, name: str, raw: Plain) -> float:
    if name in ("alpha", "beta"):
        return float(raw)
    value = read_number(raw, place.unit, entry.where)
    if name != "sd":
        return value
    # A deviation is a difference: 2 degC of it are 2 K.
    unit = read_quantity(raw, entry.where).unit
    return value - float((unit if unit.symbol else place.unit).offset)


def _require_proper(distribution: Distribution, entry: Entry) -> None:
    if problem := distribution.flaw:
        raise fail(problem, entry.where)


def _require_possible(entry: Entry, correlations: Mapping[tuple[str, str], float]) -> None:
    import numpy as np

    names = sorted({name for pair in correlations for name in pair})
    if names and np.linalg.eigvalsh(correlation_matrix(names, correlations))[0] < _LEAST_EIGENVALUE:
        raise fail("these correlations cannot hold together", entry.where, "the matrix is not positive definite")
