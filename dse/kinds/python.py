"""``source: {kind: python}``: a class in Python, for components that are tried out before they are written in C."""

from __future__ import annotations

import ast
import json
import sys
from collections.abc import Iterable
from pathlib import Path

from dse.domain.component import Causality, Component, Type
from dse.domain.python_source import PythonSource, class_name
from dse.errors import Location, Problem, closest, fail, raise_if_any
from dse.kinds._generated import build_generated
from dse.kinds._partner import partner_files
from dse.loading import ComponentKind, Plain, SourcePlace, SourceSection
from dse.partners import ABOUT

_STRUCT = "python_class"
_PARTNER = "dse.partners.python_class"


class PythonSection(SourceSection):
    """The keys of ``source``."""

    files: list[str] = []
    class_name: str | None = None
    step: Plain | None = None


class PythonKind(ComponentKind[PythonSection, PythonSource]):
    """The class runs in a process beside that of the run (dse/partners)."""

    section = PythonSection

    def read(self, section: PythonSection, place: SourcePlace) -> PythonSource:
        """Files of the workspace; the class is called as the component, in capitals, if nothing is said."""
        if not section.files:
            raise place.missing("files", f"files: [{place.component}.py]")
        first, *others = section.files
        files = [place.file(first, (".py",), "files", 0)]
        files += [place.file(name, (Path(name).suffix,), "files", n) for n, name in enumerate(others, 1)]
        name = section.class_name or class_name(place.component)
        step = None if section.step is None else place.number(section.step, "s", "step")
        if step is not None and step <= 0:
            raise fail(f"the step must be positive, not {section.step}", place.at("step"))
        return PythonSource(tuple(files), name, step)

    def check(self, component: Component, source: PythonSource) -> tuple[()]:
        """Read the first file without running it. Raises DseError: it has no such class, or a port is no number."""
        if sys.platform == "win32":
            raise fail("components of the kind python are built on Linux and macOS only", component.where)
        raise_if_any(_misfits(component))
        _check_class(source.files[0], source.name)
        return ()

    def build(self, component: Component, source: PythonSource, *, version: int, cache: Path | None) -> Path:
        """The FMU, with the files inside; only dse can run it. Raises DseError as `check` does."""
        self.check(component, source)
        ports = component.interface.ports
        about = {
            "file": source.files[0].name,
            "class": source.name,
            "parameters": _items((p.name, p.type) for p in component.parameters),
            "inputs": _items((p.name, p.type) for p in ports if p.causality is Causality.INPUT),
            "outputs": _items((p.name, p.type) for p in ports if p.causality is Causality.OUTPUT),
        }
        resources = {path.name: path.read_bytes() for path in source.files}
        resources[ABOUT] = json.dumps(about, sort_keys=True).encode()
        return build_generated(
            component,
            partner_files(component, _STRUCT, source.step),
            _STRUCT,
            source.step,
            version=version,
            cache=cache,
            partner=_PARTNER,
            resources=resources,
        )


def _items(values: Iterable[tuple[str, Type]]) -> list[tuple[str, str, list[str]]]:
    return [(name, type_.kind.value, list(type_.items)) for name, type_ in values]


def _misfits(component: Component) -> list[Problem]:
    """What a class cannot be given yet."""
    values = [(f"port '{port.name}'", port.type, component.where) for port in component.interface.ports]
    values += [(f"parameter '{p.name}'", p.type, p.where) for p in component.parameters]
    return [
        Problem(f"component '{component.name}': {name} is a {type_.kind}: a class in Python gets numbers only", where)
        for name, type_, where in values
        if not type_.kind.is_number
    ]


def _check_class(path: Path, name: str) -> None:
    from dse.formats import shown

    file = shown(path)
    try:
        tree = ast.parse(path.read_bytes(), file)
    except (SyntaxError, ValueError) as error:
        line, column = getattr(error, "lineno", 0) or 0, getattr(error, "offset", 0) or 0
        raise fail(f"it is not Python: {getattr(error, 'msg', error)}", Location(file, line, column)) from None
    except (RecursionError, MemoryError):
        raise fail("it is nested too deeply", Location(file)) from None
    classes = {each.name: each for each in tree.body if isinstance(each, ast.ClassDef)}
    if name not in classes:
        hint = closest(name, classes) or f"class {name}: with __init__(self, parameters) and step(self, inputs, h)"
        raise fail(f"there is no class '{name}'", Location(file), hint)
    found = classes[name]
    has_step = any(isinstance(each, ast.FunctionDef) and each.name == "step" for each in found.body)
    if not (has_step or found.bases or found.decorator_list):
        hint = "def step(self, inputs, h): returns a dict of the outputs"
        raise fail(f"class '{name}' has no method 'step'", Location(file, found.lineno, found.col_offset + 1), hint)


KIND = PythonKind()
