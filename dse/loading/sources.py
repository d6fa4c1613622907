"""Reads where a component's behaviour comes from."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TypeVar

from dse.domain.component import (
    CSource,
    FmuSource,
    ModelicaCompiler,
    ModelicaSource,
    Solver,
    Source,
    UnsupportedSource,
)
from dse.errors import Location, Problem, closest, fail, raise_if_any
from dse.loading.documents import ComponentFile, SourceSection
from dse.loading.names import is_identifier
from dse.loading.root import followed, is_file, named_file
from dse.loading.values import read_number, read_unit
from dse.loading.yaml import Document, shown
from dse.units import DIMENSIONLESS

_KEYS = {
    "c": {"files", "header", "struct", "init", "step_function", "step"},
    "fmu": {"file"},
    "modelica": {"model", "files", "modelica_path", "compiler", "solver", "tolerance"},
}
_PLANNED = ("python", "udp")


def read_source(document: Document, file: ComponentFile, section: SourceSection, inside: Path) -> Source:
    """Where the behaviour of the component comes from; its C and Modelica files lie in *inside*. Raises DseError."""
    if section.kind in _PLANNED:
        return UnsupportedSource(section.kind)
    if section.kind not in _KEYS:
        where = document.place(("source", "kind"))
        raise fail(f"unknown kind of source '{section.kind}'", where, closest(section.kind, (*_KEYS, *_PLANNED)))
    raise_if_any(
        Problem(
            f"'{key}' makes no sense in a source of the kind {section.kind}",
            document.key(("source", key)),
            f"{section.kind} has {', '.join(sorted(_KEYS[section.kind]))}",
        )
        for key in sorted(section.model_fields_set - {"kind"} - _KEYS[section.kind])
    )
    match section.kind:
        case "fmu":
            return _fmu(document, section)
        case "modelica":
            return _modelica(document, section, inside)
    return _c(document, file, section, inside)


def _fmu(document: Document, section: SourceSection) -> FmuSource:
    if section.file is None:
        raise fail("'file' is missing in 'source'", document.key(("source",)), "file: my_part.fmu")
    where = document.place(("source", "file"))
    # Used as it is and known by its content, so that it may lie anywhere.
    return FmuSource(_existing(followed(document.path.parent, section.file, where), where))


def _c(document: Document, file: ComponentFile, section: SourceSection, inside: Path) -> CSource:
    folder = document.path.parent
    if not section.files:
        raise fail("'files' is missing in 'source'", document.key(("source",)), f"files: [{file.component}.c]")
    files = tuple(
        _c_file(folder, name, inside, (".c", ".h"), document.place(("source", "files", i)))
        for i, name in enumerate(section.files)
    )
    header = section.header or Path(section.files[0]).with_suffix(".h").as_posix()
    struct = section.struct or file.component
    step = None
    if section.step is not None:
        where = document.place(("source", "step"))
        step = read_number(section.step, read_unit("s", where), where)
        if step <= 0:
            raise fail(f"the step must be positive, not {section.step}", where)
    return CSource(
        files,
        _c_file(folder, header, inside, (".h",), document.place(("source", "header"))),
        _identifier(struct, document.place(("source", "struct"))),
        _identifier(section.init or f"{struct}_init", document.place(("source", "init"))),
        _identifier(section.step_function or f"{struct}_step", document.place(("source", "step_function"))),
        step,
    )


def _modelica(document: Document, section: SourceSection, inside: Path) -> ModelicaSource:
    if section.model is None:
        raise fail("'model' is missing in 'source'", document.key(("source",)), "model: Package.Model")
    where = document.place(("source", "model"))
    if not _CLASS.fullmatch(section.model):
        raise fail(f"'{section.model}' is no name of a Modelica class", where, "model: Package.Model")
    if not section.files and not section.modelica_path:
        hint = "files: [model.mo], or a folder with a package.mo"
        raise fail("'files' is missing in 'source'", document.key(("source",)), hint)
    files = [
        _modelica_file(document.path.parent, name, inside, document.place(("source", "files", i)))
        for i, name in enumerate(section.files)
    ]
    roots = [
        _library(document.path.parent, name, document.place(("source", "modelica_path", i)))
        for i, name in enumerate(section.modelica_path)
    ]
    tolerance = None
    if section.tolerance is not None:
        where = document.place(("source", "tolerance"))
        tolerance = read_number(section.tolerance, DIMENSIONLESS, where)
        if not _FINEST <= tolerance <= _COARSEST:
            raise fail(f"the tolerance must lie in {_FINEST:g} … {_COARSEST:g}, not {section.tolerance}", where)
    return ModelicaSource(
        section.model,
        tuple(files),
        tuple(roots),
        _one_of(ModelicaCompiler, section.compiler, document.place(("source", "compiler"))),
        _one_of(Solver, section.solver, document.place(("source", "solver"))),
        tolerance,
    )


_CLASS = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)
_FINEST, _COARSEST = 1e-12, 0.1

W = TypeVar("W", ModelicaCompiler, Solver)


def _one_of(words: type[W], written: str | None, where: Location) -> W:
    if written is None:
        return words("auto")
    if written not in list(words):
        raise fail(
            f"unknown {words.__name__.removeprefix('Modelica').lower()} '{written}'", where, closest(written, words)
        )
    return words(written)


def _modelica_file(folder: Path, name: str, inside: Path, where: Location) -> Path:
    path = followed(folder, name, where)
    if is_file(path):
        return named_file(folder, name, inside, (".mo",), where)
    if not path.is_relative_to(inside.resolve()):
        raise fail(f"'{name}' lies outside the workspace", where, "copy it into the workspace, or use modelica_path")
    if not is_file(path / "package.mo"):
        what = f"no package.mo in {shown(path)}" if path.is_dir() else f"no such file or folder: {shown(path)}"
        raise fail(what, where, "paths are relative to this component.yaml")
    return path


def _library(folder: Path, name: str, where: Location) -> Path:
    """A folder of libraries; on this machine, so that it may lie anywhere."""
    path = followed(folder, os.path.expandvars(name), where)
    if not path.is_dir():
        hint = "modelica_path: [/path/to/libraries]; $VARIABLES are replaced"
        raise fail(f"no such folder: {shown(path)}", where, hint)
    return path


def _c_file(folder: Path, name: str, inside: Path, suffixes: tuple[str, ...], where: Location) -> Path:
    return _existing(named_file(folder, name, inside, suffixes, where), where)


def _existing(path: Path, where: Location) -> Path:
    if not is_file(path):
        raise fail(f"no such file: {shown(path)}", where, "paths are relative to this component.yaml")
    return path


def _identifier(name: str, where: Location) -> str:
    if not is_identifier(name):
        raise fail(f"'{name}' is not a C identifier", where)
    return name
