"""Writes test benches without requirements as YAML that reads back as the same."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any

from dse.domain.bench import Simulation
from dse.domain.component import Type, Value
from dse.errors import DseError
from dse.formats import write_file, write_name, write_text, write_value
from dse.units import Unit, coherent


def write_bench(
    name: str,
    title: str,
    design: str,
    parameters: Mapping[str, tuple[Value, Type]],
    simulation: Simulation,
    metrics: Mapping[str, tuple[str, str]],
) -> str:
    """A file of ``testbenches/``: the *design* with *parameters* (SI, by ``part.port``), simulated and recorded.

    *metrics* are expressions with their unit, by name. The simulation's method is the plain one. Raises DseError for a
    value that its unit cannot say.
    """
    data: dict[str, Any] = {"testbench": write_name(name)}
    if title:
        data["title"] = write_text(title)
    data["design"] = write_name(design)
    if parameters:
        data["parameters"] = {end: _value(value, type_) for end, (value, type_) in parameters.items()}
    times = {"stop": simulation.stop, "step": simulation.step, "record_every": simulation.record_every}
    data["simulation"] = {key: f'"{seconds!r} s"' for key, seconds in times.items()}
    if simulation.tolerance is not None:
        data["simulation"]["tolerance"] = repr(simulation.tolerance)
    if simulation.record:
        data["simulation"]["record"] = [write_name(signal) for signal in simulation.record]
    if metrics:
        data["metrics"] = {metric: _metric(*said) for metric, said in metrics.items()}
    return write_file(data)


def _metric(expression: str, unit: str) -> str:
    text = write_text(expression)
    return f"{{expression: {text}, unit: {write_text(unit)}}}" if unit else text


def _value(value: Value, type_: Type) -> str:
    unit = type_.unit
    try:
        text = write_value(value, unit, None)
    except DseError:  # no floating-point number in this unit is the value to the last bit
        unit = coherent(unit) if coherent(unit).symbol else unit
        text = write_value(value, unit, None) if unit.is_coherent else _in_full(value, unit)
    return write_text(f"{text} {unit}") if unit.symbol else text


def _in_full(value: Value, unit: Unit) -> str:
    """With more digits than floating-point numbers have."""
    exact = (Fraction(value) - unit.offset) / unit.factor
    return str(Decimal(exact.numerator) / Decimal(exact.denominator))
