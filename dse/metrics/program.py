"""Metrics and requirements → a program that every run goes through. Names and units are checked here, once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext, suppress

from dse.domain.bench import Metric, Requirement
from dse.domain.component import Type
from dse.domain.expression import Expression, Name
from dse.errors import Problems, closest, fail, raise_if_any
from dse.expression import Sort, descend, error_in, require_number, require_truth
from dse.metrics.catalogue import FUNCTIONS, Function
from dse.metrics.compiler import FollowUpError, MetricCompiler
from dse.metrics.machine import MetricProgram, Register, RequirementCheck, judge_failed
from dse.units import describe, si_unit

__all__ = ["MetricProgram", "compile_metrics", "judge_failed"]


def compile_metrics(
    metrics: Sequence[Metric],
    requirements: Sequence[Requirement],
    types: Mapping[str, Type],
    signals: frozenset[str],
    functions: Mapping[str, Function] = FUNCTIONS,
) -> MetricProgram:
    """Compile a bench's metrics and requirements.

    *types* gives the type of every name that may be used (``world.speed``, ``controller.set_speed``);
    *signals* are those of them that are waveforms, the others keep one value for a run. *functions* can be used besides
    those of installed packages. Raises DseError with every unknown name, wrong unit and misused function, located.
    """
    compiler = MetricCompiler(types, signals, [metric.name for metric in metrics], functions, timed=True)
    problems = Problems()
    checks: list[RequirementCheck] = []
    for metric in metrics:
        with problems, suppress(FollowUpError):
            _compile_metric(compiler, metric)
        compiler.reached.add(metric.name)
    for requirement in requirements:
        with problems, suppress(FollowUpError):
            checks.append(_compile_requirement(compiler, requirement))
    raise_if_any(problems)
    return _program(compiler, {metric.name: metric for metric in metrics}, checks)


def _program(
    compiler: MetricCompiler, metrics: Mapping[str, Metric], checks: Sequence[RequirementCheck]
) -> MetricProgram:
    dimensions = {name: sort.dimension for name, (sort, _) in compiler.metrics.items()}
    return MetricProgram(
        tuple(name for name in compiler.inputs if name in compiler.signals),
        tuple(name for name in compiler.inputs if name not in compiler.signals),
        {
            name: metrics[name].unit if metrics[name].unit.symbol else si_unit(dimension)
            for name, dimension in dimensions.items()
        },
        compiler.inputs,
        tuple((register, value) for value, register in compiler.literals.items()),
        tuple(compiler.instructions.values()),
        {name: register for name, (_, register) in compiler.metrics.items()},
        tuple(checks),
        compiler.size,
    )


def _compile_metric(compiler: MetricCompiler, metric: Metric) -> None:
    expression = metric.expression
    with compiler.window(metric.over) if metric.over else nullcontext():
        sort, register = compiler.compile(expression, expression.root)
        register = compiler.of_window(register)
    if metric.over and not compiler.varies:
        what, advice = f"'over' has no effect: '{metric.name}' uses no waveform", "move it to the metrics that it uses"
        raise error_in(expression, expression.root.span, what, advice)
    require_number(expression, expression.root, sort)
    if sort.varies:
        what, advice = "a metric is one number, this is a waveform", "take its minimum, maximum, final or mean"
        raise error_in(expression, expression.root.span, what, advice)
    if metric.unit.symbol and metric.unit.dimension != sort.dimension:
        what = f"'{metric.name}' is {sort} and cannot be shown in {metric.unit}"
        raise error_in(expression, expression.root.span, what, f"it is computed in {_si(sort)}")
    compiler.metrics[metric.name] = sort, register


def _compile_requirement(compiler: MetricCompiler, requirement: Requirement) -> RequirementCheck:
    name, where = requirement.metric, requirement.where
    if name not in compiler.metrics:
        if name in compiler.names:
            raise FollowUpError
        what = f"requirement '{requirement.name}': unknown metric '{name}'"
        raise fail(what, where, closest(name, compiler.names))
    if requirement.at_most is None and requirement.at_least is None:
        what = f"requirement '{requirement.name}' has no bound"
        raise fail(what, where, "give at_most or at_least")
    sort, register = compiler.metrics[name]
    if not requirement.of and requirement.unit.dimension != sort.dimension:
        bound = describe(requirement.unit.dimension)
        what = f"requirement '{requirement.name}': '{name}' is {sort}, its bound is {bound}"
        raise fail(what, where, f"give the bound in {_si(sort)}")
    condition = requirement.exercised_when
    if condition is None:
        return RequirementCheck(requirement.name, requirement.at_most, requirement.at_least, register, None)
    exercised = _compile_condition(compiler, condition)
    spoken_of = [node.path for node in descend(condition.root) if isinstance(node, Name)]
    metrics = tuple(compiler.metrics[path][1] for path in spoken_of if path in compiler.metrics)
    return RequirementCheck(requirement.name, requirement.at_most, requirement.at_least, register, exercised, metrics)


def _compile_condition(compiler: MetricCompiler, expression: Expression) -> Register:
    sort, register = compiler.compile(expression, expression.root)
    require_truth(expression, expression.root, sort)
    if sort.varies:
        what, advice = "a condition on a run is true or false, this varies", "write duration(…) > 0 s"
        raise error_in(expression, expression.root.span, what, advice)
    return register


def _si(sort: Sort) -> str:
    return str(si_unit(sort.dimension)) or "no unit, or %"
