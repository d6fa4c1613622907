"""What every C component of the library keeps to, whoever wraps it."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from dse.domain.component import CSource, Kind

NewPart = Callable[..., Any]
STEP = re.compile(r"#define \w+_STEP (\S+) /\* s;")


def test_the_code_and_ports_of_every_c_component_are_among_these(shelf: Any, listed: list[str]) -> None:
    parts = [shelf.workspace.component(name) for name in sorted(shelf.workspace.component_files)]
    written_in_c = [part for part in parts if isinstance(part.source, CSource)]
    tested = [shelf.workspace.component(name) for name in listed]
    assert {ports_and_code(part) for part in tested} == {ports_and_code(part) for part in written_in_c}


def ports_and_code(part: Any) -> tuple[Any, ...]:
    return part.interface.name, part.source.struct, part.source.step, tuple(part.names.items())


@pytest.mark.sampled(3)
def test_init_of_a_zeroed_struct_does_not_crash(new_part: NewPart, c_component: str) -> None:
    part = new_part(c_component)
    ctypes.memset(part.memory, 0, ctypes.sizeof(part.memory))
    part.init()
    part.step()


@pytest.mark.sampled(3)
def test_init_after_steps_equals_the_first_init(new_part: NewPart, c_component: str) -> None:
    part = new_part(c_component)
    inputs = [p for p in part.component.interface.ports if p.causality == "input"]
    for number, port in enumerate(inputs):
        ones = {Kind.REAL: 3.0 + number, Kind.BINARY: bytes(range(number % 256))}
        part[port.name] = ones.get(port.type.kind, 1)
    assert trace(part) == trace(part)


@pytest.mark.sampled(3)
def test_two_instances_do_not_feel_each_other(new_part: NewPart, c_component: str) -> None:
    part, other, alone = new_part(c_component), new_part(c_component), new_part(c_component)
    other.init()
    assert trace(part, lambda: other.step(0.02)) == trace(alone)


def trace(part: Any, between: Callable[[], None] = lambda: None) -> list[bytes]:
    """All ports and parameters after init and after each of 50 steps (the memory itself holds padding: noise)."""
    part.init()
    values = [part.values()]
    for _ in range(50):
        between()
        part.step()
        values.append(part.values())
    return values


def writable(nm: str, library: Path) -> set[str]:
    symbols = subprocess.run([nm, str(library)], check=True, capture_output=True, encoding="utf-8").stdout
    rows = [line.split() for line in symbols.splitlines()]
    assert "T" in {row[-2] for row in rows}  # the listing says something at all
    return {row[-1] for row in rows if row[-2] in "dDbBcCsSgG"}


@pytest.fixture(scope="session")
def of_every_library(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Writable data that the linker brings along; of one that has a datum, to see that it would be found."""
    nm = shutil.which("nm")
    if nm is None:
        pytest.skip("no nm on this machine")
    from dse.fmu.toolchain.compiler import find_compiler

    source, library = tmp_path_factory.mktemp("datum") / "datum.c", tmp_path_factory.mktemp("library") / "datum.so"
    source.write_text("static int datum;\nint next_datum(void);\nint next_datum(void) { return ++datum; }\n", "utf-8")
    command = [*find_compiler().command, "-std=c99", "-O2", "-fPIC", "-shared", str(source), "-o", str(library)]
    subprocess.run(command, check=True)
    found = writable(nm, library)
    own = {name for name in found if "datum" in name and "." not in name}
    assert len(own) == 1
    return found - own


@pytest.mark.sampled(3)
def test_there_is_no_writable_data(shelf: Any, c_component: str, of_every_library: set[str]) -> None:
    shelf.part(c_component)
    assert writable(shutil.which("nm") or "", shelf.folder / f"{c_component}.so") <= of_every_library


def test_the_step_in_the_header_is_the_one_in_the_yaml(shelf: Any, c_component: str) -> None:
    source = shelf.workspace.component(c_component).source
    assert isinstance(source, CSource)
    headers = {header for file in (*source.files, source.header) for header in file.parent.glob("*.h")}
    steps = {float(found) for header in headers for found in STEP.findall(header.read_text(encoding="utf-8"))}
    if steps:
        assert steps == {source.step}
