"""What every function of metrics must do."""

from __future__ import annotations

import math
import pickle
import warnings
from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray

from dse.domain.bench import Metric
from dse.domain.component import Kind, Type
from dse.errors import DseError, Location
from dse.expression import parse_expression
from dse.metrics import FUNCTIONS, Argument, Function, MetricProgram, Wants, compile_metrics
from dse.units import DIMENSIONLESS, parse_unit

Floats = NDArray[np.float64]

_OTHER = "mol"
"""A unit that no argument of another unit can take."""


_UNITLESS = "an argument without a unit has that of the first: give a plain number the unit '', a time 's'"


class MetricSuite:
    """Subclass it in your tests and give your *function* and its *name*:
    ``class TestMine(MetricSuite): name, function = "peak_to_peak", PEAK_TO_PEAK``.

    A function that depends on when the simulation began says ``shifts_with_time = True``.
    """

    name: str
    function: Function
    shifts_with_time = False

    def test_its_units_are_accepted(self) -> None:
        """What it declares compiles, and its result is a metric."""
        self._compiled()

    def test_other_units_are_refused(self) -> None:
        """Each argument that has a unit takes no other; the message names it."""
        for position, argument in enumerate(self.function.arguments):
            free = argument.any_unit or argument.wants is Wants.CONDITION or (argument.unit is None and position == 0)
            if free:
                continue
            with pytest.raises(DseError, match=argument.name):
                self._compiled(wrong=argument.name)

    def test_it_gives_a_number(self) -> None:
        """For waveforms of a step that overshoots and settles; of a complex one the imaginary part would be lost."""
        with warnings.catch_warnings():
            warnings.simplefilter("error", np.exceptions.ComplexWarning)
            assert isinstance(self._value(), float)

    def test_the_same_waveforms_give_the_same_number(self) -> None:
        """To the last bit, so that a run can be made again."""
        assert _alike(self._value(), self._value())

    def test_what_is_undefined_stays_undefined(self) -> None:
        """NaN in gives NaN, no exception and no number."""
        if any(argument.wants is Wants.CONDITION for argument in self.function.arguments):
            pytest.skip("a comparison with NaN is false, not undefined")
        assert math.isnan(self._value(defined=0)), "a number was made of nothing"

    def test_a_waveform_that_becomes_undefined_raises_nothing(self) -> None:
        """As the gap to a vehicle that is out of sight."""
        self._value(defined=30)

    @pytest.mark.parametrize("rows", [1, 2, 3])
    def test_a_few_rows_are_enough(self, rows: int) -> None:
        """A run may end at once; what cannot be told from it is NaN."""
        self._value(rows=rows)

    def test_a_constant_waveform_raises_nothing(self) -> None:
        """Nothing moves in many a run."""
        self._value(still=True)

    def test_it_does_not_matter_when_the_run_began(self) -> None:
        """Shifted in time, the same waveforms give the same number, up to rounding."""
        if self.shifts_with_time:
            pytest.skip("the function depends on when the simulation began")
        shifted, here = self._value(start=64.0), self._value()
        assert _alike(shifted, here) or math.isclose(shifted, here, rel_tol=1e-9, abs_tol=1e-9)

    def test_it_does_not_matter_in_which_unit_the_first_argument_is(self) -> None:
        """Scaled with all that has its unit, it scales the result as the result's dimension says.

        That fails where a constant that is a plain number or a time is declared without its unit.
        """
        if self.function.arguments[0].unit is not None:
            pytest.skip("the first argument has a unit of its own, in which there may be limits")
        power = dict(self.function.result(parse_unit("m").dimension)).get("length", 0)
        for scale in (0.5, 2.0):
            scaled, wanted = self._value(scale=scale), self._value() * scale ** float(power)
            assert _alike(scaled, wanted) or math.isclose(scaled, wanted, rel_tol=1e-9, abs_tol=1e-9), _UNITLESS

    def test_it_survives_the_way_to_a_worker(self) -> None:
        """Programs are pickled; the function is found again by its name."""
        program = self._compiled()
        assert pickle.loads(pickle.dumps(program)).instructions == program.instructions  # noqa: S301  # made right here

    def _compiled(self, wrong: str = "") -> MetricProgram:
        """The function as a metric, its constants and waveforms ports of their own; *wrong* has an unfit unit."""
        own = self.function.arguments[0].unit or "m"
        types = {f"a.{argument.name}": _type(argument, own, wrong) for argument in self.function.arguments}
        constants = {f"a.{a.name}" for a in self.function.arguments if a.wants is Wants.CONSTANT}
        call = f"{self.name}({', '.join(_written(argument) for argument in self.function.arguments)})"
        if self.function.varies:
            call = f"final({call})"
        metric = Metric("m", parse_expression(call, Location("metric")), DIMENSIONLESS)
        functions: Mapping[str, Function] = {**FUNCTIONS, self.name: self.function}
        return compile_metrics([metric], (), types, frozenset(types) - constants, functions)

    def _value(
        self, rows: int = 101, defined: int = 101, start: float = 0.0, *, still: bool = False, scale: float = 1.0
    ) -> float:
        """Its value over *rows* of 0.1 s; beyond *defined* rows everything is NaN. Nothing given can be written to.

        What has the unit of the first argument is multiplied by *scale*, a power of two.
        """
        program = self._compiled()
        time: Floats = np.arange(rows, dtype=np.float64) * 0.1
        wave: Floats = np.ones(rows) if still else 1 - np.exp(-time) * np.cos(3 * time)
        wave[defined:] = math.nan
        time += start
        scales = {
            f"a.{each.name}": 1.0
            if each.wants is Wants.CONDITION or each.unit is not None or (each.any_unit and position)
            else scale
            for position, each in enumerate(self.function.arguments)
        }
        waves = {name: wave * scales[name] for name in program.signals}
        for array in (time, *waves.values()):
            array.flags.writeable = False
        constants = {name: scales[name] if defined else math.nan for name in program.constants}
        values, _ = program.evaluate(time, waves, constants)
        return values["m"]


def _type(argument: Argument, own: str, wrong: str) -> Type:
    unit = "m" if argument.wants is Wants.CONDITION else own if argument.unit is None else argument.unit
    return Type(Kind.REAL, parse_unit(_OTHER if argument.name == wrong else unit))


def _written(argument: Argument) -> str:
    return f"a.{argument.name} > 0.5 m" if argument.wants is Wants.CONDITION else f"a.{argument.name}"


def _alike(one: float, other: float) -> bool:
    return one == other or (math.isnan(one) and math.isnan(other))
