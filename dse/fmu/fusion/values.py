"""How one value is read from a component and written to another, as C: what FMI's accessors and the kernel between do.

Wherever one of them would refuse the value, ``is_usual`` becomes false. Doubles of a component in C are read where they
lie. Other reals are doubles called ``v1``, all else are whole numbers called ``w1``. Values side by side that go to
places side by side are copied at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from dse.domain.fmu import Variable
from dse.fmu.fusion.layout import StoredVariable

ACCESSORS: Mapping[int, Mapping[str, tuple[int, str]]] = {
    2: {"Real": (0, "fmi2GetReal"), "Integer": (6, "fmi2GetInteger"), "Boolean": (11, "fmi2GetBoolean")},
    3: {
        "Float64": (0, "fmi3GetFloat64"),
        "Int32": (6, "fmi3GetInt32"),
        "Int64": (8, "fmi3GetInt64"),
        "Boolean": (10, "fmi3GetBoolean"),
    },
}
"""By FMI version and type of a variable: the type's number in the kernel, and the accessor that FMI asks by."""

_Range = tuple[int, int]

_INT32: _Range = (-(2**31), 2**31 - 1)
# An Int64 comes as a double, which beyond 2^53 no longer tells whole numbers apart.
_ACCEPTED: Mapping[str, _Range] = {"Integer": _INT32, "Int32": _INT32, "Int64": (-(2**53), 2**53), "Boolean": (0, 1)}
_ANY_WHOLE: _Range = (-(2**62), 2**62)


@dataclass(frozen=True, slots=True)
class Signal:
    """A variable of the element with this *index*; *number* tells outputs, and inputs, from one another."""

    index: int
    number: int
    variable: Variable
    place: StoredVariable
    is_model: bool

    @property
    def is_real(self) -> bool:
        """Whether its values are doubles, not whole numbers."""
        return self.place.row.kind == "REAL"

    @property
    def is_in_place(self) -> bool:
        """Whether the value of an output is read where it lies: it can be any double."""
        return self.place.c_type.accessor == "f64" and not self.is_model

    @property
    def real(self) -> str:
        """The value of an output as a double."""
        return f"dse_get_f64({self.member})" if self.is_in_place else f"v{self.number}"

    @property
    def whole(self) -> str:
        """The value of an output that is not real."""
        return f"w{self.number}"

    @property
    def items(self) -> _Range:
        """The numbers of an enumeration's items (value.h)."""
        first = 1 if self.is_model else 0
        return first, first + self.place.row.items - 1

    @property
    def member(self) -> str:
        """Where it lies."""
        return f"e{self.index} + {self.place.at}"


def declaring(output: Signal) -> Iterator[str]:
    """Where the value of *output* goes."""
    if not output.is_in_place:
        yield f"double {output.real};" if output.is_real else f"int64_t {output.whole}; double {output.real};"


def reading(output: Signal) -> Iterator[str]:
    """Read *output*."""
    if output.is_in_place:
        return
    got = f"dse_get_{output.place.c_type.accessor}({output.member})"
    if output.is_real:
        yield f"{output.real} = {got};"
        if output.is_model:
            yield f"is_usual &= {output.real} == {output.real};"
        return
    lowest, highest = _readable(output)
    if output.place.c_type.accessor == "whole":
        yield f"is_usual &= dse_is_whole({got}, {_literal(lowest)}, {_literal(highest)}, &{output.whole});"
    else:
        yield f"{output.whole} = {got};"
        yield f"is_usual &= dse_is_within({output.whole}, {_literal(lowest)}, {_literal(highest)});"
    if output.place.row.kind == "BOOLEAN":
        yield f"{output.whole} = {output.whole} != 0;"
    yield f"{output.real} = (double){output.whole};"


