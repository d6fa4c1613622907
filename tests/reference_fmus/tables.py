"""The C side of a model's variables: a struct of values, their starts, and a table to find them by reference."""

from __future__ import annotations

import json
from math import prod

from reference_fmus.declared import Declared, Numbered, ReferenceModel, numbered

_C_TYPES = {
    "Float64": "double",
    "Float32": "float",
    "Boolean": "bool",
    "String": "Text",
    "Binary": "Text",
    "Enumeration": "int64_t",
}
MOST = 5
"""What a structural parameter may be at most; model.h knows it too."""


def c_tables(model: ReferenceModel, version: int, token: str) -> str:
    """The header that model.h is compiled with."""
    variables = numbered(model, version)
    states = [(model.variable(v.derivative_of), v) for v in model.variables if v.derivative_of]
    lines = [
        f'#define MODEL_IDENTIFIER "{model.name}"',
        f'#define TOKEN "{token}"',
        f"#define LARGEST_STEP {model.step / 10!r}",
        f"#define N_INDICATORS {len(model.indicators)}",
        f"#define N_STATE_VARIABLES {len(states)}",
        f"#define N_SLOTS {len(variables)}",
        "typedef struct {",
        *(f"    {_c_type(v)} {v.symbol}{''.join(f'[{n}]' for n in _room(v))};" for v in model.variables),
        "} Values;",
        "enum {",
        *(f"    VR_{n.declared.symbol} = {n.reference}," for n in variables if version == 3 or not _is_part(n)),
        "    VR_END",
        "};",
        f"static const Slot slots[] = {{{', '.join(_slot(model, n, version) for n in variables)}}};",
        "static const Extent state_slots[][2] = {",
        *(f"    {{{_extent(model, x)}, {_extent(model, dx)}}}," for x, dx in states),
        "    {{0}, {0}}",
        "};",
        "static void set_starts(Values *v)",
        "{",
        *(f"    {line}" for v in model.variables for line in _starts(model, v)),
        "}",
    ]
    return "\n".join(lines) + "\n"


def _is_part(variable: Numbered) -> bool:
    return "[" in variable.declared.name


def _c_type(variable: Declared) -> str:
    return _C_TYPES.get(variable.type, f"{variable.type.lower()}_t")


def _room(variable: Declared) -> list[int]:
    if not variable.shape:
        return []
    return [prod(s if isinstance(s, int) else MOST for s in variable.shape)]


def _whole(model: ReferenceModel, variable: Declared) -> Declared:
    """The array that a scalar of FMI 1 and 2 is a value of, or the variable itself."""
    return next(v for v in model.variables if v.symbol == variable.symbol.split("[")[0])


def _extent(model: ReferenceModel, variable: Declared) -> str:
    sized_by = [s for s in variable.shape if isinstance(s, str)]
    fixed = prod(s for s in variable.shape if isinstance(s, int))
    fields = [f"offsetof(Values, {name}) + 1" for name in sized_by] + ["0", "0"]
    return f"{{offsetof(Values, {variable.symbol}), {fixed}, {{{fields[0]}, {fields[1]}}}}}"


def _slot(model: ReferenceModel, variable: Numbered, version: int) -> str:
    declared = variable.declared
    kind = {"Float64": "FLOAT64", "Enumeration": "ENUMERATION"}.get(declared.type, declared.type.upper())
    flags = [
        *(["HAS_START"] if declared.has_start else []),
        *(["EXTERNAL"] if declared.causality == "input" else []),
        *(["TUNABLE"] if declared.variability == "tunable" else []),
        *(["CONTINUOUS"] if declared.variability == "continuous" else []),
        *(["STRUCTURAL"] if declared.causality == "structuralParameter" else []),
    ]
    extent = _extent(model, declared)
    if "[" in declared.name:
        symbol = _whole(model, declared).symbol
        extent = f"{{offsetof(Values, {symbol}[{variable.index}]), 1, {{0, 0}}}}"
    return f"{{{variable.reference}, {kind}, {' | '.join(flags) or '0'}, {extent}}}"


def _starts(model: ReferenceModel, variable: Declared) -> list[str]:
    if not variable.start:
        return []
    count = prod(model.sizes(variable))
    starts = variable.start if len(variable.start) > 1 else variable.start * count
    places = [f"v->{variable.symbol}[{i}]" for i in range(count)] if variable.shape else [f"v->{variable.symbol}"]
    return [_assign(variable, place, start) for place, start in zip(places, starts, strict=True)]


def _assign(variable: Declared, place: str, start: str) -> str:
    if variable.type == "String":
        return f"set_text(&{place}, {json.dumps(start)}, {len(start.encode())});"
    if variable.type == "Binary":
        data = bytes.fromhex(start)
        escaped = "".join(f"\\x{byte:02x}" for byte in data)
        return f'set_text(&{place}, "{escaped}", {len(data)});'
    return f"{place} = {start};"
