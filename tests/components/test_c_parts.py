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


def test_init_of_a_zeroed_struct_does_not_crash(new_part: NewPart, c_component: str) -> None:
    part = new_part(c_component)
    ctypes.memset(part.memory, 0, ctypes.sizeof(part.memory))
    part.init()
    part.step()


def test_init_after_steps_equals_the_first_init(new_part: NewPart, c_component: str) -> None:
    part = new_part(c_component)
    inputs = [p for p in part.component.interface.ports if p.causality == "input"]
    for number, port in enumerate(inputs):
        part[port.name] = 1 if port.type.kind is not Kind.REAL else 3.0 + number
    assert trace(part) == trace(part)


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


def test_there_is_no_writable_data(new_part: NewPart, shelf: Any, c_component: str, tmp_path: Path) -> None:
    nm = shutil.which("nm")
    if nm is None:
        pytest.skip("no nm on this machine")
    from dse.fmu.toolchain.compiler import find_compiler

    source = shelf.workspace.component(c_component).source
    assert isinstance(source, CSource)
    for number, unit in enumerate(file for file in source.files if file.suffix == ".c"):
        target = tmp_path / f"{number}.o"
        command = [*find_compiler().command, "-std=c99", "-O2", "-c", str(unit), "-o", str(target)]
        subprocess.run(command, check=True)
        symbols = subprocess.run([nm, str(target)], check=True, capture_output=True, encoding="utf-8").stdout
        kinds = {line.split()[-2] for line in symbols.splitlines()}
        assert "T" in kinds  # the listing says something at all
        assert not kinds & set("dDbBcCsSgG"), f"{unit.name} has writable data:\n{symbols}"


def test_the_step_in_the_header_is_the_one_in_the_yaml(shelf: Any, c_component: str) -> None:
    source = shelf.workspace.component(c_component).source
    assert isinstance(source, CSource)
    headers = {header for file in (*source.files, source.header) for header in file.parent.glob("*.h")}
    steps = {float(found) for header in headers for found in STEP.findall(header.read_text(encoding="utf-8"))}
    if steps:
        assert steps == {source.step}