def finite(outputs: Iterable[Signal]) -> Iterator[str]:
    """Whether those of *outputs* that are real are finite."""
    reals = {output.number: output for output in outputs if output.is_real}
    for number in sorted(number for number, output in reals.items() if not output.is_in_place):
        yield f"is_usual &= v{number} - v{number} == 0.0; /* finite */"
    places = sorted((output.index, output.place.at) for output in reals.values() if output.is_in_place)
    for index, _, at, _, size in _joined((index, index, at, at, 8) for index, at in places):
        yield f"is_usual &= dse_are_finite(e{index} + {at}, {size // 8});"


def checking(source: Signal, target: Signal) -> Iterator[str]:
    """Whether the input *target* takes the value of the output *source*, already known to be finite."""
    if target.is_real:
        if target.place.c_type.accessor == "f32":
            yield f"is_usual &= dse_is_float({source.real});"
        return
    lowest, highest = _writable(target)
    if source.is_real:
        yield f"int64_t u{target.number};"
        yield f"is_usual &= dse_is_whole({source.real}, {_literal(lowest)}, {_literal(highest)}, &u{target.number});"
    elif not _is_inside(_shown(source), (lowest, highest)):
        yield f"is_usual &= dse_is_within({source.whole}, {_literal(lowest)}, {_literal(highest)});"


def writing(pairs: Iterable[tuple[Signal, Signal]]) -> Iterator[str]:
    """Give inputs, the second of *pairs*, the values of outputs, which they take."""
    copied = []
    for source, target in pairs:
        accessor = target.place.c_type.accessor
        if accessor in _SIZES and accessor == source.place.c_type.accessor:
            copied.append((target.index, source.index, target.place.at, source.place.at, _SIZES[accessor]))
            continue
        whole = f"u{target.number}" if source.is_real else source.whole
        value = source.real if target.is_real else f"(double){whole}" if accessor == "whole" else whole
        yield f"dse_put_{accessor}({target.member}, {value});"
    for taker, giver, to, at, size in _joined(sorted(copied)):
        yield f"memcpy(e{taker} + {to}, e{giver} + {at}, {size});"


# The sizes of types whose accessors pass on every value as it is; of a float and a whole double they do not.
_SIZES = {"f64": 8, "bool": 1} | {f"{sign}{bits}": bits // 8 for sign in "iu" for bits in (8, 16, 32, 64)}

_Copy = tuple[int, int, int, int, int]


def _joined(copies: Iterable[_Copy]) -> Iterator[_Copy]:
    """*copies* (target, source, place in each, size), with those as one that lie side by side in both."""
    last: _Copy | None = None
    for copy in copies:
        if last and (*last[:2], last[2] + last[4], last[3] + last[4]) == copy[:4]:
            last = (*last[:4], last[4] + copy[4])
            continue
        if last:
            yield last
        last = copy
    if last:
        yield last


def _readable(output: Signal) -> _Range:
    """What FMI's accessor lets through (dse_get_whole), of what the member can hold."""
    row, c_type = output.place.row, output.place.c_type
    if row.kind == "ENUMERATION":
        return output.items
    held = _ANY_WHOLE if c_type.accessor == "whole" else (c_type.lowest, c_type.highest)
    return held if row.kind == "BOOLEAN" else _both(held, _INT32)


def _shown(output: Signal) -> _Range:
    return (0, 1) if output.place.row.kind == "BOOLEAN" else _readable(output)


def _writable(target: Signal) -> _Range:
    """What the kernel passes on in the accessor's type and dse_set_whole then takes."""
    accepted, c_type = _ACCEPTED[target.variable.fmi_type], target.place.c_type
    is_enumeration = target.place.row.kind == "ENUMERATION"
    return _both(accepted, target.items if is_enumeration else (c_type.lowest, c_type.highest))


def _both(one: _Range, other: _Range) -> _Range:
    return max(one[0], other[0]), min(one[1], other[1])


def _is_inside(inner: _Range, outer: _Range) -> bool:
    return outer[0] <= inner[0] and inner[1] <= outer[1]


def _literal(number: int) -> str:
    return f"INT64_C({number})" if number > -(2**63) else "INT64_MIN"
