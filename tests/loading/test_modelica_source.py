"""``source: {kind: modelica}`` in component.yaml: what it means, and what is wrong with it where."""

from __future__ import annotations

from pathlib import Path

import pytest

from dse.domain.component import ModelicaCompiler, ModelicaSource, Solver
from dse.errors import DseError
from dse.loading.workspace import Workspace

INTERFACES = "interfaces:\n  plant:\n    inputs: {u: N.m}\n    outputs: {y: m}\n"
COMPONENT = """\
component: lag
implements: plant
source: {source}
"""


def workspace(folder: Path, source: str) -> Workspace:
    lag = folder / "components" / "lag"
    package = folder / "components" / "Library"
    for made in (lag, package, folder / "components" / "empty"):
        made.mkdir(parents=True)
    (folder / "components" / "interfaces.yaml").write_text(INTERFACES, encoding="utf-8")
    (package / "package.mo").write_text("package Library end Library;", encoding="utf-8")
    (lag / "lag.mo").write_text("model Lag end Lag;", encoding="utf-8")
    (lag / "lag.c").write_text("", encoding="utf-8")
    (lag / "component.yaml").write_text(COMPONENT.replace("{source}", source), encoding="utf-8")
    return Workspace.around(folder)


def read(folder: Path, source: str) -> ModelicaSource:
    found = workspace(folder, source).component("lag").source
    assert isinstance(found, ModelicaSource)
    return found


def test_a_model_in_files_and_packages(tmp_path: Path) -> None:
    found = read(tmp_path, "{kind: modelica, model: Library.Lag, files: [lag.mo, ../Library]}")
    folder = tmp_path.resolve() / "components"
    assert found == ModelicaSource("Library.Lag", (folder / "lag" / "lag.mo", folder / "Library"))
    assert (found.compiler, found.solver, found.tolerance) == (ModelicaCompiler.AUTO, Solver.AUTO, None)


def test_every_setting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    libraries = tmp_path / "libraries"
    libraries.mkdir()
    monkeypatch.setenv("LIBRARIES", str(libraries))
    keys = "compiler: omc, solver: stiff, tolerance: 1e-8"
    found = read(
        tmp_path / "w", f"{{kind: modelica, model: Lag, files: [lag.mo], modelica_path: [$LIBRARIES], {keys}}}"
    )
    assert found.roots == (libraries.resolve(),)
    assert (found.compiler, found.solver, found.tolerance) == (ModelicaCompiler.OMC, Solver.STIFF, 1e-8)


@pytest.mark.parametrize(
    ("source", "place", "what", "hint"),
    [
        ("{kind: modelica, files: [lag.mo]}", "3:1", "'model' is missing", "model: Package.Model"),
        ("{kind: modelica, model: Lag}", "3:1", "'files' is missing", "package.mo"),
        ("{kind: modelica, model: a b, files: [lag.mo]}", "3:33", "'a b' is not a name of a Modelica class", ""),
        ("{kind: modelica, model: Lag, files: [gone.mo]}", "3:46", "no such file or folder", "relative to this"),
        ("{kind: modelica, model: Lag, files: [../empty]}", "3:46", "no package.mo in", ""),
        ("{kind: modelica, model: Lag, files: [lag.c]}", "3:46", "'lag.c' must be a .mo file", ""),
        ("{kind: modelica, model: Lag, files: [/]}", "3:46", "is outside the workspace", "modelica_path"),
        ("{kind: modelica, model: Lag, files: [lag.mo], modelica_path: [gone]}", "3:71", "no such folder", ""),
        ("{kind: modelica, model: Lag, files: [lag.mo], compiler: dymola}", "3:65", "unknown compiler 'dymola'", "omc"),
        ("{kind: modelica, model: Lag, files: [lag.mo], solver: stif}", "3:63", "unknown solver 'stif'", "'stiff'"),
        ("{kind: modelica, model: Lag, files: [lag.mo], tolerance: 1}", "3:66", "tolerance must be in", ""),
        ("{kind: modelica, model: Lag, files: [lag.mo], step: 10 ms}", "3:55", "unknown key 'step'", "tolerance"),
        ("{kind: c, files: [lag.c], model: Lag}", "3:35", "unknown key 'model'", "header"),
        ("{kind: modelca, model: Lag}", "3:16", "unknown component kind 'modelca'", "did you mean 'modelica'?"),
    ],
)
def test_what_is_wrong_is_told_where_it_stands(tmp_path: Path, source: str, place: str, what: str, hint: str) -> None:
    with pytest.raises(DseError) as caught:
        workspace(tmp_path, source).component("lag")
    told = str(caught.value)
    assert what in told
    assert hint in told
    assert f"component.yaml:{place}: " in told
