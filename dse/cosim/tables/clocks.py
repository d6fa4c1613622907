"""Clocks as the kernel has them (plan.h)."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dse.cosim.binding import plan_layout as layout
from dse.cosim.binding.abilities import Ability
from dse.cosim.binding.calls import Call, function_name
from dse.cosim.binding.library import about, address
from dse.cosim.tables.tables import Tables
from dse.cosim.wiring.clocks import Act, ClockGroup, ClockStep, WiredClock
from dse.domain.fmu import ClockKind, Timing

_KINDS = list(ClockKind)
_EVENTS = (Call.ENTER_EVENT_MODE, Call.UPDATE_DISCRETE_STATES, Call.ENTER_STEP_MODE)


class CompiledClocks:
    """The clocks of *tables*' system; owns all memory it points into.

    *operation* makes the kernel's operation of a step that reads or writes. *counts* are columns that record the ticks
    of a clock (True) or the bytes of a step, and its number. Raises DseError if an FMU lacks a function.
    """

    def __init__(
        self,
        tables: Tables,
        operation: Callable[[ClockStep], layout.Operation],
        counts: Sequence[tuple[int, bool, int]] = (),
    ) -> None:
        self._tables, self._operation = tables, operation
        self._kept: list[Any] = []
        wiring = tables.wiring
        clocks = wiring.clocks
        self._at = {name: position for position, name in enumerate(wiring.values)}
        self._clocks = (layout.Clock * len(clocks.clocks))(*map(self._clock, clocks.clocks))
        self._steps = (layout.ClockStep * len(clocks.steps))(*map(self._step, clocks.steps))
        self._groups = (layout.ClockGroup * len(clocks.groups))(*map(self._group, clocks.groups))
        self._ticking = (layout.Ticking * len(wiring.system.elements))()
        group_of = np.full(len(wiring.system.elements), -1, np.int32)
        for number, group in enumerate(clocks.groups):
            group_of[list(group.elements)] = number
        self._group_of = group_of
        self._columns = (layout.CountColumn * len(counts))(*(self._column(*each) for each in counts))

    def enter(self, plan: layout.Plan) -> None:
        """Let *plan* point here."""
        plan.groups, plan.n_groups = ctypes.addressof(self._groups), len(self._groups)
        plan.group_of = int(self._group_of.ctypes.data)
        plan.clocks, plan.clock_steps = ctypes.addressof(self._clocks), ctypes.addressof(self._steps)
        plan.ticking = ctypes.addressof(self._ticking)
        plan.count_columns, plan.n_count_columns = ctypes.addressof(self._columns), len(self._columns)

    def _column(self, column: int, is_clock: bool, number: int) -> layout.CountColumn:
        array, field = (self._clocks, layout.Clock.count) if is_clock else (self._steps, layout.ClockStep.bytes)
        return layout.CountColumn(column, ctypes.addressof(array[number]) + field.offset)

    def _clock(self, clock: WiredClock) -> layout.Clock:
        variable = clock.variable
        timing = variable.timing or Timing(ClockKind.TRIGGERED)
        asks = variable.is_timed and not (timing.is_told and timing.kind is not ClockKind.TRIGGERED)
        ways = (Call.GET_INTERVAL_FRACTION, Call.GET_SHIFT_FRACTION)
        if not timing.has_fractions:
            ways = (Call.GET_INTERVAL_DECIMAL, Call.GET_SHIFT_DECIMAL)
        shifts = timing.kind in (ClockKind.FIXED, ClockKind.TUNABLE)
        return layout.Clock(
            element=clock.element,
            reference=variable.reference,
            kind=_KINDS.index(timing.kind),
            access=self._function(clock, Call.SET_CLOCK if variable.causality == "input" else Call.GET_CLOCK),
            get_interval=self._function(clock, ways[0]) if asks else None,
            get_shift=self._function(clock, ways[1]) if asks and shifts else None,
            has_fractions=timing.has_fractions,
            is_told=timing.is_told,
            interval=timing.interval,
            shift=timing.shift,
            resolution=timing.resolution,
            sources=self._numbers(clock.sources),
            n_sources=len(clock.sources),
        )

    def _function(self, clock: WiredClock, call: Call) -> int:
        element = self._tables.wiring.system.elements[clock.element]
        with about(element.name):
            library = self._tables.elements.library(clock.element)
            return address(element.model, library, function_name(call, element.model.version))

    def _step(self, step: ClockStep) -> layout.ClockStep:
        made = layout.ClockStep(
            act=step.act,
            element=step.element,
            clock=step.clock,
            clocks=self._numbers(step.clocks),
            n_clocks=len(step.clocks),
            sources=self._numbers(step.sources),
            n_sources=len(step.sources),
            is_message=step.is_message,
        )
        if step.act in (Act.SAMPLE, Act.DELIVER):
            made.operation = self._operation(step)
        if step.act is Act.SAMPLE:
            name = self._tables.wiring.system.elements[step.element].name
            made.n_values = 0 if step.is_message else step.variable.size
            made.first = self._at[f"{name}.{step.variable.labels[0]}"] if made.n_values else 0
            room = np.zeros(max(1, made.n_values))
            self._kept.append(room)
            made.before = int(room.ctypes.data)
        return made

    def _group(self, group: ClockGroup) -> layout.ClockGroup:
        structures = self._tables.elements.structures
        for e in group.elements:
            element = self._tables.wiring.system.elements[e]
            for call in _EVENTS:
                with about(element.name):
                    library = self._tables.elements.library(e)
                    address(element.model, library, function_name(call, element.model.version))
            structures[e].abilities |= Ability.TICKS
            if e != group.early:
                # What it would tell at the end of a step cut short reached others too late: they have gone on.
                structures[e].abilities &= ~Ability.CAN_RETURN_EARLY
        clocks, steps = ctypes.addressof(self._clocks), ctypes.addressof(self._steps)
        clock_size, step_size = ctypes.sizeof(layout.Clock), ctypes.sizeof(layout.ClockStep)
        return layout.ClockGroup(
            elements=self._numbers(group.elements),
            n_elements=len(group.elements),
            leader=min(group.elements),
            clocks=clocks + clock_size * group.clocks.start,
            no_clocks=clocks + clock_size * group.clocks.stop,
            steps=steps + step_size * group.steps.start,
            no_steps=steps + step_size * group.steps.stop,
        )

    def _numbers(self, numbers: Sequence[int]) -> int:
        array = np.array(numbers, np.int64)
        self._kept.append(array)
        return int(array.ctypes.data)
