"""OpenModelica as the compiler, where the user has it: a script for ``omc``, an FMU 2.0 back."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import zipfile
from collections.abc import Collection, Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

from dse.domain.component import Component, Kind, ModelicaSource
from dse.errors import DseError, Location, Problem, fail, raise_if_any
from dse.fmu import read_description
from dse.modelica.frontend.literal import WRAPPER, literal, wrapper
from dse.modelica.frontend.sources import FILES, ModelSources
from dse.scratch import ScratchFolder

_SECONDS = 900.0
_PRODUCT = "dse_product"


def find_omc() -> str | None:
    """The path of ``omc``, or None if it is not on PATH."""
    return shutil.which("omc")


def omc_version(omc: str) -> str:
    """What ``omc --version`` says. Raises DseError if it says nothing."""
    return _ask(omc, Path(omc).stat().st_mtime_ns)


@lru_cache(maxsize=8)
def _ask(omc: str, changed: int) -> str:  # noqa: ARG001  # an updated compiler is asked anew
    answer = _called(omc, "--version", seconds=60.0)
    if answer.returncode != 0 or not answer.stdout.strip():
        raise fail("omc does not print its version", hint="is it OpenModelica's compiler?")
    return answer.stdout.strip()


def build_with_omc(component: Component, source: ModelicaSource, sources: ModelSources, omc: str) -> bytes:
    """The FMU archive omc makes of the model, for FMI 2.0; parameters that are not tunable have their values in it.

    Raises DseError with what omc says, in the user's files.
    """
    with ScratchFolder() as scratch:
        folder = Path(scratch)
        sources.lay_out(folder)
        (folder / "wrapper.mo").write_text(_wrapper(component, source), encoding="utf-8")
        (folder / "build.mos").write_text(_script(sources), encoding="utf-8")
        said = _run(component, omc, folder)
        product = folder / f"{_PRODUCT}.fmu"
        if not product.is_file():
            raise DseError(*_problems(component, sources, said))
        _require_variables(component, product, folder / "description")
        return product.read_bytes()


def _wrapper(component: Component, source: ModelicaSource) -> str:
    changes = {}
    for parameter in component.parameters:
        if parameter.tunable:
            continue
        if parameter.type.kind is Kind.ENUMERATION:
            what = (
                f"component '{component.name}': parameter '{parameter.name}' is an enumeration, which omc is not given"
            )
            raise fail(what, parameter.where or component.where, "set it in a Modelica model that extends this one")
        value = parameter.start
        changes[component.variable(parameter.name)] = literal(
            float(value) if parameter.type.kind is Kind.REAL else bool(value) if isinstance(value, bool) else int(value)
        )
    return wrapper(source.model, changes)


def _script(sources: ModelSources) -> str:
    path = os.pathsep.join([FILES, *(str(root.resolve()) for root in sources.roots)])
    names = sorted(name for name in sources.contents if name.endswith(".mo"))
    files = [name for name in names if "/" not in name.removesuffix("/package.mo")]
    loads = [f"loadFile({_text(f'{FILES}/{name}')}); getErrorString();" for name in files]
    return "\n".join(
        [
            f"setModelicaPath({_text(path)});",
            *loads,
            'loadFile("wrapper.mo"); getErrorString();',
            f'buildModelFMU({WRAPPER}, version = "2.0", fmuType = "me_cs", fileNamePrefix = "{_PRODUCT}");',
            "getErrorString();",
            "",
        ]
    )


def _text(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _run(component: Component, omc: str, folder: Path) -> str:
    try:
        answer = _called(omc, "build.mos", seconds=_SECONDS, within=folder)
    except DseError as error:
        raise fail(f"component '{component.name}': {error.problems[0].what}", component.where) from error
    return answer.stdout + answer.stderr


def _called(omc: str, argument: str, *, seconds: float, within: Path | None = None) -> subprocess.CompletedProcess[str]:
    how: dict[str, Any] = {"capture_output": True, "encoding": "utf-8", "errors": "replace"}
    try:
        return subprocess.run(
            [omc, argument], check=False, cwd=within, stdin=subprocess.DEVNULL, timeout=seconds, **how
        )
    except subprocess.TimeoutExpired as error:
        raise fail(f"omc took longer than {seconds:g} s") from error
    except OSError as error:
        raise fail(f"omc cannot be run: {error}") from error


_LOCATED = re.compile(
    r"\[(?P<file>[^\[\]\n]+?):(?P<line>\d+):(?P<column>\d+)-\d+:\d+:\w+\]\s*Error: (?P<message>[^\n\"]*)"
)
_PLAIN = re.compile(r"^\"?Error: (?P<message>[^\n\"]*)", re.MULTILINE)


def _problems(component: Component, sources: ModelSources, said: str) -> list[Problem]:
    found = []
    for match in _LOCATED.finditer(said):
        relative = match["file"].replace("\\", "/").rpartition("files/")[2]
        file = sources.origins.get(relative, match["file"])
        where = Location(file, int(match["line"]), int(match["column"]))
        is_own = relative in sources.origins
        found.append(Problem(f"omc: {match['message']}", where if is_own else component.where))
    lines = [line.strip() for line in said.splitlines() if line.strip(' "')]
    unknown = f"omc made no FMU: {'; '.join(lines[-3:]) or 'it printed nothing'}"
    plain = [f"omc: {match['message']}" for match in _PLAIN.finditer(said)]
    return found or [Problem(f"component '{component.name}': {what}", component.where) for what in plain or [unknown]]


def _require_variables(component: Component, product: Path, folder: Path) -> None:
    """Raise DseError unless the FMU has a variable for each port and parameter."""
    folder.mkdir()
    try:
        with zipfile.ZipFile(product) as archive:
            (folder / "modelDescription.xml").write_bytes(archive.read("modelDescription.xml"))
    except (zipfile.BadZipFile, KeyError, OSError) as error:
        raise fail(f"component '{component.name}': what omc made is not an FMU: {error}", component.where) from error
    try:
        known = read_description(folder, product.name).variables
    except DseError as error:
        what = f"component '{component.name}': what omc made cannot be used: {error.problems[0].what}"
        raise fail(what, component.where) from error
    raise_if_any(_missing(component, known.keys()))


def _missing(component: Component, known: Collection[str]) -> Iterator[Problem]:
    ports = [(f"{port.causality} '{port.name}'", port.name, component.where) for port in component.interface.ports]
    tunable = [one for one in component.parameters if one.tunable]
    parameters = [(f"parameter '{one.name}'", one.name, one.where or component.where) for one in tunable]
    for word, name, where in (*ports, *parameters):
        if component.variable(name) not in known:
            what = f"component '{component.name}': the model has no variable '{component.variable(name)}' for {word}"
            yield Problem(what, where)
