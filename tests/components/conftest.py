"""Runs the C parts of the library as they are, without any FMU around them."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from dse.domain.component import Component, CSource, Kind, Type, Value
from dse.fmu.c.slots import slots
from dse.fmu.toolchain.compiler import find_compiler
from dse.loading.workspace import Workspace

ROOT = Path(__file__).parents[2]
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")


class Binary:
    """A binary: its bytes, those of a struct of their number and of room for more."""

    def __init__(self, address: int, size: int) -> None:
        self._size = ctypes.c_size_t.from_address(address)
        self._room = (ctypes.c_uint8 * (size - ctypes.sizeof(self._size))).from_address(
            address + ctypes.sizeof(self._size)
        )

    @property
    def value(self) -> bytes:
        return bytes(self._room[: self._size.value])

    @value.setter
    def value(self, data: bytes) -> None:
        self._room[: len(data)] = list(data)
        self._size.value = len(data)

    def __bytes__(self) -> bytes:
        return self.value


Slot = ctypes.c_double | ctypes.c_bool | ctypes.c_int32 | Binary


@dataclass(frozen=True)
class Part:
    """One instance of a component; ``part["target.gap"]`` is a port or a parameter, in SI, items by name."""

    component: Component
    library: ctypes.CDLL
    memory: ctypes.Array[ctypes.c_uint64]
    slots: dict[str, tuple[Type, Slot]] = field(repr=False)

    def __getitem__(self, name: str) -> Any:
        return self.slots[name][1].value

    def __setitem__(self, name: str, value: Value | bytes) -> None:
        type_, slot = self.slots[name]
        slot.value = type_.items.index(value) if isinstance(value, str) else value

    def values(self) -> bytes:
        """All ports and parameters, bit for bit."""
        return b"".join(bytes(slot) for _, slot in self.slots.values())

    def init(self) -> None:
        self.library.shim_init(self.memory)

    def step(self, h: float = 0.01) -> None:
        self.library.shim_step(self.memory, ctypes.c_double(h))


@dataclass(frozen=True)
class Shelf:
    """Compiles each component once per session; every warning is an error unless *warnings* are left out."""

    folder: Path
    workspace: Workspace
    libraries: dict[str, ctypes.CDLL] = field(default_factory=dict)
    warnings: tuple[str, ...] = WARNINGS

    def part(self, name: str, **parameters: Value) -> Part:
        """A fresh instance of what the library calls *name*."""
        return self.instance(self.workspace.component(name), **parameters)

    def instance(self, component: Component, **parameters: Value) -> Part:
        """A fresh instance with the component's own start values but for *parameters*; not initialised."""
        name = component.name
        library = self.libraries.get(name) or self.libraries.setdefault(name, self.compile(component))
        memory = (ctypes.c_uint64 * (library.shim_size() // 8 + 1))()
        address = ctypes.addressof(memory)
        ports = sorted(component.interface.ports, key=lambda port: port.causality != "input")  # as `slots` has them
        types = {p.name: p.type for p in (*ports, *component.parameters)}
        found = {
            slot: (type_, _slot(type_.kind, address + library.shim_offset(i), library.shim_room(i)))
            for i, (slot, type_) in enumerate(types.items())
        }
        part = Part(component, library, memory, found)
        for parameter in component.parameters:
            part[parameter.name] = parameter.start
        for given, value in parameters.items():
            part[given] = value
        return part

    def compile(self, component: Component) -> ctypes.CDLL:
        target = self.folder / f"{component.name}{'.dll' if sys.platform == 'win32' else '.so'}"
        shim = self.folder / f"{component.name}_shim.c"
        shim.write_text(_shim(component), encoding="utf-8")
        source = component.source
        assert isinstance(source, CSource)
        units = [str(file) for file in (*source.files, shim) if file.suffix == ".c"]
        options = ["-std=c99", "-O2", "-ffp-contract=off", "-shared", *self.warnings]
        options += [] if sys.platform == "win32" else ["-fPIC"]
        math = [] if sys.platform == "win32" else ["-lm"]
        subprocess.run([*find_compiler().command, *options, *units, "-o", str(target), *math], check=True)
        library = ctypes.CDLL(str(target))
        library.shim_size.restype = library.shim_offset.restype = library.shim_room.restype = ctypes.c_size_t
        return library


def _slot(kind: Kind, address: int, size: int) -> Slot:
    match kind:
        case Kind.BINARY:
            return Binary(address, size)
        case Kind.REAL:
            return ctypes.c_double.from_address(address)
        case Kind.BOOLEAN:
            return ctypes.c_bool.from_address(address)
        case _:
            return ctypes.c_int32.from_address(address)


def _shim(component: Component) -> str:
    source = component.source
    assert isinstance(source, CSource)
    members = [slot.member for slot in slots(component)]
    offsets = ", ".join(f"offsetof({source.struct}, {member})" for member in members)
    rooms = ", ".join(f"sizeof((({source.struct} *)0)->{member})" for member in members)
    call = f"{source.step_function}(self)" if source.step else f"{source.step_function}(self, h)"
    return f"""#include <stddef.h>
#include "{source.header.as_posix()}"
size_t shim_size(void);
size_t shim_offset(int slot);
size_t shim_room(int slot);
void shim_init({source.struct} *self);
void shim_step({source.struct} *self, double h);
size_t shim_size(void) {{ return sizeof({source.struct}); }}
size_t shim_offset(int slot) {{ const size_t at[] = {{{offsets}}}; return at[slot]; }}
size_t shim_room(int slot) {{ const size_t rooms[] = {{{rooms}}}; return rooms[slot]; }}
void shim_init({source.struct} *self) {{ {source.init}(self); }}
void shim_step({source.struct} *self, double h) {{ (void)h; {call}; }}
"""


WORKSPACE = Workspace(ROOT)


def c_components() -> list[str]:
    """Names of the components of the library that are written in C, one of those with the same code and ports.

    By their text: reading them takes long.
    """
    found: dict[tuple[str, ...], str] = {}
    for name, file in sorted(WORKSPACE.component_files.items()):
        text = file.read_text("utf-8")
        if "kind: c," in text:
            code = [line for line in text.splitlines() if line.startswith(("implements:", "source:", "map:"))]
            found.setdefault(tuple(code), name)
    return sorted(found.values())


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "c_component" in metafunc.fixturenames:
        metafunc.parametrize("c_component", c_components())


@pytest.fixture(scope="session")
def shelf(tmp_path_factory: pytest.TempPathFactory) -> Shelf:
    return Shelf(tmp_path_factory.mktemp("components"), WORKSPACE)


@pytest.fixture
def listed() -> list[str]:
    """The values of *c_component*."""
    return c_components()


@pytest.fixture
def new_part(shelf: Shelf) -> Callable[..., Part]:
    return partial(shelf.part)
