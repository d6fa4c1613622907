"""Tables of the Modelica Standard Library, whose C code is not part of dse, written in Modelica.

The library keeps a table in an external object, which a class declares once and gives to functions:
``parameter ExternalCombiTable1D tableID = ExternalCombiTable1D(…, table, columns, smoothness, extrapolation, …)`` and
``y = getTable1DValue(tableID, i, u)``. Here the declaration is left out, the arguments that matter replace the object's
name, and the functions are others that take them. Lines stay where they are.

Straight lines and constant segments are translated. A smooth table, and a point outside of a table without
extrapolation, give no number (NaN), which ends the run. Tables of files have no points, and are refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from dse.modelica.frontend.source_text import Change, arguments, code, edited, inside

_TYPES = "Modelica.Blocks.Types."
_KINDS = {
    "ExternalCombiTable1D": "tableName fileName table columns smoothness extrapolation",
    "ExternalCombiTable2D": "tableName fileName table smoothness extrapolation",
    "ExternalCombiTimeTable": "tableName fileName table startTime columns smoothness extrapolation shiftTime",
}
_TAKEN = {
    "ExternalCombiTable1D": "table columns smoothness extrapolation",
    "ExternalCombiTable2D": "table smoothness extrapolation",
    "ExternalCombiTimeTable": "table columns smoothness extrapolation startTime shiftTime",
}
_OBJECT = re.compile(rf"\b(?:final\s+)?parameter\s+(?:\w+\.)*({'|'.join(_KINDS)})\s+(\w+)\s*=\s*(?:\w+\.)*\1\s*(\()")
_CLASS = re.compile(r"\b(?:block|model)\s+(\w+)(?!\s*[=.])")
# What a function must contain to be the one that is meant, and not another of its name.
_IS_KNOWN = re.compile(r"\binput\s+[\w.]*ExternalCombiT")


def with_tables(text: str) -> str:
    """*text* of a file of the library with tables in Modelica."""
    if not any(kind in text for kind in _KINDS):
        return text
    clean = code(text)
    changes: list[Change] = []
    for match in _OBJECT.finditer(clean):
        changes.append((match.start(), clean.index(";", match.end()) + 1, ""))
        given = _given(text, match[1], inside(clean, match.start(3)), match.end())
        call = re.compile(rf"[\w.]+\s*(\()\s*(?={re.escape(match[2])}\b)")
        uses = {use.start(): use for part in _users(clean, match.start()) for use in call.finditer(clean, *part)}
        for use in uses.values():
            # The front-end miscounts parameters whose binding is a call with an array, but not a product.
            after = use.end(1) + len(inside(clean, use.start(1))) + 1
            changes += [(use.start(), use.start(), "(1*"), (after, after, ")")]
            changes.append((use.end(), use.end() + len(match[2]), given))
    for function, new in _FUNCTIONS.items():
        whole = re.compile(rf"(?:\bpure\s+)?\bfunction\s+{function}\b.*?\bend\s+{function}\s*;", re.DOTALL)
        changes += [(*found.span(), new) for found in whole.finditer(clean) if _IS_KNOWN.search(found[0])]
    lines = ((start, end, " ".join(new.split()) + "\n" * text.count("\n", start, end)) for start, end, new in changes)
    return edited(text, lines)


def _users(clean: str, place: int) -> Iterator[tuple[int, int]]:
    """Start and end of the block or model around *place*, and of those of the file that extend it."""
    start, end = _around(clean, place)
    yield start, end
    named = _CLASS.match(clean, start)
    if named is not None:
        for match in re.finditer(rf"\bextends\s+(?:\w+\.)*{named[1]}\b", clean):
            yield _around(clean, match.start())


def _around(clean: str, place: int) -> tuple[int, int]:
    """Start and end of the innermost block or model around *place*."""
    for match in reversed([*_CLASS.finditer(clean, 0, place)]):
        end = re.compile(rf"\bend\s+{match[1]}\s*;").search(clean, match.end())
        if end is not None and end.end() > place:
            return match.start(), end.start()
    return 0, len(clean)


def _given(text: str, kind: str, listed: str, start: int) -> str:
    """The arguments of the object's constructor, *listed* from *start* on, that the functions take."""
    found = {"extrapolation": f"{_TYPES}Extrapolation.LastTwoPoints", "shiftTime": "0"}
    for name, (begin, end) in zip(_KINDS[kind].split(), arguments(listed), strict=False):
        named = re.match(r"\s*(\w+)\s*=(?!=)", listed[begin:end])
        value = begin + named.end() if named else begin
        found[named[1] if named else name] = text[start + value : start + end].strip()
    return ", ".join(found[name] for name in _TAKEN[kind].split())


