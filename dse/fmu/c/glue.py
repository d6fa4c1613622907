"""The C that ties a component to the FMU runtime: ``model.h``, and what each of its lines proves about the component.

Every demand on the user's C stands on a line of its own. If the compiler rejects the line, the demand is not met, and
the problem is told in the user's words, whatever the compiler says.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from pathlib import Path

from dse.domain.component import CSource, Kind
from dse.errors import Location, Problem
from dse.fmu.c.slots import Role, Slot
from dse.fmu.slot_table import Row
from dse.formats import shown


@dataclass(frozen=True, slots=True)
class Demand:
    """What a line proves. Of several unmet demands on one *subject* only the first matters."""

    subject: str
    problem: Problem


@dataclass(frozen=True, slots=True)
class Glue:
    """The text of model.h and its demands by line number, from 1."""

    text: str
    demands: Mapping[int, Demand]


def glue(source: CSource, slots: tuple[Slot, ...], header: str, token: str) -> Glue:
    """model.h for a component whose header is found at *header*, seen from model.h."""
    page = _Page(source.header, source.struct)
    page.add("/* Generated: how the FMU runtime reaches this component. */")
    page.add("#ifndef DSE_MODEL_H", "#define DSE_MODEL_H", '#include "slot.h"', f'#include "{header}"')
    if source.partner:
        page.add("#define DSE_PARTNER", f"#define dse_component_take {source.struct}_take")
    page.demand(
        "",
        f"typedef {source.struct} dse_component;",
        f"there is no type '{source.struct}'",
        f"end the struct with `}} {source.struct};` after `typedef struct {{`",
    )
    _add_functions(page, source)
    for alike in _alike(slots):
        _demand_member(page, alike)
    _add_table(page, slots)
    _add_binaries(page, slots)
    _add_behaviour(page, source, slots)
    page.add(f'#define DSE_TOKEN "{token}"', "#endif")
    return Glue("\n".join(page.lines) + "\n", page.demands)


def slot_rows(slots: tuple[Slot, ...]) -> tuple[Row, ...]:
    """The table of slots, as data."""
    return tuple(Row(slot.member, slot.type.kind.name, _settable(slot), len(slot.type.items)) for slot in slots)


@dataclass(slots=True)
class _Page:
    header: Path
    struct: str
    lines: list[str] = field(default_factory=list)
    demands: dict[int, Demand] = field(default_factory=dict)

    def add(self, *lines: str) -> None:
        self.lines.extend(lines)

    def demand(self, subject: str, line: str, what: str, hint: str) -> None:
        self.add(line)
        self.demands[len(self.lines)] = Demand(subject, Problem(what, Location(shown(self.header)), hint))


def _add_functions(page: _Page, source: CSource) -> None:
    struct = source.struct
    step = f"({struct} *)" if source.step is not None else f"({struct} *, double)"
    why = f"because it runs every {source.step} s" if source.step is not None else "because the component has no 'step'"
    for name, arguments, reason in ((source.init, f"({struct} *)", ""), (source.step_function, step, why)):
        what = f"'{name}' is not declared as `void {name}{arguments};`" + (f", {reason}" if reason else "")
        page.demand(
            name,
            f'_Static_assert(_Generic(&{name}, void (*){arguments}: 1, default: 0), "");',
            what,
            f"declare it so in {page.header.name}",
        )


_C_TYPES = {
    Kind.REAL: ("double", "double or float"),
    Kind.INTEGER: ("int32_t", "an integer type"),
    Kind.BOOLEAN: ("bool", "bool or an integer type"),
    Kind.ENUMERATION: ("int", "an enum or an integer type"),
    Kind.TEXT: ("char[64], or as long as it has to be", "an array of char"),
    Kind.BINARY: (
        "struct { size_t size; uint8_t data[4096]; }, or as long as it has to be",
        "a struct of 'size', a size_t, and 'data', an array of uint8_t",
    ),
}


def _alike(slots: tuple[Slot, ...]) -> list[list[Slot]]:
    """The slots whose members differ in indices only, and so are of one type."""
    found: dict[str, list[Slot]] = {}
    for slot in slots:
        found.setdefault(re.sub(r"\[\d+\]", "[]", slot.member), []).append(slot)
    return list(found.values())


def _demand_arrays(page: _Page, slots: Sequence[Slot]) -> None:
    """That every array on the way to the members is one, of the right size."""
    indices = [re.findall(r"\[(\d+)\]", slot.member) for slot in slots]
    whole = ""
    pieces = slots[0].member.split("[0]")
    for piece, places in zip(pieces, zip(*indices, strict=True), strict=False):
        whole += piece
        size = max(map(int, places)) + 1
        for condition in (f"sizeof(((dse_component *)0)->{whole}[0]) > 0", f"DSE_IS_ARRAY({whole}, {size})"):
            page.demand(
                slots[0].member,
                f'_Static_assert({condition}, "");',
                f"struct {page.struct} has no array '{whole}' of {size}",
                f"declare it in {page.header.name}, with [{size}]",
            )
        whole += "[0]"


def _demand_member(page: _Page, slots: Sequence[Slot]) -> None:
    """What the C must have for *slots*, whose members differ in indices only."""
    slot = slots[0]
    _demand_arrays(page, slots)
    simple, accepted = _C_TYPES[slot.type.kind]
    page.demand(
        slot.member,
        f'_Static_assert(sizeof(((dse_component *)0)->{slot.member}) > 0, "");',
        f"struct {page.struct} has no member '{slot.member}' for {slot.source}",
        f"declare it in {page.header.name}, as {simple}",
    )
    conditions = [f"DSE_IS_{slot.type.kind.name}({slot.member})"]
    if slot.type.kind is Kind.BINARY:
        parts = (f"sizeof(((dse_component *)0)->{slot.member}.{part})" for part in ("size", "data[0]"))
        conditions.insert(0, " + ".join(parts))
    for condition in conditions:
        page.demand(
            slot.member,
            f'_Static_assert({condition}, "");',
            f"struct {page.struct}: '{slot.member}' is not {accepted}, as {slot.source} ({slot.type.kind}) needs",
            f"declare it as {simple}",
        )
    for number in sorted({number for one in slots for number in _extremes(one)}):
        page.demand(
            slot.member,
            f'_Static_assert(DSE_FITS({slot.member}, {_literal(slot, number)}), "");',
            f"struct {page.struct}: '{slot.member}' is too narrow for {number}, a value of {slot.source}",
            "declare it as a wider integer type",
        )


def _extremes(slot: Slot) -> tuple[int, ...]:
    """The least and greatest whole numbers the member certainly has to hold."""
    if slot.type.kind is Kind.ENUMERATION:
        return (len(slot.type.items) - 1,)
    if slot.type.kind is Kind.INTEGER:
        known = (slot.start, slot.minimum, slot.maximum)
        return tuple(sorted({int(number) for number in known if number is not None}))
    return ()


def _add_table(page: _Page, slots: tuple[Slot, ...]) -> None:
    # C knows no empty array: a component without ports gets a row that no reference reaches.
    page.add(f"#define DSE_SLOT_COUNT {len(slots)}u", "static const struct dse_slot dse_slots[] = {")
    rows = slot_rows(slots)
    page.add(*(f"    {_row(row, prod(slot.shape))}," for row, slot in zip(rows, slots, strict=True)))
    page.add(*(() if slots else ("    {0, DSE_NO_TYPE, 0, 0, 0, 1, 0, 0},",)), "};")
    page.add(*(("#define DSE_HAS_ARRAYS",) if any(slot.shape for slot in slots) else ()))
    page.add("static const char *const dse_names[] = {")
    page.add(*(f'    "{slot.name}",' for slot in slots), *(() if slots else ('    "",',)), "};")


def _row(row: Row, count: int) -> str:
    if row.kind in (Kind.TEXT.name, Kind.BINARY.name):
        return f"DSE_{row.kind}_SLOT({row.member}, DSE_{row.settable}, {count})"
    return f"DSE_SLOT({row.member}, DSE_{row.kind}, DSE_{row.settable}, {row.items}, {count})"


def _add_binaries(page: _Page, slots: tuple[Slot, ...]) -> None:
    """The slots that are binaries, and a room for what they hold."""
    if any(not slot.type.kind.is_number for slot in slots):
        page.add("#define DSE_HAS_TEXTS")
    found = [slot for slot in slots if slot.type.kind is Kind.BINARY]
    if not found:
        return
    page.add(f"#define DSE_BINARIES {len(found)}u")
    page.add(f"static const uint32_t dse_binaries[] = {{{', '.join(str(slot.reference) for slot in found)}}};")
    rooms = (f"    char b{n}[sizeof(((dse_component *)0)->{slot.member}.data)];" for n, slot in enumerate(found))
    page.add("struct dse_binary_room {", *rooms, "};")
    places = ", ".join(f"offsetof(struct dse_binary_room, b{n})" for n in range(len(found)))
    page.add(f"static const size_t dse_binary_places[] = {{{places}}};")


def _settable(slot: Slot) -> str:
    if slot.role is Role.PARAMETER:
        return "TUNABLE" if slot.is_tunable else "FIXED"
    return slot.role.name


def _add_behaviour(page: _Page, source: CSource, slots: tuple[Slot, ...]) -> None:
    page.add("static inline void dse_component_start(dse_component *component) {", "    (void)component;")
    page.add(
        *(
            f"    component->{slot.member} = {_literal(slot, slot.start)};"
            for slot in slots
            if slot.start is not None and slot.start != 0
        )
    )
    page.add("}", f"#define dse_component_init {source.init}", f"#define dse_component_step {source.step_function}")
    if source.step is not None:
        page.add(f"#define DSE_PERIOD {source.step!r}")


def _literal(slot: Slot, number: float | bool) -> str:
    return repr(float(number)) if slot.type.kind is Kind.REAL else f"INT64_C({int(number)})"
