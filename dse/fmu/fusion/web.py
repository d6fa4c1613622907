"""Systems as a WebAssembly module for a page: their fused loops, and around them what the kernel does by FMI calls.

The same C as in fused libraries, compiled by ziglang for wasm32; what systems share is in it once. Its mathematical
functions are musl's, so that results can differ from those of a native run in the last bits, where a component calls
one that is not rounded correctly.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_content
from dse.domain.design import split_path
from dse.domain.method import PLAIN, Method
from dse.domain.system import Element, SystemStructure
from dse.errors import Problem, fail, raise_if_any
from dse.fmu.fusion.fuse import Wanted, fused_elements
from dse.fmu.fusion.loop import FusedElement, loop_text
from dse.fmu.fusion.sources import runtime_file
from dse.fmu.toolchain.compilation import CompilationError, compile_object, link_module, options
from dse.fmu.toolchain.compiler import find_web_compiler

_TYPES = {"Real": "DSE_WEB_REAL", "Integer": "DSE_WEB_INTEGER", "Boolean": "DSE_WEB_BOOLEAN"}
_FUNCTIONS = (
    *("Instantiate", "Reset", "SetupExperiment", "EnterInitializationMode", "ExitInitializationMode"),
    *("SetReal", "SetInteger", "SetBoolean", "GetReal", "GetInteger", "GetBoolean"),
)
_MEMBERS = (
    *("instantiate", "reset", "setup", "enter", "leave"),
    *("set_real", "set_integer", "set_boolean", "get_real", "get_integer", "get_boolean"),
)


@dataclass(frozen=True, slots=True)
class WebSystem:
    """A system for a page: what it records (``element.fmi_variable``, in this order), and what runs may set besides
    what it sets itself."""

    system: SystemStructure
    record: tuple[str, ...]
    settable: tuple[str, ...] = ()
    method: Method = PLAIN


@dataclass(frozen=True, slots=True)
class WebModule:
    """The bytes of a module. *starts* has, for each of its systems, the names of its start values
    (``element.fmi_variable``) in their order, with the values that the system gives them."""

    content: bytes
    starts: tuple[Mapping[str, float], ...]


def web_module(wanted: Sequence[WebSystem], *, cache: Path | None = None) -> WebModule:
    """The module that simulates each of *wanted*, by its place there; from the cache if it was made before.

    Raises one DseError naming all that cannot be in a page: what cannot be fused, FMI 3, another method, texts.
    """
    raise_if_any(dict.fromkeys(problem for each in wanted for problem in _problems(each)))
    compiler = find_web_compiler()
    starts = tuple(dict(_starts(each)) for each in wanted)
    try:
        fused, objects = fused_elements([Wanted(e.system, e.record, e.method) for e in wanted], compiler, cache)
        files = {name: runtime_file(name) for name in ("fused_values.h", "csolve/fused_abi.h", "web.h")}
        files["loops.c"] = "".join(map(_loop, range(len(wanted)), wanted, fused)).encode()
        files["driver.c"] = "\n".join(_driver(wanted, fused, starts)).encode()
        keyed = [*sorted(files.items()), ("build", repr((compiler.identity, options(compiler))).encode())]

        def linked() -> bytes:
            own = {f"{unit}.o": compile_object(compiler, files, f"{unit}.c") for unit in ("loops", "driver")}
            return link_module(compiler, {**{path.name: path.read_bytes() for path in objects}, **own})

        return WebModule(keep_content(cache_folder(cache) / "web" / f"{content_key(keyed)}.wasm", linked), starts)
    except CompilationError as error:
        said = "; ".join(f"{each.file}:{each.line}: {each.message}" for each in error.diagnostics[:3])
        raise fail(f"no module for a page can be made: {said}") from error


def _problems(wanted: WebSystem) -> Iterator[Problem]:
    if not wanted.method.is_plain_but_for_order:
        yield Problem(
            "a page simulates with inputs held, fixed steps, no coupling, no bonds, and no elements that lead"
        )
    for element in wanted.system.elements:
        if element.model.version != 2:
            yield Problem(f"{element.name}: a page has components of FMI 2 only", hint="build it for FMI 2")


def _starts(wanted: WebSystem) -> Iterator[tuple[str, float]]:
    """Every start value that the system gives or a run may, with its value in the system."""
    system = wanted.system
    names = [element.name for element in system.elements]
    settable = {split_path(name, names) for name in wanted.settable}
    for element in system.elements:
        for variable in element.model.variables.values():
            if variable.name not in element.start and (element.name, variable.name) not in settable:
                continue
            given = element.start.get(variable.name, *variable.start[:1])
            if variable.fmi_type not in _TYPES or not isinstance(given, int | float | str):
                raise fail(f"{element.name}.{variable.name}: a page cannot set a {variable.fmi_type}")
            yield f"{element.name}.{variable.name}", float({"true": 1.0, "false": 0.0}.get(str(given), given))


def _loop(number: int, wanted: WebSystem, fused: Sequence[FusedElement]) -> str:
    text = loop_text(wanted.system, wanted.record, fused, wanted.method.algorithm)
    return f"#define dse_fused_simulate dse_fused_simulate_{number}\n{text}#undef dse_fused_simulate\n"


def _driver(
    wanted: Sequence[WebSystem], fused: Sequence[Sequence[FusedElement]], starts: Sequence[Mapping[str, float]]
) -> Iterator[str]:
    """The unit with the tables of web.h."""
    yield f"#define DSE_SYSTEMS {len(wanted)}"
    yield f"#define DSE_MOST_STARTS {1 + max(map(len, starts), default=0)}"
    yield f"#define DSE_MOST_WIRES {1 + max((len(each.system.wires) for each in wanted), default=0)}"
    yield '#include "web.h"'
    for prefix in dict.fromkeys(element.prefix for elements in fused for element in elements):
        for name, member in zip(_FUNCTIONS, _MEMBERS, strict=True):
            yield f"extern __typeof__(*((dse_web_element *)0)->{member}) {prefix}fmi2{name};"
    for number, (each, elements, names) in enumerate(zip(wanted, fused, starts, strict=True)):
        yield from _tables(number, each, elements, [*names])
    yield "const dse_web_system dse_systems[DSE_SYSTEMS] = {"
    for number, (each, names) in enumerate(zip(wanted, starts, strict=True)):
        counts = f"{len(each.system.elements)}, {len(names)}, {len(each.record)}, {len(each.system.wires)}"
        tables = ", ".join(f"{table}_{number}" for table in ("elements", "starts", "recorded", "wires", "instances"))
        yield f"    {{dse_fused_simulate_{number}, {tables}, {counts}}},"
    yield "};"
    yield ""


def _tables(number: int, wanted: WebSystem, fused: Sequence[FusedElement], starts: Sequence[str]) -> Iterator[str]:
    """The tables of one system; those that can be empty have one entry more."""
    system = wanted.system
    places = {element.name: (place, element) for place, element in enumerate(system.elements)}

    def named(name: str) -> str:
        part, own = split_path(name, places) or ("", "")
        place, element = places[part]
        variable = element.model.variables[own]
        return f"{{{place}, {_TYPES[variable.fmi_type]}, {variable.reference}u}}"

    def table(names: Sequence[str]) -> str:
        return ", ".join([*map(named, names), "{0}"])

    yield f"static const dse_web_element elements_{number}[] = {{"
    yield from (f"    {_functions(*each)}," for each in zip(system.elements, fused, strict=True))
    yield "};"
    ends = ((f"{w.source}.{w.source_variable}", f"{w.target}.{w.target_variable}") for w in system.wires)
    wires = (f"{{{named(source)}, {named(target)}}}" for source, target in ends)
    yield f"static const dse_web_place starts_{number}[] = {{{table(starts)}}};"
    yield f"static const dse_web_place recorded_{number}[] = {{{table(wanted.record)}}};"
    yield f"static const dse_web_wire wires_{number}[] = {{{', '.join([*wires, '{{0}}'])}}};"
    yield f"static void *instances_{number}[{len(system.elements)}];"
    yield f"extern dse_fused_loop dse_fused_simulate_{number};"


def _functions(element: Element, fused: FusedElement) -> str:
    functions = ", ".join(f"{fused.prefix}fmi2{name}" for name in _FUNCTIONS)
    return f'{{{functions}, "{element.name}", "{element.model.token}"}}'