_TABLE = f"""
    input Real table[:, :]; input Integer columns[:];
    input {_TYPES}Smoothness smoothness; input {_TYPES}Extrapolation extrapolation;
"""
_TIMES = f"{_TABLE} input Real startTime; input Real shiftTime;"
# What has no value: the run ends where it is used.
_NONE = "sqrt(-1 - abs({0}))"
_WITHIN = f"""
    z := if extrapolation == {_TYPES}Extrapolation.Periodic then
        x - (if n > 1 then floor((x - table[1, 1])/(table[n, 1] - table[1, 1]))*(table[n, 1] - table[1, 1]) else 0)
      elseif x >= table[1, 1] and x <= table[n, 1] then x
      elseif extrapolation == {_TYPES}Extrapolation.HoldLastPoint then
        (if x < table[1, 1] then table[1, 1] else table[n, 1])
      elseif extrapolation == {_TYPES}Extrapolation.LastTwoPoints then x else {_NONE.format("x")};
"""
_LINE = """table[j, columns[icol]] + (if table[j + 1, 1] > table[j, 1] then
    (z - table[j, 1])*(table[j + 1, columns[icol]] - table[j, columns[icol]])/(table[j + 1, 1] - table[j, 1])
    elseif j == n - 1 and z >= table[j, 1] then table[j + 1, columns[icol]] - table[j, columns[icol]] else 0)"""
# Constant segments are continued by straight lines, as by the library.
_BEYOND = f"""for j in 1:n - 1 loop y := if extrapolation == {_TYPES}Extrapolation.LastTwoPoints
    and (j == 1 and {{0}} or j == n - 1 and {{1}}) then {_LINE} else y; end for;"""


def _value(name: str, body: str) -> str:
    return f"""function {name} {_TABLE} input Integer icol; input Real u; output Real y;
      protected Integer n = size(table, 1); Real x; Real z; algorithm x := u; {body} end {name};"""


def _value_of_time(name: str, body: str) -> str:
    """The segment is the one before the next event, so that it changes at events only."""
    return f"""function {name} {_TIMES} input Integer icol; input Real timeIn; input Real nextTimeEvent;
      input Real pre_nextTimeEvent; output Real y; protected Integer n = size(table, 1); Real x; Real z; Real k;
      algorithm x := timeIn - shiftTime; k := nextTimeEvent - shiftTime;
      {body} y := if nextTimeEvent <= startTime then 0 else y; end {name};"""


_STEPS = f"""{_WITHIN} y := table[1, columns[icol]];
    for j in 2:n loop y := if z >= table[j, 1] then table[j, columns[icol]] else y; end for;
    {_BEYOND.format("x < table[1, 1]", "x > table[n, 1]")}"""
_LINES = f"""{_WITHIN} y := table[1, columns[icol]];
    for j in 1:n - 1 loop y := if j == 1 or z >= table[j, 1] then {_LINE} else y; end for;"""
# In a periodic table, how many periods the segment before the next event is away.
_PERIODS = f"""
    k := if extrapolation == {_TYPES}Extrapolation.Periodic and n > 1 then
      k - (ceil((k - table[n, 1])/(table[n, 1] - table[1, 1]) - 1e-9))*(table[n, 1] - table[1, 1]) else k;
    x := if extrapolation == {_TYPES}Extrapolation.Periodic and n > 1 then x - nextTimeEvent + shiftTime + k else x;
    z := if extrapolation == {_TYPES}Extrapolation.HoldLastPoint then
        (if k <= table[1, 1] then table[1, 1] elseif k > table[n, 1] then table[n, 1] else x)
      elseif extrapolation == {_TYPES}Extrapolation.NoExtrapolation and (k <= table[1, 1] or x > table[n, 1]) then
        {_NONE.format("x")} else x;
"""
_STEPS_OF_TIME = f"""{_PERIODS} y := table[1, columns[icol]];
    for j in 2:n loop y := if k > table[j, 1] + 1e-10*(1 + abs(k)) then table[j, columns[icol]] else y; end for;
    {_BEYOND.format("k <= table[1, 1]", "k > table[n, 1] + 1e-10*(1 + abs(k))")}"""
_LINES_OF_TIME = f"""{_PERIODS} y := table[1, columns[icol]];
    for j in 1:n - 1 loop y := if j == 1 or k > table[j, 1] + 1e-10*(1 + abs(k)) then {_LINE} else y; end for;"""
_NEXT = f"""function getNextTimeEvent {_TIMES} input Real timeIn; output Real nextTimeEvent;
    protected Integer n = size(table, 1); Real x; Real y; Real base;
    algorithm x := timeIn - shiftTime + 1e-10*(1 + abs(timeIn));
    base := if extrapolation == {_TYPES}Extrapolation.Periodic and n > 1 then
      floor((x - table[1, 1])/(table[n, 1] - table[1, 1]))*(table[n, 1] - table[1, 1]) else 0;
    y := 1e60;
    for j in 1:n loop y := if y > 1e59 and table[j, 1] + base > x then table[j, 1] + base else y; end for;
    y := if y > 1e59 then 1e60 else y + shiftTime;
    nextTimeEvent := if startTime > x + shiftTime and startTime < y then startTime else y; end getNextTimeEvent;"""


