"""The structures of a plan, field by field as in plan.h."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any, ClassVar

from dse.cosim.binding.layout import Groups, kernel
from dse.errors import fail

_Fields = list[tuple[str, Any]]


def _pointers(*names: str) -> _Fields:
    return [(name, ctypes.c_void_p) for name in names]


def _numbers(*names: str) -> _Fields:
    return [(name, ctypes.c_int64) for name in names]


def _reals(*names: str) -> _Fields:
    return [(name, ctypes.c_double) for name in names]


class Operation(ctypes.Structure):
    """Read, write or solve."""

    _fields_: ClassVar[_Fields] = [
        *_numbers("kind", "element"),
        ("groups", Groups),
        *_numbers("first", "count"),
        *_pointers("loop"),
    ]


class Walk(ctypes.Structure):
    """Operations one after another."""

    _fields_: ClassVar[_Fields] = _pointers("begin", "end")


class Loop(ctypes.Structure):
    """Outputs that depend on each other."""

    _fields_: ClassVar[_Fields] = [
        ("walk", Walk),
        *_pointers("torn"),
        *_numbers("n_reals", "n_torn", "walks", "number", "has_texts"),
        *_pointers("nominals", "room", "rows", "order", "way"),
    ]


class Pace(ctypes.Structure):
    """An element's own step."""

    _fields_: ClassVar[_Fields] = [*_numbers("every", "parts", "has_slopes"), ("inputs", Operation)]


class Bond(ctypes.Structure):
    """Power between two elements."""

    _fields_: ClassVar[_Fields] = _numbers("effort", "flow", "effort_used", "flow_used")


class BondColumn(ctypes.Structure):
    """Where a bond's energy is recorded."""

    _fields_: ClassVar[_Fields] = _numbers("column", "bond")


class Plan(ctypes.Structure):
    """How a system is simulated."""

    _fields_: ClassVar[_Fields] = [
        ("initial", Walk),
        ("meeting", Walk),
        ("doubtful", Walk),
        ("untold", Walk),
        *_pointers("doubted"),
        *_numbers("n_doubted_reals", "n_doubted"),
        *_pointers("doubted_nominals", "passed_on"),
        *_numbers("is_sequential"),
        *_pointers("paces", "owners", "staged", "slopes", "sources", "moves", "used", "watched"),
        *_numbers("n_watched"),
        *_pointers("nominals", "limits", "bonds"),
        *_numbers("n_bonds"),
        *_pointers("bond_columns"),
        *_numbers("n_bond_columns"),
        *_pointers("past"),
        *_numbers("n_past"),
        *_pointers("before", "shown", "spans", "energies", "met"),
        *_reals("tolerance", "absolute", "smallest"),
        *_pointers("compared"),
        *_numbers("n_compared"),
        *_pointers("magnitudes", "coarse", "kept"),
        *_numbers("reads_again", "k"),
    ]


_STRUCTURES = (Operation, Walk, Loop, Pace, Bond, BondColumn, Plan)


@cache
def check_kernel() -> None:
    """DseError if the compiled kernel has other plans in mind."""
    found = (ctypes.c_int64 * len(_STRUCTURES)).in_dll(kernel(), "dse_plan_layout")
    if list(found) != [ctypes.sizeof(structure) for structure in _STRUCTURES]:
        raise fail("the simulation kernel does not fit this version of dse", hint="install dse again")
