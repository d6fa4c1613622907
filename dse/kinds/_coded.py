"""The C of components that hold somebody else's library: their values as the doubles it takes, and back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from dse.domain.component import Component, Kind, Type
from dse.kinds._partner import answered_names, asked_names, members_of, struct_lines

STRUCT = "outer"


@dataclass(frozen=True, slots=True)
class Code:
    """A value of the component in the code: ``si = offset + scale * number``, between *low* and *high* (SI).

    *numbers* are those of the items, where the component has an enumeration; a whole number that is none of *only*
    means nothing to the code. *is_rounded*: a quantity that the code is given as a whole number, without a scale.
    """

    scale: float = 1.0
    offset: float = 0.0
    low: float = float("-inf")
    high: float = float("inf")
    numbers: tuple[int, ...] = ()
    only: tuple[int, ...] = ()
    is_rounded: bool = False


def coded_files(component: Component, codes: Mapping[str, Code], library: bytes) -> dict[str, str]:
    """Header and code by file name: parameters are told, inputs asked and outputs answered, in their order.

    What is not between its bounds, or no item, ends the run: the library would take it for something else.
    """
    types = {each.name: each.type for each in component.interface.ports}
    types |= {each.name: each.type for each in component.parameters}
    told, asked = asked_names(component)
    values = {
        group: [
            _Value(name, member, c_type, types[name], codes[name])
            for name, (member, c_type) in zip(names, members_of(component, (group,)), strict=True)
        ]
        for group, names in (("par", told), ("in", asked), ("out", answered_names(component)))
    }
    return {f"{STRUCT}.h": _header(values), f"{STRUCT}.c": _code(values), "library.c": _library(library)}


@dataclass(frozen=True, slots=True)
class _Value:
    name: str
    member: str
    c_type: str
    type: Type
    code: Code


def _header(values: Mapping[str, Sequence[_Value]]) -> str:
    lines = "\n".join(struct_lines((each.member, each.c_type) for group in values.values() for each in group))
    told, asked, answered = (max(len(values[group]), 1) for group in ("par", "in", "out"))
    return f"""#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DSE_CODED
#define dse_component_take {STRUCT}_take
#define dse_component_library {STRUCT}_library
#define dse_component_wrong {STRUCT}_wrong

typedef struct {{
{lines}
    double told[{told}], ask[{asked}], answer[{answered}], value;
    const char *wrong;
}} {STRUCT};
void {STRUCT}_init({STRUCT} *self);
void {STRUCT}_step({STRUCT} *self);
void {STRUCT}_take({STRUCT} *self);
const char *{STRUCT}_wrong(const {STRUCT} *self, double *value);
const unsigned char *{STRUCT}_library(size_t *size);
"""


def _code(values: Mapping[str, Sequence[_Value]]) -> str:
    into = [
        _joined(_into(each, f"self->{target}[{place}]"))
        for group, target in (("par", "told"), ("in", "ask"))
        for place, each in enumerate(values[group])
    ]
    out = [_joined(_out(each, f"self->answer[{place}]")) for place, each in enumerate(values["out"])]
    return f"""#include "{STRUCT}.h"

static void is_wrong({STRUCT} *self, double value, const char *what) {{
    if (!self->wrong) {{
        self->wrong = what;
        self->value = value;
    }}
}}

void {STRUCT}_init({STRUCT} *self) {{
    self->wrong = 0;
    (void)is_wrong;
    {STRUCT}_step(self);
}}

{_function("step", into)}
{_function("take", out)}
const char *{STRUCT}_wrong(const {STRUCT} *self, double *value) {{
    *value = self->value;
    return self->wrong;
}}
"""


def _function(name: str, statements: Sequence[str]) -> str:
    from dse.simulink import in_parts

    parts, calls = in_parts(name, f"{STRUCT} *self", "self", statements)
    return "\n".join([*parts, f"void {STRUCT}_{name}({STRUCT} *self) {{", "    (void)self;", *calls, "}", ""])


def _joined(lines: Iterable[str]) -> str:
    return "\n".join(f"    {line}" for line in lines)


def _into(value: _Value, place: str) -> Iterator[str]:
    """Statements that put it where the library finds it."""
    own, code = f"self->{value.member}", value.code
    if value.type.kind is Kind.ENUMERATION:
        yield _items(code.numbers)
        is_item = f"{own} >= 0 && {own} < {len(code.numbers)}"
        yield f"  if ({is_item}) {place} = items[{own}]; else {_wrong(value, own, 'is no item')} }}"
        return
    bounds = [f"{own} >= {code.low!r}"] * (code.low > float("-inf"))
    bounds += [f"{own} <= {code.high!r}"] * (code.high < float("inf"))
    if bounds:
        told = f"is not between {_bound_text(code.low)} and {_bound_text(code.high)}"
        yield f"if (!({' && '.join(bounds)})) {_wrong(value, own, told)}"
    if code.only:
        is_one = " || ".join(f"{own} == {number}" for number in code.only)
        yield f"if (!({is_one})) {_wrong(value, own, f'is none of {_listed(code.only)}')}"
    is_plain = (code.scale, code.offset) == (1.0, 0.0)
    yield f"{place} = {own};" if is_plain else f"{place} = ({own} - {code.offset!r}) / {code.scale!r};"


def _out(value: _Value, place: str) -> Iterator[str]:
    """Statements that take it from there."""
    own, code = f"self->{value.member}", value.code
    if value.type.kind is Kind.ENUMERATION:
        yield _items(code.numbers)
        yield f"  int at = 0; while (at < {len(code.numbers)} && items[at] != {place}) at++;"
        told = _wrong(value, place, f"is none of {_listed(code.numbers)}")
        yield f"  if (at < {len(code.numbers)}) {own} = at; else {told} }}"
    elif value.type.kind is Kind.REAL:
        is_plain = (code.scale, code.offset) == (1.0, 0.0)
        yield f"{own} = {place};" if is_plain else f"{own} = {code.offset!r} + {code.scale!r} * {place};"
    elif value.type.kind is Kind.BOOLEAN:
        yield f"{own} = {place} != 0;"
    else:
        whole = f"{place} >= -2147483648.0 && {place} <= 2147483647.0"
        told = _wrong(value, place, "does not fit 32 bits")
        yield f"if ({whole}) {own} = ({value.c_type}){place}; else {told}"


def _items(numbers: Iterable[int]) -> str:
    return f"{{ static const double items[] = {{{', '.join(f'{number}.0' for number in numbers)}}};"


def _wrong(value: _Value, own: str, what: str) -> str:
    return f"is_wrong(self, (double){own}, \"'{value.name}' {what}\");"


def _listed(numbers: Sequence[int]) -> str:
    most = 12
    return ", ".join(map(str, numbers[:most])) + (", …" if len(numbers) > most else "")


def _bound_text(bound: float) -> str:
    return "anything" if bound in (float("inf"), float("-inf")) else f"{bound:.12g}"


def _library(content: bytes) -> str:
    rows = "\n".join(",".join(map(str, content[at : at + 64])) + "," for at in range(0, len(content), 64))
    return f"""#include "{STRUCT}.h"

static const unsigned char bytes[] = {{
{rows}
}};

const unsigned char *{STRUCT}_library(size_t *size) {{
    *size = sizeof bytes;
    return bytes;
}}
"""
