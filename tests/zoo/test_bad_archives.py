"""FMUs that cannot even be opened: told before a study begins, all at once, each by its file."""

from __future__ import annotations

from pathlib import Path

import pytest

from dse.errors import DseError
from dse.fmu.unpack import open_fmu
from dse.testbench.study import prepare_study
from zoo.bad_archives import BAD_ARCHIVES, build_bad
from zoo.workspace import lay_out


@pytest.fixture(scope="module")
def archives(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bad")
    for name in BAD_ARCHIVES:
        build_bad(name, folder)
    return folder


@pytest.mark.parametrize("name", BAD_ARCHIVES)
def test_a_bad_archive_is_refused_by_name_and_leaves_nothing(name: str, archives: Path, tmp_path: Path) -> None:
    cache = tmp_path / "deep" / "down" / "cache"
    with pytest.raises(DseError) as caught:
        open_fmu(archives / f"{name}.fmu", cache=cache)
    assert f"{name}.fmu" in str(caught.value)
    assert BAD_ARCHIVES[name][1] in str(caught.value)
    assert not [file for file in tmp_path.rglob("*") if file.name == "evil"]
    assert not Path("/tmp/evil").exists()  # noqa: S108  # where it would be
    # Not even half of it is left to be found by the next one who asks.
    with pytest.raises(DseError) as again:
        open_fmu(archives / f"{name}.fmu", cache=cache)
    assert str(again.value) == str(caught.value)


def test_a_study_is_told_of_all_bad_archives_at_once_and_does_not_begin(archives: Path, tmp_path: Path) -> None:
    workspace = lay_out(tmp_path / "work", ["tame"], {name: archives / f"{name}.fmu" for name in BAD_ARCHIVES})
    with pytest.raises(DseError) as caught:
        prepare_study(workspace.study("zoo"), cache=tmp_path / "cache")
    for name in BAD_ARCHIVES:
        concerned = [str(problem) for problem in caught.value.problems if name in str(problem)]
        assert len(concerned) == 1, name
        assert BAD_ARCHIVES[name][1] in concerned[0]
    assert len(caught.value.problems) == len(BAD_ARCHIVES)