_GRID = f"""
    input Real table[:, :]; input {_TYPES}Smoothness smoothness; input {_TYPES}Extrapolation extrapolation;
"""


def _value_of_grid(name: str, body: str) -> str:
    return f"""function {name} {_GRID} input Real u1; input Real u2; output Real y; protected
      Integer m = size(table, 1); Integer n = size(table, 2); Integer i; Integer k; Real z1; Real z2;
      algorithm {body} end {name};"""


def _within(output: str, given: str, first: str, last: str) -> str:
    """*output* is *given*, put into the table if the extrapolation asks for it."""
    return f"""{output} := if extrapolation == {_TYPES}Extrapolation.Periodic then
        {given} - floor(({given} - {first})/({last} - {first}))*({last} - {first})
      elseif {given} >= {first} and {given} <= {last} then {given}
      elseif extrapolation == {_TYPES}Extrapolation.LastTwoPoints then {given}
      elseif extrapolation == {_TYPES}Extrapolation.HoldLastPoint then
        (if {given} < {first} then {first} else {last}) else {_NONE.format(given)};"""


_WITHIN_GRID = f"""{_within("z1", "u1", "table[2, 1]", "table[m, 1]")}
    {_within("z2", "u2", "table[1, 2]", "table[1, n]")} i := 2; k := 2;
    y := getTable2DLines(z1, z2, table[2:m, 1], table[1, 2:n], table[2:m, 2:n]);"""
_STEPS_OF_GRID = f"""{_WITHIN_GRID}
    for j in 3:m loop i := if z1 >= table[j, 1] then j else i; end for;
    for j in 3:n loop k := if z2 >= table[1, j] then j else k; end for;
    y := if z1 < table[2, 1] or z1 > table[m, 1] or z2 < table[1, 2] or z2 > table[1, n] then y else table[i, k];"""
_LINES_OF_TABLE = """function getTable2DLines input Real x; input Real y; input Real xs[:]; input Real ys[:];
    input Real zs[size(xs, 1), size(ys, 1)]; output Real z;
    external "C" z = dse_table2(x, y, xs, size(xs, 1), ys, size(ys, 1), zs, 0, 2); end getTable2DLines;"""


def _end(name: str, inputs: str, output: str, row: str) -> str:
    return f"function {name} {inputs} output Real {output}; algorithm {output} := table[{row}, 1]; end {name};"


def _ends_of_grid(name: str, output: str, row: str, column: str) -> str:
    return f"""function {name} {_GRID} output Real {output}[2];
      algorithm {output} := {{table[{row}, 1], table[1, {column}]}}; end {name};"""


_FUNCTIONS = {
    "getTable1DValue": _value("getTable1DValue", f"z := x; y := {_NONE.format('z')};"),
    "getTable1DValueNoDer": _value("getTable1DValueNoDer", _STEPS),
    "getTable1DValueNoDer2": _value("getTable1DValueNoDer2", _LINES),
    "getTable1DAbscissaUmin": _end("getTable1DAbscissaUmin", _TABLE, "uMin", "1"),
    "getTable1DAbscissaUmax": _end("getTable1DAbscissaUmax", _TABLE, "uMax", "size(table, 1)"),
    "getTable2DValue": _value_of_grid(
        "getTable2DValue", f"i := 0; k := 0; z1 := u1; z2 := u2; y := {_NONE.format('u1')};"
    ),
    "getTable2DValueNoDer": _value_of_grid("getTable2DValueNoDer", _STEPS_OF_GRID),
    "getTable2DValueNoDer2": f"{_value_of_grid('getTable2DValueNoDer2', _WITHIN_GRID)} {_LINES_OF_TABLE}",
    "getTable2DAbscissaUmin": _ends_of_grid("getTable2DAbscissaUmin", "uMin", "2", "2"),
    "getTable2DAbscissaUmax": _ends_of_grid("getTable2DAbscissaUmax", "uMax", "size(table, 1)", "size(table, 2)"),
    "getTimeTableValue": _value_of_time("getTimeTableValue", f"z := x; y := {_NONE.format('z + k')};"),
    "getTimeTableValueNoDer": _value_of_time("getTimeTableValueNoDer", _STEPS_OF_TIME),
    "getTimeTableValueNoDer2": _value_of_time("getTimeTableValueNoDer2", _LINES_OF_TIME),
    "getTimeTableTmin": _end("getTimeTableTmin", _TIMES, "timeMin", "1"),
    "getTimeTableTmax": _end("getTimeTableTmax", _TIMES, "timeMax", "size(table, 1)"),
    "getNextTimeEvent": _NEXT,
}
