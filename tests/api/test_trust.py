"""Which workspaces are simulated for a study: none that only came with it."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from command_line import run_dse

import dse
from dse.api import replay, trust
from dse.api.studies import provenance as module
from dse.api.studies.replay import benches_of
from dse.errors import DseError
from dse.loading import Workspace


@pytest.fixture
def brought(folder: Path, tmp_path: Path) -> Path:
    """A folder that somebody sent: a workspace, and a study in it."""
    return Path(shutil.copytree(folder, tmp_path / "brought"))


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, and a cache in which nothing is trusted."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    monkeypatch.setattr(module, "cache_folder", lambda: tmp_path / "cache")
    return tmp_path / "elsewhere"


def found(near: Path, given: Path | None = None) -> Path:
    def look(workspace: Workspace) -> Path:
        workspace.bench("acc_following")
        return workspace.root

    return module.in_workspace(near, look, given)


def test_a_workspace_that_came_with_a_study_is_not_used(brought: Path, results: dse.Results) -> None:
    with pytest.raises(DseError, match=r"brought: this workspace came with the study and is not trusted"):
        module.benches_near(results.definition, brought / "testbenches")


def test_it_is_used_when_it_is_trusted_until_a_file_in_it_changes(brought: Path) -> None:
    (brought / "out").mkdir(exist_ok=True)
    trust(brought / "out")
    (brought / "out" / "report.html").write_text("a result")
    assert found(brought / "out") == brought
    header = min(brought.rglob("*.c"))
    header.write_text(header.read_text("utf-8") + "/* and more */", "utf-8")
    with pytest.raises(DseError, match="not trusted"):
        found(brought)


def test_where_links_lead_is_part_of_what_is_trusted(brought: Path) -> None:
    (brought / "components" / "more").symlink_to("acc_pid")
    trust(brought)
    (brought / "components" / "more").unlink()
    (brought / "components" / "more").symlink_to("../../elsewhere")
    with pytest.raises(DseError, match="not trusted"):
        found(brought)


def test_it_is_used_where_it_is_named_or_the_command_is_started_in_it(
    brought: Path, elsewhere: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert found(elsewhere, brought) == brought
    monkeypatch.chdir(brought / "components")
    assert found(elsewhere) == brought


def test_a_workspace_in_a_study_folder_is_not_trusted_by_being_entered(
    brought: Path, results: dse.Results, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(results.folder / "study.sqlite", brought)
    monkeypatch.chdir(brought)
    with pytest.raises(DseError, match="not trusted"):
        found(brought)
    with pytest.raises(DseError, match="not trusted"):
        benches_of(results.definition, None)


def test_a_study_cannot_name_files_of_a_workspace(brought: Path, results: dse.Results) -> None:
    from dataclasses import replace

    named = replace(results.definition, study=str(brought / "testbenches" / "acc_gains.pet.yaml"))
    with pytest.raises(DseError, match="unknown study"):
        module.benches_near(named, Path(), brought)


@pytest.mark.thorough
def test_the_command_line_says_what_is_trusted_and_refuses_what_is_none(brought: Path, tmp_path: Path) -> None:
    done = run_dse(brought, "trust", cache=tmp_path / "cache")
    assert done.stdout == f"trusted as it is now: {brought}\n"
    assert found(brought) == brought
    assert "not in a workspace" in run_dse(tmp_path, "trust", cache=tmp_path / "cache").stderr


def test_a_replay_says_what_has_changed_before_it_simulates(brought: Path, results: dse.Results) -> None:
    bench = brought / "testbenches" / "acc_following.yaml"
    bench.write_text(bench.read_text("utf-8").replace("at_most: 0.1 %", "at_most: 1 %"), "utf-8")
    source = brought / "testbenches" / results.definition.study
    changes: list[tuple[str, ...]] = []

    def stop(changed: tuple[str, ...]) -> None:
        changes.append(changed)
        raise InterruptedError

    with pytest.raises(InterruptedError):
        replay(results.run(0), source=f"{source}.pet.yaml", on_changed=stop)
    assert changes == [("requirement R1",)]
