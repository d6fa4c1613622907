"""Distributions of the parameters of a scenario, in files of their own: OpenSCENARIO XML 1.1 to 1.3."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from pathlib import Path

from dse.domain.distribution import Distribution
from dse.errors import Location, Problems, fail, raise_if_any
from dse.formats import read_xml_file, shortened, shown
from dse.world.openscenario.document import Context, Node, Parameter
from dse.world.openscenario.expressions import Number, read_value
from dse.world.openscenario.scenario import Scenario, read_scenario

MOST_CASES = 100_000
_VALUES = "DistributionSet", "DistributionRange", "UserDefinedDistribution"
_STOCHASTIC = {
    "NormalDistribution": "normal",
    "LogNormalDistribution": "lognormal",
    "UniformDistribution": "uniform",
}
_Choice = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Uncertain:
    """A parameter with a *distribution*, cut off at *low* and *high* (None: open); without units, as in the file."""

    distribution: Distribution
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class Variation:
    """What a file varies in the *scenario* at a path.

    *cases* are values by parameter, as texts, in the order of the file: the last distribution varies fastest. A
    stochastic file has one case, which is empty, the *uncertain* parameters by name, and the number of *runs*.
    """

    scenario: Path
    cases: tuple[Mapping[str, str], ...]
    where: Location
    uncertain: Mapping[str, Uncertain] = field(default_factory=dict)
    runs: int = 0


def is_variation(path: Path) -> bool:
    """Whether the file at *path* is a distribution of parameters. Raises DseError located there: not XML, …"""
    root = read_xml_file(path, shown(path))
    return root.tag == "OpenSCENARIO" and root.child("ParameterValueDistribution") is not None


def read_variation(path: Path, inside: Path | None = None) -> Variation:
    """The distribution of parameters in the file at *path*.

    The scenario that it names is *inside* a folder, if that is given. Raises DseError with everything that is wrong or
    not supported, each located in the file.
    """
    root = Node(read_xml_file(path, shown(path)), {}, Context(path, {}, frozenset(), inside))
    if root.tag != "OpenSCENARIO":
        raise fail(f"an OpenSCENARIO file begins with <OpenSCENARIO>, not with <{root.tag}>", root.where)
    definition = root.need("ParameterValueDistribution")
    file = definition.need("ScenarioFile")
    scenario = root.context.file(file.text("filepath"), file.where, "the scenario")
    choice = definition.need("Deterministic", "Stochastic")
    if choice.tag == "Stochastic":
        runs = choice.whole("numberOfTestRuns")
        if not 1 <= runs <= MOST_CASES:
            raise fail(f"<Stochastic>: 'numberOfTestRuns' is {runs}, not 1 to {MOST_CASES}", choice.where)
        return Variation(scenario, ({},), definition.where, _uncertain(choice), runs)
    return Variation(scenario, _cases(choice), definition.where)


@dataclass(frozen=True, slots=True, eq=False)
class CaseSet:
    """Cases that one FMU can simulate: the *scenario* with *values* of parameters that are decided when it is built.

    *points* are values of its parameters, by name; all have the same names.
    """

    values: Mapping[str, str]
    scenario: Scenario
    points: tuple[Mapping[str, float], ...]


def case_sets(variation: Variation, host: str | None = None) -> tuple[CaseSet, ...]:
    """The cases of *variation*, divided by what is decided when an FMU is built; in the order of their first cases.

    *host* as for `read_scenario`. Raises DseError: a wrong scenario, or a value that its parameter cannot have.
    """
    found: list[CaseSet] = []
    pending: list[tuple[frozenset[str], _Choice, Sequence[_Choice]]] = [(frozenset(), {}, variation.cases)]
    while pending:
        settled, values, cases = pending.pop(0)
        scenario = read_scenario(variation.scenario, values, host)
        tuned = {each.name: each for each in scenario.parameters}
        names = set().union(*cases)
        loose = sorted(names - settled - tuned.keys())
        if not loose:
            points = [_point(case, [tuned[name] for name in tuned if name in names], variation) for case in cases]
            found.append(CaseSet(values, scenario, tuple(points)))
            continue
        # What follows from other parameters is a parameter of its own once it has a value.
        follows = {name for name in loose if name not in values and name not in scenario.decided}
        if follows:
            first = {name: case[name] for case in reversed(cases) for name in follows & case.keys()}
            pending.insert(0, (settled, {**values, **first}, cases))
            continue
        parts: dict[tuple[str | None, ...], list[_Choice]] = {}
        for case in cases:
            parts.setdefault(tuple(case.get(name) for name in loose), []).append(case)
        for part in parts.values():
            more = {name: part[0][name] for name in loose if name in part[0]}
            pending.append((settled | set(loose), {**values, **more}, part))
    return tuple(found)


def cut_off(parameter: Parameter, uncertain: Uncertain | None) -> Parameter:
    """*parameter* with the ends of its distribution, if it has one; it starts between them."""
    if uncertain is None:
        return parameter
    lows = [low for low in (parameter.least, uncertain.low) if low is not None]
    highs = [high for high in (parameter.most, uncertain.high) if high is not None]
    start = min(max([parameter.start, *lows]), *highs) if highs else max([parameter.start, *lows])
    return replace(parameter, least=max(lows, default=None), most=min(highs, default=None), start=start)


def _point(case: _Choice, parameters: Sequence[Parameter], variation: Variation) -> Mapping[str, float]:
    point = {}
    for each in parameters:
        text = case.get(each.name, repr(each.start))
        value = read_value(text, {}, variation.where)
        if not isinstance(value, Number) or not math.isfinite(value.value):
            what = f"a case has '{shortened(text)}' for '{each.name}', which is not a finite number"
            raise fail(what, variation.where)
        if not each.allows(value.value):
            what = f"a case has {value.value:g} for '{each.name}', which its constraints do not allow"
            raise fail(what, variation.where, f"see {each.where}")
        point[each.name] = value.value
    return point


def _cases(deterministic: Node) -> tuple[_Choice, ...]:
    """Every combination of what the distributions can be."""
    problems = Problems()
    lists: list[Sequence[_Choice]] = []
    seen: set[str] = set()
    for each in deterministic.children():
        with problems:
            if each.tag == "DeterministicSingleParameterDistribution":
                name = each.text("parameterName")
                choices: Sequence[_Choice] = [{name: value} for value in _values(each.need(*_VALUES))]
            elif each.tag == "DeterministicMultiParameterDistribution":
                choices = _value_sets(each.need("ValueSetDistribution"))
            else:
                raise each.unsupported()
            names = set().union(*choices)
            if twice := sorted(names & seen):
                raise fail(f"the parameter '{twice[0]}' is distributed twice", each.where)
            if not choices:
                raise fail(f"<{each.tag}> has no values", each.where)
            seen |= names
            lists.append(choices)
    raise_if_any(problems)
    if (count := math.prod(map(len, lists))) > MOST_CASES:
        raise fail(f"{count:,} cases: at most {MOST_CASES:,} are supported", deterministic.where)
    return tuple({name: text for part in parts for name, text in part.items()} for parts in itertools.product(*lists))


def _value_sets(node: Node) -> list[_Choice]:
    sets: list[_Choice] = []
    for each in node.all("ParameterValueSet"):
        values: dict[str, str] = {}
        for assignment in each.all("ParameterAssignment"):
            name = assignment.text("parameterRef")
            if name in values:
                raise fail(f"the parameter '{name}' is assigned twice", assignment.where)
            values[name] = _value(assignment)
        sets.append(values)
    return sets


def _values(node: Node) -> list[str]:
    if node.tag == "DistributionSet":
        return [_value(each) for each in node.all("Element")]
    if node.tag == "UserDefinedDistribution":
        raise node.unsupported()
    limits = node.need("Range")
    low, high, step = _decimal(limits, "lowerLimit"), _decimal(limits, "upperLimit"), _decimal(node, "stepWidth")
    if step <= 0:
        raise fail(f"<{node.tag}>: 'stepWidth' is {step}, not above 0", node.where)
    if high < low:
        raise fail("<Range>: 'upperLimit' is below 'lowerLimit'", limits.where)
    count = int((high - low) / step) + 1
    if count > MOST_CASES:
        raise fail(f"{count:,} values: at most {MOST_CASES:,} are supported", node.where)
    return [f"{low + i * step:f}" for i in range(count)]


def _value(node: Node) -> str:
    if "value" not in node.element.attributes:
        raise fail(f"<{node.tag}> has no 'value'", node.where)
    return node.element.get("value")


def _decimal(node: Node, name: str) -> Decimal:
    """The attribute as it is written, so that 0.1 is not the binary number beside it."""
    value = _finite(node, name)
    text = node.element.get(name).strip()
    return Decimal(text) if not text.startswith("$") else Decimal(repr(value))


def _finite(node: Node, name: str) -> float:
    value = node.real(name)
    if not math.isfinite(value) or abs(value) > 1e15:
        raise fail(f"<{node.tag}>: '{name}' is {value:g}, not a number up to 1e15", node.where)
    return value


def _uncertain(stochastic: Node) -> dict[str, Uncertain]:
    problems = Problems()
    found: dict[str, Uncertain] = {}
    for each in stochastic.children():
        with problems:
            if each.tag != "StochasticDistribution":
                raise each.unsupported()
            name = each.text("parameterName")
            if name in found:
                raise fail(f"the parameter '{name}' is distributed twice", each.where)
            found[name] = _distribution(each.only())
    raise_if_any(problems)
    return found


def _distribution(node: Node) -> Uncertain:
    if node.tag not in _STOCHASTIC:
        supported = ", ".join(f"<{tag}>" for tag in _STOCHASTIC)
        raise fail(f"<{node.tag}> is not supported", node.where, f"supported: {supported}")
    kind, limits = _STOCHASTIC[node.tag], node.child("Range")
    low, high = (_finite(limits, "lowerLimit"), _finite(limits, "upperLimit")) if limits else (None, None)
    if kind == "uniform":
        limits = node.need("Range")
        numbers = {"low": _finite(limits, "lowerLimit"), "high": _finite(limits, "upperLimit")}
    else:
        numbers = {"mean": _finite(node, "expectedValue"), "sd": math.sqrt(max(_finite(node, "variance"), 0.0))}
    made = Distribution(kind, numbers)
    flaw = made.flaw or ("the range is empty" if low is not None and high is not None and low >= high else "")
    if flaw:
        raise fail(f"<{node.tag}>: {flaw}", node.where)
    return Uncertain(made, low, high)
