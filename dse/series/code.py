"""The C of time series, as the kind ``c`` takes it: tables, and what looks up in them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Component, Kind
from dse.domain.time_series import Interpolation, Outside
from dse.series.samples import Samples

_FILE_SIZE = 1_000_000
"""Of a file of tables, about: a compiler needs much memory for long ones, and time for many."""
_C_TYPES = {Kind.REAL: "double", Kind.INTEGER: "int32_t", Kind.BOOLEAN: "bool", Kind.ENUMERATION: "int32_t"}


def struct_name(component: Component) -> str:
    """The name of the struct in C, and of the header."""
    return f"series_{re.sub('[^0-9A-Za-z_]', '_', component.name)}"


def c_files(component: Component, series: Sequence[Samples]) -> dict[str, str]:
    """The files, by name; equal tables are one."""
    name = struct_name(component)
    tables: dict[bytes, tuple[str, NDArray[np.float64]]] = {}
    for numbers in (numbers for samples in series for numbers in (samples.times, samples.values)):
        tables.setdefault(numbers.tobytes(), (f"{name}_table_{len(tables)}", numbers))
    declared = "\n".join(f"extern const double {table}[{len(numbers)}];" for table, numbers in tables.values())
    places: dict[tuple[str, str], int] = {}
    lines = [_line(component, samples, tables[samples.times.tobytes()][0], tables[samples.values.tobytes()][0], places)
             for samples in series]  # fmt: skip
    found = [f"    struct place p{number} = {of[0]}; p{number}.before = {of[1].format(f'p{number}')};"
             for of, number in places.items()]  # fmt: skip
    files = {
        f"{name}.h": _header(component, name, series),
        f"{name}.c": _CODE.format(name=name, tables=declared, outputs="\n".join([*found, *lines])),
    }
    text = ""
    for number, (table, numbers) in enumerate(tables.values(), 1):
        rows = ",\n".join(map(repr, numbers.tolist()))
        text += f"extern const double {table}[{len(numbers)}];\nconst double {table}[] = {{\n{rows}\n}};\n"
        if len(text) > _FILE_SIZE or number == len(tables):
            files[f"{name}_tables_{len(files) - 1}.c"], text = text, ""
    return files


def _header(component: Component, name: str, series: Sequence[Samples]) -> str:
    members: dict[str, Any] = {}
    for samples in series:
        _put(members, ("out", *component.variable(samples.port).split(".")), _C_TYPES[samples.type.kind])
    for parameter in component.parameters:
        _put(members, ("par", *component.variable(parameter.name).split(".")), "double")
    text = "\n".join(_struct(members, 1))
    return f"""#pragma once
#include <stdbool.h>
#include <stdint.h>

typedef struct {{
{text}
    double time, rest; /* s since the start, and what rounding has left out of it */
}} {name};
void {name}_init({name} *self);
void {name}_step({name} *self, double h);
"""


def _put(members: dict[str, Any], path: Sequence[str], type_: str) -> None:
    for step in path[:-1]:
        members = members.setdefault(step, {})
    members[path[-1]] = type_


def _struct(members: Mapping[str, Any], depth: int) -> Iterator[str]:
    indent = "    " * depth
    for name, inner in members.items():
        if isinstance(inner, str):
            yield f"{indent}{inner} {name};"
        else:
            yield f"{indent}struct {{"
            yield from _struct(inner, depth + 1)
            yield f"{indent}}} {name};"


def _line(component: Component, samples: Samples, times: str, values: str, places: dict[tuple[str, str], int]) -> str:
    """The statement that sets one output; its place in the table is one of *places*, which many outputs share."""
    offset, gain = (_parameter(component, samples.port, name, neutral) for name, neutral in _NEUTRAL.items())
    outside, count = _OUTSIDE[samples.outside], len(samples.times)
    largest = max(abs(samples.first), abs(samples.first + float(samples.times[-1])))
    # A file's times are as exact as doubles of their size; a sample due now must not come a step later.
    place = f"place({offset} - {samples.first!r}, self->time, {largest!r}, {times}[{count - 1}], {outside})"
    number = places.setdefault((place, f"before({times}, {count}, {_AT[samples.interpolation]})"), len(places))
    value = f"{_LOOKUP[samples.interpolation]}({times}, {values}, {count}, p{number})"
    how = f"{gain} *" if samples.type.kind is Kind.REAL else f"({_C_TYPES[samples.type.kind]})"
    return f"    self->out.{component.variable(samples.port)} = {how} {value};"


_NEUTRAL = {"offset": "0.0", "gain": "1.0"}
_OUTSIDE = {Outside.HOLD: "HOLD", Outside.PERIODIC: "PERIODIC", Outside.ERROR: "ERROR"}
_AT = {Interpolation.LINEAR: "{0}.at", Interpolation.PREVIOUS: "{0}.at + {0}.slack"}
_LOOKUP = {Interpolation.LINEAR: "line", Interpolation.PREVIOUS: "previous"}


def _parameter(component: Component, port: str, name: str, neutral: str) -> str:
    declared = component.parameter(f"{port}.{name}") or component.parameter(name)
    return f"self->par.{component.variable(declared.name)}" if declared else neutral


_CODE = """#include "{name}.h"
#include <float.h>
#include <math.h>

{tables}

enum outside {{ HOLD, PERIODIC, ERROR }};
/* s after the first sample, how exactly that is known, and the number of the last sample before. */
struct place {{ double at, slack; int32_t before; }};

static struct place place(double shift, double time, double largest, double last, enum outside outside) {{
    struct place found = {{shift + time, 4.0 * DBL_EPSILON * (largest + fabs(time)), 0}};
    if (outside == PERIODIC) {{
        found.at -= last * floor((found.at + found.slack) / last);
    }} else if (outside == ERROR && (found.at < -found.slack || found.at > last + found.slack)) {{
        found.at = NAN;
    }}
    return found;
}}

/* The number of the last of the increasing times that is at most *at*; 0 if none is. */
static int32_t before(const double *times, int32_t count, double at) {{
    int32_t low = 0, high = count;
    while (high - low > 1) {{
        int32_t middle = low + (high - low) / 2;
        if (times[middle] <= at) low = middle; else high = middle;
    }}
    return low;
}}

static inline double previous(const double *times, const double *values, int32_t count, struct place place) {{
    return isnan(place.at) ? NAN : values[place.before];
}}

static inline double line(const double *times, const double *values, int32_t count, struct place place) {{
    int32_t i = place.before;
    if (isnan(place.at)) return NAN;
    if (place.at <= times[i] || i == count - 1) return values[i];
    return values[i] + (place.at - times[i]) / (times[i + 1] - times[i]) * (values[i + 1] - values[i]);
}}

static void output({name} *self) {{
{outputs}
}}

void {name}_init({name} *self) {{ output(self); }}

/* Steps are summed up as Kahan does, so that the time of a long run is as exact as that of the master. */
void {name}_step({name} *self, double h) {{
    double more = h - self->rest, sum = self->time + more;
    self->rest = (sum - self->time) - more;
    self->time = sum;
    output(self);
}}
"""
