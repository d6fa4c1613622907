"""The C between a generated model and whoever runs it: all values are doubles, in arrays."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from dse.simulink.classes import OBJECT
from dse.simulink.declarations import Array, CType, Declared, Named, Number, Other, Pointer, Scalar
from dse.simulink.folder import CoderFolder
from dse.simulink.interface import MODEL, Data, Interface, Member, Port, Style, holds
from dse.simulink.timing import Timing

_CALL = (
    "DSE_CODED const char *dse_coded_{}(void *self, const double *parameters, const double *inputs, double *outputs) {{"
)


@dataclass(frozen=True, slots=True)
class Chosen:
    """What of a model is told and asked, in this order."""

    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    parameters: tuple[Port, ...]


@dataclass(frozen=True, slots=True)
class CodedModel:
    """A generated model, read. *class_name* is that of a class with the namespace it is in.

    *chosen* is what goes in and comes out, else all there is. *is_raw*: a model that integrates is not evaluated once
    more after each step, so that its outputs are those of the last minor step of its solver.
    """

    folder: CoderFolder
    interface: Interface
    timing: Timing
    class_name: str = ""
    chosen: Chosen | None = None
    is_raw: bool = False

    def with_ports(self, chosen: Chosen, *, is_raw: bool) -> CodedModel:
        """The same with other ports."""
        return replace(self, chosen=chosen, is_raw=is_raw)

    @property
    def integrates(self) -> bool:
        """Whether it has continuous states and a solver for them, which its first function steps."""
        return "ODEUpdateContinuousStates" in self.folder.texts[self.folder.source]


def glue(model: CodedModel) -> str:
    """The text of a unit in the model's language that exports ``dse_coded_...`` (dse/fmu/runtime/coded.h)."""
    made, is_cpp = model.interface, model.folder.is_cpp
    told = model.chosen or Chosen(tuple(made.inputs), tuple(made.outputs), tuple(made.parameters))
    lines = ["#include <math.h>", "#include <stdlib.h>", *(["#include <new>"] if is_cpp else [])]
    lines.append(f'#include "{model.folder.header}"')
    linkage = 'extern "C" ' if is_cpp else ""
    lines.append(f'#define DSE_CODED {linkage}__attribute__((visibility("default")))')
    lines.append("struct dse_model {")
    lines += [f"    {declaration(member)};" for member in made.storage]
    if made.style is Style.CLASS:
        lines.append(f"    {model.class_name} *object;")
    lines += ["    unsigned long tick;", "};"]
    lines += map(_defined, made.imported)
    lines += _whole_numbers()
    lines += _new(model)
    lines += _transfer("dse_coded_parameters", told.parameters, writes=False)
    lines += _transfer("dse_put_parameters", told.parameters, writes=True)
    lines += _transfer("dse_put_inputs", told.inputs, writes=True)
    lines += _transfer("dse_get_outputs", told.outputs, writes=False)
    lines += _start(made)
    lines += _step(model)
    lines += _first(model)
    lines += _end(model)
    return "\n".join(lines) + "\n"


def _defined(imported: Declared) -> str:
    """A variable that the code leaves to others, unless they do define it."""
    name, type_ = imported.name, imported.type
    if isinstance(type_, Pointer):
        value = declaration(Member(f"dse_{name}", type_.target))
        return f"static {value}; __attribute__((weak)) {_spelled(type_)}{name} = &dse_{name};"
    return f"__attribute__((weak)) {declaration(Member(name, type_))};"


def declaration(member: Member) -> str:
    """How C declares a member."""
    name, type_ = member.name, member.type
    while isinstance(type_, Array):
        name, type_ = f"{name}[{type_.count}]", type_.element
    return f"{_spelled(type_)} {name}"


def _spelled(type_: CType) -> str:
    match type_:
        case Scalar(name) | Named(name) | Other(name):
            return name
        case Pointer(target):
            return f"{_spelled(target)} *"
        case Array(element):
            return _spelled(element)


