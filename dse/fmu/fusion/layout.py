"""Where the members of a component's struct lie: asked of the compiler, read from the object it makes.

Nothing is run to find out, so the same can be done for a machine other than this one.
"""

from __future__ import annotations

from dataclasses import dataclass

from dse.fmu.fusion.sources import OwnSources
from dse.fmu.slot_table import Row

_MARK = b"dse struct layout..."
"""Of four bytes and four, as the numbers behind it are."""
_NOT_FUSED = ("TEXT", "BINARY")


@dataclass(frozen=True, slots=True)
class CType:
    """A member's type in C: its *accessor* in fused_values.h, and the whole numbers it may be given; as in slot.h."""

    accessor: str
    lowest: int = 0
    highest: int = 0

    @property
    def is_floating(self) -> bool:
        """Whether the accessor passes a double."""
        return self.accessor in ("f64", "f32", "whole")


def _signed(bits: int) -> CType:
    return CType(f"i{bits}", -(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _unsigned(bits: int) -> CType:
    return CType(f"u{bits}", 0, min(2**bits, 2**63) - 1)  # values arrive as int64_t


_C_TYPES = (
    None,
    CType("f64"),
    CType("f32"),
    CType("bool", 0, 1),
    *(_signed(bits) for bits in (8, 16, 32, 64)),
    *(_unsigned(bits) for bits in (8, 16, 32, 64)),
    CType("whole", -(2**31), 2**31 - 1),
)


@dataclass(frozen=True, slots=True)
class StoredVariable:
    """A variable in an instance: *at* is where it is read and written, in bytes from the instance's begin."""

    row: Row
    c_type: CType
    at: int


@dataclass(frozen=True, slots=True)
class InstanceLayout:
    """*places* by value reference; *changed_at*: where a model notes that it was given a value (uint16_t)."""

    places: tuple[StoredVariable, ...]
    changed_at: int


def layout_unit(sources: OwnSources) -> str:
    """C that is compiled for its one array of numbers, in which `read_layout` finds the layout. It lies in fused/."""
    mark = ", ".join(f"{byte}" for byte in _MARK)
    numbers = [f"offsetof(struct dse_instance, at.{member})" for member in ("now", "start", "is_changed")]
    for row in sources.rows:
        if row.kind in _NOT_FUSED:
            numbers += ["0", "0"]
        elif sources.is_model:
            numbers += [f"8u * {row.member}u", f"DSE_TYPE_OF_{row.kind}"]
        else:
            numbers += [f"offsetof(dse_component, {row.member})", f"DSE_TYPE_OF({row.member})"]
    return "\n".join(
        (
            '#include "names.h"',
            '#include "../runtime/instance.h"',
            '_Static_assert(sizeof(((struct dse_instance *)0)->at.is_changed) == sizeof(uint16_t), "");',
            f"const struct {{ unsigned char mark[{len(_MARK)}]; uint32_t numbers[{len(numbers)}]; }}",
            f"dse_struct_layout = {{{{{mark}}}, {{",
            *(f"    (uint32_t)({number})," for number in numbers),
            "}};",
            "",
        )
    )


def read_layout(sources: OwnSources, made: bytes) -> InstanceLayout:
    """The layout from the object of `layout_unit`. Raises LookupError if it is not there."""
    begin = made.find(_MARK)
    if begin < 0:
        raise LookupError("the object holds no layout")
    begin += len(_MARK)

    def number(index: int) -> int:
        return int.from_bytes(made[begin + 4 * index : begin + 4 * index + 4], "little")

    now, start, changed = (number(index) for index in range(3))
    places = []
    for index, row in enumerate(sources.rows):
        offset, c_type = number(3 + 2 * index), _C_TYPES[number(4 + 2 * index)]
        c_type = CType("") if row.kind in _NOT_FUSED else c_type
        if c_type is None:
            raise LookupError(f"'{row.member}' is of no type that has a number")
        # What can be set while stepping waits in a model's *start* until its next step (value.h).
        waits = sources.is_model and row.settable in ("INPUT", "TUNABLE")
        places.append(StoredVariable(row, c_type, (start if waits else now) + offset))
    return InstanceLayout(tuple(places), changed)
