"""The structures of a plan, field by field as in plan.h."""

from __future__ import annotations

import ctypes
from typing import Any, ClassVar

from dse.cosim.binding.exchange_layout import numbers, pointers, reals
from dse.cosim.binding.layout import Groups

_Fields = list[tuple[str, Any]]


class Operation(ctypes.Structure):
    """Read, write or solve."""

    _fields_: ClassVar[_Fields] = [
        *numbers("kind", "element"),
        ("groups", Groups),
        *numbers("first", "count"),
        *pointers("loop"),
    ]


class Sweep(ctypes.Structure):
    """Operations one after another."""

    _fields_: ClassVar[_Fields] = pointers("begin", "end")


class Loop(ctypes.Structure):
    """Outputs that depend on each other."""

    _fields_: ClassVar[_Fields] = [
        ("sweep", Sweep),
        *pointers("torn"),
        *numbers("n_reals", "n_torn", "sweeps", "number", "has_texts"),
        *pointers("nominals", "room", "rows", "way", "pivots"),
    ]


class Pace(ctypes.Structure):
    """An element's own step."""

    _fields_: ClassVar[_Fields] = [*numbers("every", "parts", "has_slopes"), ("inputs", Operation)]


class Bond(ctypes.Structure):
    """Power between two elements."""

    _fields_: ClassVar[_Fields] = numbers("effort", "flow", "effort_used", "flow_used")


class BondColumn(ctypes.Structure):
    """Where a bond's energy is recorded."""

    _fields_: ClassVar[_Fields] = numbers("column", "bond")


class Clock(ctypes.Structure):
    """When a clock ticks, and whether it does now."""

    _fields_: ClassVar[_Fields] = [
        *numbers("element", "reference", "kind"),
        *pointers("access", "get_interval", "get_shift"),
        *numbers("has_fractions", "is_told"),
        *reals("interval", "shift", "resolution"),
        *pointers("sources"),
        *numbers("n_sources"),
        *reals("period", "first", "parts", "next"),
        *numbers("ticks", "is_active", "is_set", "asked_at", "count"),
    ]


class ClockStep(ctypes.Structure):
    """What is done with a clock, or with a variable that belongs to clocks."""

    _fields_: ClassVar[_Fields] = [
        *numbers("act", "element", "clock"),
        *pointers("clocks"),
        *numbers("n_clocks"),
        *pointers("sources"),
        *numbers("n_sources", "is_message"),
        ("operation", Operation),
        *numbers("first", "n_values"),
        *pointers("before"),
        *numbers("stamp", "read_at", "bytes"),
    ]


class CountColumn(ctypes.Structure):
    """Where ticks or bytes are recorded."""

    _fields_: ClassVar[_Fields] = [*numbers("column"), *pointers("counter")]


class ClockGroup(ctypes.Structure):
    """Elements that stop together where clocks tick."""

    _fields_: ClassVar[_Fields] = [
        *pointers("elements"),
        *numbers("n_elements", "leader"),
        *pointers("clocks", "no_clocks", "steps", "no_steps"),
    ]


class Ticking(ctypes.Structure):
    """An element in an instant."""

    _fields_: ClassVar[_Fields] = numbers("in_events", "is_due", "news")


class Plan(ctypes.Structure):
    """How a system is simulated."""

    _fields_: ClassVar[_Fields] = [
        ("initial", Sweep),
        ("meeting", Sweep),
        ("doubtful", Sweep),
        ("untold", Sweep),
        *pointers("doubted"),
        *numbers("n_doubted_reals", "n_doubted"),
        *pointers("doubted_nominals", "passed_on"),
        *numbers("is_sequential", "n_leading"),
        *pointers("paces", "owners", "staged", "slopes", "sources", "moves", "used", "watched"),
        *numbers("n_watched"),
        *pointers("nominals", "limits", "bonds"),
        *numbers("n_bonds"),
        *pointers("bond_columns"),
        *numbers("n_bond_columns"),
        *pointers("past"),
        *numbers("n_past"),
        *pointers("before", "shown", "spans", "energies", "met"),
        *reals("tolerance", "absolute", "smallest"),
        *pointers("compared"),
        *numbers("n_compared"),
        *pointers("magnitudes", "coarse", "kept"),
        *numbers("reads_again", "k"),
        *pointers("groups"),
        *numbers("n_groups"),
        *pointers("group_of", "clocks", "clock_steps", "ticking", "count_columns"),
        *numbers("n_count_columns", "instant"),
        *reals("spare"),
    ]