def _whole_numbers() -> Iterator[str]:
    # What is no number becomes 0, what does not fit the nearest that does: anything else has no meaning in C.
    yield "static long long dse_whole(double v, long long low, long long high) {"
    yield "    return v != v ? 0 : v <= (double)low ? low : v >= (double)high ? high : llround(v);"
    yield "}"
    yield "static unsigned long long dse_natural(double v, unsigned long long high) {"
    yield "    return !(v > 0) ? 0 : v >= (double)high ? high : (unsigned long long)llround(v);"
    yield "}"


def _new(model: CodedModel) -> Iterator[str]:
    yield "DSE_CODED void *dse_coded_new(void) {"
    yield f"    struct dse_model *{MODEL} = (struct dse_model *)calloc(1, sizeof *{MODEL});"
    yield f"    if (!{MODEL}) return 0;"
    if model.interface.style is Style.CLASS:
        name = model.class_name
        # On zeroed memory, as where the generated main has it: some models rely on that.
        yield f"    void *room = calloc(1, sizeof({name}));"
        yield "    if (!room) return 0;"
        yield f"    {OBJECT} = new (room) {name};"
    yield from (f"    {statement}" for statement in model.interface.prepare)
    yield from (f"    {statement}" for statement in defaults(model))
    yield f"    return {MODEL};"
    yield "}"
    if not any(unit.endswith(".cpp") for unit in model.folder.units):
        yield "DSE_CODED const _Bool dse_coded_is_plain = 1;"


def defaults(model: CodedModel) -> Iterator[str]:
    """Statements that give parameters which an instance owns the values they were generated with."""
    for member in model.interface.storage:
        if not holds(member.type, Data.PARAMETERS) or not isinstance(member.type, Named):
            continue
        pattern = re.compile(
            rf"^(?:static\s+)?(?:const\s+)?{re.escape(member.type.name.split()[-1])}\s+(\w+)\s*=\s*", re.MULTILINE
        )
        found = _definition(pattern, map(model.folder.text, model.folder.units))
        if found and not found[1].startswith("static"):
            yield f"{{ extern {member.type.name} {found[0]}; {MODEL}->{member.name} = {found[0]}; }}"
            continue
        found = found or _definition(pattern, model.folder.parameters_of_main)
        if found:
            yield f"{{ static const {member.type.name} values = {found[2]}; {MODEL}->{member.name} = values; }}"
        else:
            model.interface.warnings.append("no values of its parameters were found: they begin as 0")


def _definition(pattern: re.Pattern[str], texts: Iterator[str]) -> tuple[str, str, str] | None:
    """Name, beginning and value of the first definition of that kind."""
    for text in texts:
        found = pattern.search(text)
        if found:
            end = re.compile(r"\}\s*;").search(text, found.end())
            if end and text.startswith("{", found.end()):
                return found[1], found[0], text[found.end() : end.end()].rstrip("; \n")
    return None


_TOGETHER = 64
"""Statements in one function of C: compilers take the square of the time for twice as many."""


def in_parts(name: str, takes: str, given: str, statements: Sequence[str]) -> tuple[list[str], list[str]]:
    """Lines of C: functions with parameters *takes* that run many *statements*, and the calls of them with *given*."""
    if len(statements) <= _TOGETHER:
        return [], list(statements)
    functions, calls = [], []
    for part in range(0, len(statements), _TOGETHER):
        functions.append(f"__attribute__((noinline)) static void {name}_{part}({takes}) {{")
        functions += [*statements[part : part + _TOGETHER], "}"]
        calls.append(f"    {name}_{part}({given});")
    return functions, calls


def _transfer(name: str, ports: Sequence[Port], *, writes: bool) -> Iterator[str]:
    kind = "const double" if writes else "double"
    exported = "DSE_CODED" if name.startswith("dse_coded") else "static"
    lines = []
    for place, port in enumerate(ports):
        value = f"values[{place}]"
        lines.append(f"    {_put(port, value)}" if writes else f"    {value} = (double)({port.expression});")
    functions, lines = in_parts(name, f"struct dse_model *{MODEL}, {kind} *values", f"{MODEL}, values", lines)
    yield from functions
    yield f"{exported} void {name}(void *self, {kind} *values) {{"
    yield f"    struct dse_model *{MODEL} = (struct dse_model *)self;"
    yield f"    (void){MODEL}, (void)values;"
    yield from lines
    yield "}"


