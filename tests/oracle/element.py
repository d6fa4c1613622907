"""What one element does, in plain Python, with values by label as they are outside; element.h is the same in C."""

from __future__ import annotations

import ctypes
from collections.abc import Collection, Iterable, Mapping
from math import isfinite
from types import TracebackType

from dse.cosim.binding.abilities import Ability, takes_slopes
from dse.cosim.binding.calls import text_type_of
from dse.cosim.failure.fmu_messages import of_value
from dse.cosim.failure.run_failed import StopReason
from dse.cosim.tables.starts import starts_of
from dse.cosim.wiring.wiring import groups_by_type, is_discrete_input, moves_within_steps
from dse.domain.fmu import FmiInterface, Variable
from dse.domain.system import Element, SystemStructure
from oracle.conversion import inside, outside
from oracle.exchange import ReferenceExchange
from oracle.instance import Instance
from oracle.steps import make_step

Value = float | bytes
"""A number, or a string (encoded in UTF-8) or binary."""

_NO_START: Mapping[str, float] = {}
_NO_SLOPES: Mapping[str, float] = {}


class ReferenceElement:
    """An instance of *element*'s FMU, freed by :meth:`close` or at the end of a ``with`` block.

    Labels are without the element's name. An FMU for model exchange is integrated by the kernel, all else is plain
    Python. Every method raises RunFailed if the FMU reports an error, with the *time* it is told.
    """

    def __init__(self, element: Element, library: ctypes.CDLL) -> None:
        self.element = element
        self._variables = element.model.variables
        self._moving: tuple[Variable, ...] = ()
        self._written: dict[str, Value] = {}
        self._slopes: Mapping[str, float] = {}
        self._began = 0.0
        self._given: dict[str, bytes] = {}
        self._kept_given: dict[str, bytes] = {}
        self._stop = 0.0
        self._is_running = self._is_initialized = False
        self._state = ctypes.c_void_p()
        self._kept_event = 0.0
        moving = [v for v in element.inputs if self._can_move(v)]
        intermediate = [v.reference for v in self._by_type(moving)]
        self.instance = Instance(element.name, element.model, library, between=self._move_on, intermediate=intermediate)
        self._exchange: ReferenceExchange | None = None
        if element.model.interface is FmiInterface.MODEL_EXCHANGE:
            self._exchange = ReferenceExchange(element, library, self.instance.handle, lambda: self.instance.log)
        self.takes_slopes = takes_slopes(element.model, self.instance.able)

    def __enter__(self) -> ReferenceElement:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free the state that is kept and the instance, once; nothing happens after a fatal error."""
        if self._state.value is not None and not self.instance.fatal:
            self.instance.forget(self._state)
        self._state = ctypes.c_void_p()
        self.instance.close()

    def reset(self) -> None:
        """Back to what it was when it was new."""
        self.instance.reset()

    # ---- initialization ----

    def set_up(self, stop: float, start: Mapping[str, float] = _NO_START) -> None:
        """Into initialization mode; *start* are start values besides and before those of the element."""
        self._stop, self._given, self._slopes = stop, {}, {}
        self._is_running = self._is_initialized = False
        self.instance.set_up(stop)
        self._set_starts(start)
        if self.element.model.version > 1:
            self.instance.enter_initialization(stop)
            self._is_initialized = True

    def leave_initialization(self) -> None:
        """Into step mode."""
        self._initialize_late()
        if self._exchange:
            self._exchange.start()
        else:
            self.instance.exit_initialization()
        self._is_running = True

    def _initialize_late(self) -> None:
        """FMI 1 has no initialization mode: an FMU is given the inputs that are known and then initialized."""
        if not self._is_initialized:
            self.instance.enter_initialization(self._stop)
            self._is_initialized = self._is_running = True

    def _set_starts(self, start: Mapping[str, float]) -> None:
        element = self.element
        lone = SystemStructure(element.name, (element,), ())
        starts = starts_of(lone, [f"{element.name}.{label}" for label in start])
        values = {label: starts.values[position] for label, position in starts.positions.items()}
        values |= {f"{element.name}.{label}": value for label, value in start.items()}
        for groups, structural in ((starts.configuration[0], True), (starts.groups[0], False)):
            if structural and groups:
                self.instance.enter_configuration()
            for group in groups:
                for variable in group.variables:
                    given = [values[f"{element.name}.{label}"] for label in variable.labels]
                    self.instance.give_numbers(variable, self._inside(variable, given, None), None)
            if structural and groups:
                self.instance.exit_configuration()
        for group in starts.texts[0]:
            texts = iter(starts.own_texts[at] for at in group.positions)
            for variable in group.variables:
                self.instance.give_texts(variable, [next(texts) for _ in variable.labels], None)

    # ---- values ----

    def read(self, names: Collection[str], time: float | None) -> dict[str, Value]:
        """Values of the outputs called *names* (variables), by label; *time* is None during initialization."""
        self._initialize_late()
        found: dict[str, Value] = {}
        for name in names:
            variable = self._variables[name]
            values: Iterable[Value]
            if text_type_of(variable, self.element.model.version) is None:
                values = self._outside(variable, self.instance.numbers(variable, time), time)
            else:
                values = self.instance.texts(variable, time)
            found |= zip(variable.labels, values, strict=True)
        return found

    def check_finite(self, values: Mapping[str, float], time: float | None) -> None:
        """RunFailed if one of the *values* for inputs, by label, is not finite."""
        for label, value in values.items():
            if not isfinite(value):
                variable = next(v for v in self.element.inputs if label in v.labels)
                raise self.instance.unfit(variable, label, value, time)

    def write(self, values: Mapping[str, Value], time: float | None) -> None:
        """Give the element *values* of inputs by label, of arrays all; discrete ones that change are an event."""
        self._written |= values
        named = [v for v in self.element.inputs if v.labels[0] in values]
        has_events = Ability.HAS_EVENTS in self.instance.able
        discrete = [v for v in named if has_events and is_discrete_input(v, self.element.model)]
        late = discrete if self._is_running else []
        for variable in named:
            if variable not in late:
                self._give(variable, time)
        if not self._is_running:
            self._given |= {v.name: self._bits(v, time) for v in discrete}
        changed = [v for v in late if self._given.get(v.name) != self._bits(v, time)]
        if not changed:
            return
        self.instance.enter_event_mode(time)
        for variable in changed:
            self._give(variable, time)
            self._given[variable.name] = self._bits(variable, time)
        self.instance.leave_event_mode(time)

    def _give(self, variable: Variable, time: float | None) -> None:
        if text_type_of(variable, self.element.model.version) is None:
            self.instance.give_numbers(variable, self._inside(variable, self._numbers(variable), time), time)
        else:
            self.instance.give_texts(variable, self._texts(variable), time)

    def _bits(self, variable: Variable, time: float | None) -> bytes:
        """What tells one value of a discrete input from another."""
        if text_type_of(variable, self.element.model.version) is not None:
            return b"".join(len(text).to_bytes(8, "big") + text for text in self._texts(variable))
        values = self._inside(variable, self._numbers(variable), time)
        return bytes(self.instance.narrowed(variable, values, time))

    def _numbers(self, variable: Variable) -> list[float]:
        return [float(self._written[label]) for label in variable.labels]

    def _texts(self, variable: Variable) -> list[bytes]:
        values = (self._written[label] for label in variable.labels)
        return [value if isinstance(value, bytes) else str(value).encode() for value in values]

    def _inside(self, variable: Variable, values: Iterable[float], time: float | None) -> list[float]:
        conversion = self.element.conversions.get(variable.name)
        found = []
        for label, value in zip(variable.labels, values, strict=True):
            inner = inside(conversion, value)
            if inner is None:
                what = of_value(StopReason.NO_ITEM_INPUT, f"{self.element.name}.{label}", time, value)
                raise self.instance.failure(self.instance.accessor("Set", variable), time, what)
            if isfinite(value) and not isfinite(inner):
                raise self.instance.unfit(variable, label, inner, time)
            found.append(inner)
        return found

    def _outside(self, variable: Variable, values: Iterable[float], time: float | None) -> list[float]:
        conversion = self.element.conversions.get(variable.name)
        found = []
        for label, value in zip(variable.labels, values, strict=True):
            outer = outside(conversion, value)
            if outer is None:
                what = of_value(StopReason.NO_ITEM, f"{self.element.name}.{label}", time, value)
                raise self.instance.failure(self.instance.accessor("Get", variable), time, what)
            found.append(outer)
        return found

    # ---- steps ----

    def step(
        self, time: float, step: float, slopes: Mapping[str, float] = _NO_SLOPES, may_roll_back: bool = False
    ) -> None:
        """From *time* over *step* (seconds), inputs as they were written, or on along *slopes* by label, per second."""
        had_slopes = bool(self._slopes)
        self._slopes, self._began = (slopes if self.takes_slopes else {}), time
        if Ability.TAKES_DERIVATIVES in self.instance.able and (self._slopes or had_slopes):
            self._tell_slopes(time)
        if self._exchange:
            move = self._move_by if self._slopes else None
            self._exchange.step(time, step, move, may_roll_back=may_roll_back)
        else:
            make_step(self.instance, time, step, may_roll_back=may_roll_back)

    def terminate(self, time: float) -> None:
        """At the end of a run."""
        self.instance.terminate(time)

    def save(self) -> None:
        """Keep the state it is in, instead of any it kept before."""
        self.instance.save(self._state, None)
        self._kept_event = self.instance.next_event
        self._kept_given = dict(self._given)
        if self._exchange:
            self._exchange.save()

    def restore(self) -> None:
        """Back to the state it kept."""
        self.instance.restore(self._state, None)
        self.instance.next_event = self._kept_event
        self._given = dict(self._kept_given)
        if self._exchange:
            self._exchange.restore()

    def serialized(self) -> bytes:
        """The state it keeps, as bytes."""
        return self.instance.serialized(self._state)

    def deserialize(self, content: bytes) -> None:
        """Make the state that *content* holds the one it keeps."""
        if self._state.value is not None:
            self.instance.forget(self._state)
        self._state = ctypes.c_void_p()
        self.instance.deserialize(content, self._state)

    def _tell_slopes(self, time: float) -> None:
        moving = [v for v in self.element.inputs if self._can_move(v) and v.name in self._written]
        values = [self._slopes.get(v.name, 0.0) / self._factor(v) for v in moving]
        if moving:
            self.instance.set_derivatives(moving, values, time)

    def _move_on(self, time: float) -> None:
        """Set the inputs that have slopes to what they are at *time*, within a step."""
        self._move_by(time - self._began)

    def _move_by(self, elapsed: float) -> None:
        time = self._began
        for variable in self.element.inputs:
            if not self._can_move(variable) or not any(label in self._slopes for label in variable.labels):
                continue
            values = zip(variable.labels, self._numbers(variable), strict=True)
            moved = [value + self._slopes.get(label, 0.0) * elapsed for label, value in values]
            self.check_finite(dict(zip(variable.labels, moved, strict=True)), time)
            self.instance.give_numbers(variable, self._inside(variable, moved, time), time)

    def _factor(self, variable: Variable) -> float:
        conversion = self.element.conversions.get(variable.name)
        return 1.0 if conversion is None else conversion.factor

    def _can_move(self, variable: Variable) -> bool:
        conversion = self.element.conversions.get(variable.name)
        return moves_within_steps(variable, self.element.model) and not (conversion and conversion.items)

    def _by_type(self, variables: Iterable[Variable]) -> list[Variable]:
        return [variable for group in groups_by_type(self.element, variables) for variable in group.variables]
