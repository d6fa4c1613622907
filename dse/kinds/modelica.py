"""``source: {kind: modelica}``: a model of a Modelica library."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from dse.domain.component import Component, ModelicaCompiler, ModelicaSource, Solver
from dse.errors import Location, Problem, closest, fail
from dse.formats import shown
from dse.loading import ComponentKind, Plain, SourcePlace, SourceSection, is_file

if TYPE_CHECKING:
    from dse.domain.diagram import Diagram


class ModelicaSection(SourceSection):
    """The keys of ``source``."""

    model: str | None = None
    files: list[str] = []
    modelica_path: list[str] = []
    compiler: str | None = None
    solver: str | None = None
    tolerance: Plain | None = None


class ModelicaKind(ComponentKind[ModelicaSection, ModelicaSource]):
    """Models are translated to C, by dse or by OpenModelica."""

    section = ModelicaSection

    def read(self, section: ModelicaSection, place: SourcePlace) -> ModelicaSource:
        """A class of the files of the workspace, with libraries that may lie anywhere."""
        if section.model is None:
            raise place.missing("model", "model: Package.Model")
        if not _CLASS.fullmatch(section.model):
            what = f"'{section.model}' is not a name of a Modelica class"
            raise fail(what, place.at("model"), "model: Package.Model")
        if not section.files and not section.modelica_path:
            raise place.missing("files", "files: [model.mo], or a folder with a package.mo")
        files = [_file(name, place, i) for i, name in enumerate(section.files)]
        roots = [_library(name, place, i) for i, name in enumerate(section.modelica_path)]
        tolerance = None
        if section.tolerance is not None:
            tolerance = place.number(section.tolerance, "", "tolerance")
            if not _FINEST <= tolerance <= _COARSEST:
                what = f"the tolerance must be in {_FINEST:g} … {_COARSEST:g}, not {section.tolerance}"
                raise fail(what, place.at("tolerance"))
        return ModelicaSource(
            section.model,
            tuple(files),
            tuple(roots),
            _one_of(ModelicaCompiler, section.compiler, place.at("compiler")),
            _one_of(Solver, section.solver, place.at("solver")),
            tolerance,
        )

    def build(self, component: Component, source: ModelicaSource, *, version: int, cache: Path | None) -> Path:
        """The FMU. Raises DseError with what neither dse nor OpenModelica can translate."""
        from dse.modelica import build_modelica

        return build_modelica(component, source, version, cache)

    def check(self, component: Component, source: ModelicaSource) -> tuple[Problem, ...]:
        """Who translates the model, if not dse. Raises DseError with all that is wrong; needs no C compiler."""
        from dse.modelica import check_modelica

        return check_modelica(component, source)

    def diagram(self, component: Component, source: ModelicaSource) -> Diagram:
        """The model's parts and connections."""
        from dse.modelica import read_diagram

        return read_diagram(component, source)


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


def _file(name: str, place: SourcePlace, number: int) -> Path:
    where = place.at("files", number)
    path = place.path(name, "files", number)
    if is_file(path):
        return place.file(name, (".mo",), "files", number)
    if not path.is_relative_to(place.inside.resolve()):
        raise fail(f"'{name}' is outside the workspace", where, "copy it into the workspace, or use modelica_path")
    if not is_file(path / "package.mo"):
        what = f"no package.mo in {shown(path)}" if path.is_dir() else f"no such file or folder: {shown(path)}"
        raise fail(what, where, "paths are relative to this component.yaml")
    return path


def _library(name: str, place: SourcePlace, number: int) -> Path:
    """A folder of libraries; on this machine, so that it may lie anywhere."""
    where = place.at("modelica_path", number)
    path = place.path(os.path.expandvars(name), "modelica_path", number)
    if not path.is_dir():
        hint = "modelica_path: [/path/to/libraries]; $VARIABLES are replaced"
        raise fail(f"no such folder: {shown(path)}", where, hint)
    return path


KIND = ModelicaKind()