def _put(port: Port, value: str) -> str:
    match port.scalar.number:
        case Number.REAL:
            return f"{port.expression} = ({port.scalar.name}){value};"
        case Number.BOOLEAN:
            return f"{port.expression} = {value} != 0.0;"
        case Number.ENUMERATION:
            return f"{port.expression} = ({port.scalar.name})dse_whole({value}, {port.scalar.low}, {port.scalar.high});"
    if port.scalar.low < 0:
        low = f"({port.scalar.low + 1}LL - 1)"
        return f"{port.expression} = ({port.scalar.name})dse_whole({value}, {low}, {port.scalar.high}LL);"
    return f"{port.expression} = ({port.scalar.name})dse_natural({value}, {port.scalar.high}ULL);"


def _start(made: Interface) -> Iterator[str]:
    yield _CALL.format("start")
    yield f"    struct dse_model *{MODEL} = (struct dse_model *)self;"
    yield f"    {MODEL}->tick = 0;"
    yield "    dse_put_parameters(self, parameters);"
    yield from ([f"    {made.initialize};"] if made.initialize else [])
    yield from ([f"    {made.end} = -1;"] if made.end else [])  # for ever: when a run ends is not the model's to say
    yield "    dse_put_inputs(self, inputs);"  # initialize clears them
    yield "    if (outputs) dse_get_outputs(self, outputs);"
    yield f"    return {_error(made)};"
    yield "}"


def _step(model: CodedModel) -> Iterator[str]:
    made = model.interface
    yield _CALL.format("step")
    yield f"    struct dse_model *{MODEL} = (struct dse_model *)self;"
    yield "    dse_put_parameters(self, parameters);"
    yield "    dse_put_inputs(self, inputs);"
    for call, rate in zip(made.steps.values(), model.timing.rates, strict=True):
        yield f"    {f'if ({MODEL}->tick % {rate} == 0) ' if rate > 1 else ''}{call};"
    yield f"    {MODEL}->tick++;"
    if not model.is_raw and model.integrates and made.solver:
        again = next(iter(made.steps.values()))
        yield f"    rtsiSetSimTimeStep(&{made.solver}, MINOR_TIME_STEP);"
        yield f"    {again};"
        yield f"    rtsiSetSimTimeStep(&{made.solver}, MAJOR_TIME_STEP);"
    yield "    dse_get_outputs(self, outputs);"
    yield f"    return {_error(made)};"
    yield "}"


def _end(model: CodedModel) -> Iterator[str]:
    yield "DSE_CODED void dse_coded_end(void *self) {"
    yield f"    struct dse_model *{MODEL} = (struct dse_model *)self;"
    # Else without the code's own end: that may write files or stop the program.
    yield from ([f"    {model.interface.terminate};"] if model.interface.terminate else [])
    if model.interface.style is Style.CLASS:
        yield f"    typedef {model.class_name} kind;"
        yield f"    {OBJECT}->~kind();"
        yield f"    free({OBJECT});"
    yield f"    free({MODEL});"
    yield "}"


def _first(model: CodedModel) -> Iterator[str]:
    made = model.interface
    yield _CALL.format("first")
    yield f"    struct dse_model *{MODEL} = (struct dse_model *)self;"
    yield "    const char *error = dse_coded_start(self, parameters, inputs, 0);"
    yield f"    (void){MODEL};"
    yield "    if (error && *error) return error;"
    if model.integrates and made.solver:
        # A step of no length ends where it began.
        yield f"    rtsiSetStepSize(&{made.solver}, 0.0);"
    yield "    return dse_coded_step(self, parameters, inputs, outputs);"
    yield "}"


def _error(made: Interface) -> str:
    return f"(const char *){made.error}" if made.error else "0"
