"""How an FMU is driven in the experiments: over its default experiment, with inputs that vary but never surprise."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass

from dse.domain.component import Kind
from dse.domain.fmu import FmuModel, Variable

MOST_STEPS = 200
_KNOT = 4
_DEFAULT_STOP = 1.0
_DEFAULT_STEPS = 100


@dataclass(frozen=True, slots=True)
class Excitation:
    """*steps* steps of *step* seconds; *strength* 1.0 varies inputs as usual, 0.0 holds them at their start values.

    Drives of another *seed* have other inputs, and other values of the parameters that may be changed.
    """

    step: float
    steps: int
    strength: float = 1.0
    seed: int = 0

    @property
    def stop(self) -> float:
        """When a run ends, in seconds."""
        return self.steps * self.step

    def inputs(self, model: FmuModel, k: float) -> dict[str, float]:
        """The values of all inputs at communication point *k*, by label; between two points *k* is no whole number."""
        return {
            label: self._value(variable, label, index, k)
            for variable in driven(model)
            for index, label in enumerate(variable.labels)
        }

    def parameters(self, model: FmuModel) -> dict[str, float]:
        """Other values of real parameters that have one, by label: none for seed 0, a little off for others."""
        if not self.seed:
            return {}
        return {
            label: value + 0.01 * self.strength * self._noise(label, 0) * abs(value)
            for variable in model.variables.values()
            if variable.kind is Kind.REAL and variable.causality == "parameter"
            for index, label in enumerate(variable.labels)
            if (value := start_of(variable, index))
        }

    def _value(self, variable: Variable, label: str, index: int, k: float) -> float:
        start = start_of(variable, index)
        if not self.strength:
            return start
        if variable.kind is Kind.REAL:
            # Straight lines between random points: neither constant nor a wall of jumps.
            knot, part = divmod(k / _KNOT, 1.0)
            wave = (1.0 - part) * self._noise(label, int(knot)) + part * self._noise(label, int(knot) + 1)
            return _within(start + self.strength * _scale(variable, start) * wave, variable)
        noise = self._noise(label, int(k) // _KNOT)
        if variable.kind is Kind.BOOLEAN:
            return float(noise > 0.0)
        if variable.items:
            values = sorted(variable.items.values())
            return float(values[int((noise + 1.0) / 2.0 * len(values))])
        if variable.kind is Kind.ENUMERATION:
            return start
        low = 0.0 if variable.fmi_type.startswith("U") else -math.inf
        return max(low, _within(start + round(3.0 * self.strength * noise), variable))

    def _noise(self, label: str, number: int) -> float:
        """In [-1, 1), from the names alone."""
        digest = hashlib.blake2b(f"{self.seed} {number} {label}".encode(), digest_size=8).digest()
        return (int.from_bytes(digest, "big") >> 11) / 2**52 - 1.0


def excitation_of(model: FmuModel) -> Excitation:
    """The usual drive: the default experiment's step, but not more than 200 of them."""
    experiment = model.experiment
    stop = experiment.stop - (experiment.start or 0.0) if experiment.stop is not None else _DEFAULT_STOP
    if not (math.isfinite(stop) and stop > 0.0):
        stop = _DEFAULT_STOP
    step = model.fixed_step or experiment.step or stop / _DEFAULT_STEPS
    if not (math.isfinite(step) and step > 0.0):
        step = stop / _DEFAULT_STEPS
    return Excitation(step, max(1, min(MOST_STEPS, round(stop / step))))


def driven(model: FmuModel) -> tuple[Variable, ...]:
    """The inputs that take numbers, but for addresses, and what is taken while a clock ticks: here none does."""
    inputs = (v for v in model.variables.values() if v.causality == "input" and v.kind is not None)
    return tuple(v for v in inputs if not v.is_clocked and v.name not in model.pointers)


def watched(model: FmuModel) -> tuple[Variable, ...]:
    """The outputs that are compared: all but clocks and what belongs to them; of binaries what they hold."""
    outputs = (v for v in model.variables.values() if v.causality == "output" and v.name not in model.pointers)
    return tuple(v for v in outputs if not (v.timing or v.is_clocked))


def start_of(variable: Variable, index: int = 0) -> float:
    """The start value of a number, 0 if it has none."""
    if not variable.start:
        return 0.0
    text = variable.start[index if len(variable.start) > index else 0].strip()
    if text in ("true", "false"):
        return float(text == "true")
    try:
        return float(text)
    except ValueError:
        return 0.0


def _scale(variable: Variable, start: float) -> float:
    if variable.minimum is not None and variable.maximum is not None:
        width = variable.maximum - variable.minimum
        if math.isfinite(width):
            return width / 2.0
    return abs(variable.nominal) if variable.nominal else max(1.0, abs(start))


def _within(value: float, variable: Variable) -> float:
    low = -math.inf if variable.minimum is None else variable.minimum
    high = math.inf if variable.maximum is None else variable.maximum
    return min(max(value, low), high)
