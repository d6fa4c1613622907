"""Two components of one interface on the same inputs, side by side: how far their outputs are apart."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dse.api.studies.single_run import alone
from dse.domain.bench import Simulation, TestBench, TestComponent
from dse.domain.component import Causality, Component, Interface, Kind, Port, Type, Value
from dse.domain.design import Compound, Connection, DesignSpace
from dse.domain.time_series import Interpolation, Missing, Outside, Series, TableFile, TimeSeriesSource
from dse.errors import Location, closest, fail
from dse.fmu import build, open_component
from dse.formats import shown
from dse.loading import Workspace
from dse.scratch import ScratchFolder
from dse.testbench import bench_study

if TYPE_CHECKING:
    from numpy.typing import NDArray

_STEP = 0.01
_MOST_STEPS = 100_000
_FINEST = 1e-5
_FIRST, _SECOND, _INPUTS = "first", "second", "inputs"


@dataclass(frozen=True, slots=True)
class Apart:
    """How far an *output* is apart at most: *absolute* (SI), and *relative* to the largest value that it has.

    At the *time* (s) of the largest difference it has the *values* of both. One that never *moves* in either shows
    little: other inputs may be needed.
    """

    output: str
    unit: str
    absolute: float
    relative: float
    time: float
    values: tuple[float, float]
    moves: bool


@dataclass(frozen=True, slots=True)
class Pair:
    """Two components by *names*, compared in so many *steps* of *step* s.

    *parameters* are those that do not begin alike, with both values; None for one that a component does not have.
    """

    names: tuple[str, str]
    step: float
    steps: int
    tolerance: float
    outputs: tuple[Apart, ...]
    parameters: Mapping[str, tuple[Value | None, Value | None]]

    @property
    def is_within(self) -> bool:
        """Whether no output is apart by more than the tolerance, relative to its largest value."""
        return all(each.relative <= self.tolerance for each in self.outputs)


def compare_components(
    first: str,
    second: str,
    *,
    inputs: Mapping[str, float | tuple[float, float] | Column] | None = None,
    steps: int = 1000,
    step: float | None = None,
    tolerance: float = 1e-12,
    fmi: int = 2,
    near: str | Path = ".",
) -> Pair:
    """Run two components of the workspace around *near* on the same inputs, and report how their outputs differ.

    Each input moves in steps, then as a sum of sines, between values that *inputs* gives (SI), else between -10 and 10;
    or it is constant, or a column of a file. *step* (s) is the largest that both sample times are multiples of, else
    10 ms. Raises DseError if they implement different interfaces, or if one cannot be built or fails in a step.

    >>> dse.compare_components("pd_acc", "pd_acc_coded", inputs={"speed": (0, 40)}).is_within
    True
    """
    space = Workspace.around(Path(near))
    pair = space.component(first), space.component(second)
    _check(pair)
    ports = pair[0].interface.ports
    fed = [port for port in ports if port.causality is Causality.INPUT]
    told = [port for port in ports if port.causality is Causality.OUTPUT]
    given = _given(inputs or {}, fed)
    step = step or _common_step(pair, fmi)
    if not 1 <= steps <= _MOST_STEPS:
        raise fail(f"{steps} steps are not between 1 and {_MOST_STEPS:,}")
    with ScratchFolder() as scratch:
        bench = _bench(pair, fed, told, step, steps, Path(scratch), given)
        run, _ = alone(bench_study(bench), fmi)
    if run.waveforms is None or run.problem:
        raise fail(_named(run.problem, pair))
    time, values = run.waveforms.time, run.waveforms.values
    return Pair(
        (first, second),
        step,
        steps,
        tolerance,
        tuple(_apart(port, time, values[f"{_FIRST}.{port.name}"], values[f"{_SECOND}.{port.name}"]) for port in told),
        dict(_parameters(pair)),
    )


def pair_as_data(pair: Pair) -> dict[str, Any]:
    """For JSON."""
    return {
        "components": list(pair.names),
        "step": pair.step,
        "steps": pair.steps,
        "tolerance": pair.tolerance,
        "within": pair.is_within,
        "outputs": {
            each.output: {
                "unit": each.unit,
                "absolute": each.absolute,
                "relative": each.relative,
                "time": each.time,
                "values": list(each.values),
                "moves": each.moves,
            }
            for each in pair.outputs
        },
        "parameters": {name: list(values) for name, values in pair.parameters.items()},
    }


def _check(pair: tuple[Component, Component]) -> None:
    one, other = pair
    if one.name == other.name:
        raise fail(f"'{one.name}' is compared with itself", hint="name two components")
    if one.interface.name != other.interface.name:
        what = f"'{one.name}' implements '{one.interface.name}', '{other.name}' '{other.interface.name}'"
        raise fail(f"{what}: there is nothing to compare", other.where, "name two components of one interface")
    if not one.interface.ports:
        raise fail(f"'{one.name}' has no ports", one.where)
    for port in one.interface.ports:
        if not port.type.kind.is_number:
            raise fail(f"'{port.name}' is a {port.type.kind}: only numbers are compared", one.interface.where)


def _given(inputs: Mapping[str, float | tuple[float, float] | Column], ports: list[Port]) -> dict[str, Given]:
    known = {port.name: port for port in ports}
    found: dict[str, Given] = {}
    for name, value in inputs.items():
        if name not in known:
            raise fail(f"there is no input '{name}'", hint=closest(name, known))
        if isinstance(value, Column):
            found[name] = value
            continue
        low, high = value if isinstance(value, tuple) else (value, value)
        if not -1e300 < low <= high < 1e300:
            raise fail(f"'{name}' cannot move from {low:g} to {high:g}")
        is_whole = known[name].type.kind is not Kind.REAL
        if is_whole and (low % 1 or high % 1 or not 0 <= high - low < 2**31):
            raise fail(f"'{name}' is {known[name].type}: it moves between whole numbers")
        most = {Kind.ENUMERATION: len(known[name].type.items) - 1, Kind.BOOLEAN: 1}.get(known[name].type.kind)
        if most is not None and not 0 <= low <= high <= most:
            raise fail(f"'{name}' has the items 0 to {most}, not {low:g} to {high:g}")
        found[name] = low, high
    return found


def _common_step(pair: tuple[Component, Component], version: int) -> float:
    """The largest step that both sample times are multiples of. Raises DseError if that would be too small."""
    samples = {each.name: _sample_time(each, version) for each in pair}
    numbers = [Fraction(repr(sample)) for sample in samples.values() if sample]
    if not numbers:
        return _STEP
    below = lcm(*(number.denominator for number in numbers))
    step = float(Fraction(gcd(*(int(number * below) for number in numbers)), below))
    if step < _FINEST or step < min(map(float, numbers)) / 1000:
        told = " and ".join(f"'{name}' every {sample:g} s" for name, sample in samples.items())
        raise fail(f"{told}: no step fits both", hint="give one: --step 1ms")
    return step


def _sample_time(component: Component, version: int) -> float | None:
    """What its file says, else what the FMU does."""
    if component.source is not None and component.source.sample_time:
        return component.source.sample_time
    model = open_component(component, build(component, version=version))
    return model.fixed_step or model.experiment.step


def _bench(
    pair: tuple[Component, Component],
    fed: list[Port],
    told: list[Port],
    step: float,
    steps: int,
    folder: Path,
    given: Mapping[str, Given],
) -> TestBench:
    parts = [TestComponent(name, component, {}) for name, component in zip((_FIRST, _SECOND), pair, strict=True)]
    connections: list[Connection] = []
    if fed:
        parts.insert(0, TestComponent(_INPUTS, excitation(fed, given, step, steps, folder), {}))
        connections = [
            Connection(f"{_INPUTS}.{port.name}", f"{name}.{port.name}") for port in fed for name in (_FIRST, _SECOND)
        ]
    record = tuple(f"{name}.{port.name}" for port in told for name in (_FIRST, _SECOND))
    simulation = Simulation(steps * step, step, record, step)
    design = DesignSpace("nothing", Compound("nothing", {}))
    return TestBench("side by side", design, tuple(parts), tuple(connections), {}, simulation, (), ())


def _apart(port: Port, time: NDArray[np.float64], one: NDArray[np.float64], other: NDArray[np.float64]) -> Apart:
    gap = np.abs(one - other)
    at = int(np.argmax(gap))
    largest = float(np.max(np.abs([one, other])))
    moves = bool(np.ptp(one) or np.ptp(other))
    unit = str(port.type.unit) if port.type.kind is Kind.REAL else ""
    absolute, values = float(gap[at]), (float(one[at]), float(other[at]))
    return Apart(port.name, unit, absolute, absolute / (largest or 1.0), float(time[at]), values, moves)


def _parameters(pair: tuple[Component, Component]) -> Iterator[tuple[str, tuple[Value | None, Value | None]]]:
    one, other = ({each.name: each.start for each in component.parameters} for component in pair)
    for name in [*one, *(name for name in other if name not in one)]:
        values = one.get(name), other.get(name)
        if values[0] != values[1]:
            yield name, values


def _named(problem: str, pair: tuple[Component, Component]) -> str:
    for name, component in zip((_FIRST, _SECOND), pair, strict=True):
        problem = problem.replace(f"{name} ({component.name})", component.name).replace(
            f"{name}:", f"{component.name}:"
        )
    return problem


# Inputs that move a component: steps at first, then sines, the same each time.


_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
_HELD, _MORE_HELD = 20, 7
"""Steps that a level is held for, and by how many longer for each further input."""

_USUAL = {Kind.REAL: (-10.0, 10.0), Kind.INTEGER: (0.0, 10.0), Kind.BOOLEAN: (0.0, 1.0)}


@dataclass(frozen=True, slots=True)
class Column:
    """The *column* of a *file*, by heading or number from 1, in the unit that the file states, else in SI.

    >>> inputs = {"speed": dse.Column(Path("testbenches/wltc_like.csv"), "speed")}
    """

    file: Path
    column: str | int


Given = tuple[float, float] | Column
"""Between what an input moves (SI; twice the same for a constant), or where its values are."""


def excitation(ports: Sequence[Port], given: Mapping[str, Given], step: float, steps: int, folder: Path) -> Component:
    """What gives the inputs *ports* values for so many steps of *step* s; its table lies in *folder*."""
    where = Location("inputs")
    series: list[Series] = []
    columns: list[tuple[Port, list[float]]] = []
    table = TableFile(folder / "inputs.csv")
    for place, port in enumerate(ports):
        known = given.get(port.name)
        if isinstance(known, Column):
            file, column, between = TableFile(known.file), known.column, None
            if not known.file.is_file():
                raise fail(f"no such file: {shown(known.file)}", hint=f"it is to feed '{port.name}'")
        else:
            columns.append((port, [*_moves(place, port.type, known, steps)]))
            file, column, between = table, len(columns) + 1, Interpolation.PREVIOUS
        series.append(Series(port.name, file, column, "", between, Outside.HOLD, Missing.ERROR, where))
    if columns:
        table.path.write_text("\n".join(_lines(columns, step)) + "\n", encoding="utf-8")
    outputs = tuple(Port(port.name, Causality.OUTPUT, port.type) for port in ports)
    names = {port.name: f"u{place}" for place, port in enumerate(ports)}
    source = TimeSeriesSource(tuple(series), steps * step)
    return Component("inputs of both", Interface("inputs of both", outputs, where), source=source, names=names)


def _lines(columns: Sequence[tuple[Port, Sequence[float]]], step: float) -> Iterator[str]:
    units = [
        f" [{port.type.unit}]" if port.type.kind is Kind.REAL and str(port.type.unit) else "" for port, _ in columns
    ]
    yield ";".join(["time [s]", *(f"u{place}{unit}" for place, unit in enumerate(units))])
    for k, values in enumerate(zip(*(values for _, values in columns), strict=True)):
        # Half a step before it is asked for, so that rounding does not decide.
        yield ";".join(map(repr, ((k - 0.5) * step, *values)))


def _moves(place: int, type_: Type, between: tuple[float, float] | None, steps: int) -> Iterator[float]:
    low, high = (
        between or (0.0, len(type_.items) - 1.0) if type_.kind is Kind.ENUMERATION else between or _USUAL[type_.kind]
    )
    held, middle, half = _HELD + _MORE_HELD * place, (low + high) / 2, (high - low) / 2
    for k in range(steps + 1):
        level = (k // held + 1 + place) * _GOLDEN % 1.0
        if type_.kind is not Kind.REAL:
            yield low + math.floor(level * (high - low + 1))
        elif 2 * k < steps:
            yield low + level * (high - low)
        else:
            turn = 2 * math.pi * k / (3 * held)
            yield middle + half * (0.7 * math.sin(turn) + 0.3 * math.sin(math.sqrt(7) * turn))
