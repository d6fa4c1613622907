"""Several benches in one study: what they have to share, and the condition that tells them apart."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from dse.domain.bench import Figure, Metric, TestBench
from dse.domain.sampler import DesignVariable, Role
from dse.domain.study import TESTBENCH
from dse.errors import Location
from dse.units import DIMENSIONLESS


def bench_variable(benches: Sequence[TestBench], where: Location | None) -> DesignVariable:
    """The condition that counts *benches* from 0."""
    last, names = len(benches) - 1, tuple(bench.name for bench in benches)
    values = tuple(float(number) for number in range(len(benches)))
    return DesignVariable(
        TESTBENCH,
        0.0,
        float(last),
        len(benches),
        0.0,
        DIMENSIONLESS,
        "test bench",
        where,
        values=values,
        role=Role.CONDITION,
        labels=names,
    )


def differences(one: TestBench, other: TestBench) -> Iterator[str]:
    """In what *other* is not as *one* is, though benches of one study have to be: a run's results are one row."""
    if one.design != other.design:
        yield f"'{other.name}' is a bench of design space '{other.design.name}', '{one.name}' of '{one.design.name}'"
    mine, theirs = ({metric.name: (_unit(metric), metric.unit.symbol) for metric in b.metrics} for b in (one, other))
    for name in sorted({*mine} ^ {*theirs}):
        having, lacking = (one, other) if name in mine else (other, one)
        yield f"'{having.name}' has the metric '{name}', '{lacking.name}' has none of that name"
    for name in sorted({*mine} & {*theirs}):
        if mine[name] != theirs[name]:
            yield f"the metric '{name}' has another unit in '{other.name}': {theirs[name][1]}, not {mine[name][1]}"
    bounds = [{r.name: (r.metric, r.at_most, r.at_least) for r in bench.requirements} for bench in (one, other)]
    for name in sorted({*bounds[0]} | {*bounds[1]}):
        if bounds[0].get(name) != bounds[1].get(name):
            yield f"the requirement '{name}' is not the same in '{one.name}' and '{other.name}'"
    drawn = {figure.name: _shown(figure) for figure in one.figures}
    for figure in other.figures:
        if drawn.get(figure.name, _shown(figure)) != _shown(figure):
            yield f"the figure '{figure.name}' shows something else in '{other.name}'"
    if one.simulation.record_every != other.simulation.record_every:
        yield f"'{other.name}' records at other times than '{one.name}' (record_every)"
    if one.simulation.check_step != other.simulation.check_step:
        yield f"one of '{one.name}' and '{other.name}' has check_step, the other has not"


def _unit(metric: Metric) -> object:
    return metric.unit.dimension if metric.unit.symbol else None


def _shown(figure: Figure) -> object:
    return figure.current, figure.target, figure.unit.symbol
