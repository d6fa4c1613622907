"""Which folders a name in a request can mean."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from dse.errors import DseError
from dse.serving.study_index import StudyIndex


def test_studies_are_found_below_a_folder_and_named_by_their_way(workshop: Path) -> None:
    assert [*StudyIndex(workshop).studies] == ["out/first", "out/second", "out/torn"]
    assert [*StudyIndex(workshop / "out").studies] == ["first", "second", "torn"]


def test_a_study_by_itself_has_its_folder_s_name(workshop: Path) -> None:
    assert [*StudyIndex(workshop / "out" / "first").studies] == ["first"]


@pytest.mark.parametrize(
    "name",
    [
        "",
        ".",
        "..",
        "../work/out/first",
        "out/first/",
        "/out/first",
        "out/../out/first",
        "out\\first",
        "out",
        "out/first\0",
    ],
)
def test_a_name_is_one_of_the_list_or_nothing(workshop: Path, name: str) -> None:
    with pytest.raises(DseError, match="there is no such study"):
        StudyIndex(workshop).folder(name)


@pytest.mark.skipif(os.name == "nt", reason="links need a privilege there")
def test_links_lead_nowhere(workshop: Path, tmp_path: Path) -> None:
    (workshop / "elsewhere").symlink_to(workshop / "out")
    assert [*StudyIndex(workshop).studies] == ["out/first", "out/second", "out/torn"]


def test_hidden_folders_and_the_depths_are_left_alone(workshop: Path) -> None:
    for place in (".hidden", "a/b/c/d/e"):
        (workshop / place).mkdir(parents=True)
        (workshop / place / "study.sqlite").touch()
    assert len(StudyIndex(workshop).studies) == 3


def test_what_is_no_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(DseError, match="there is no such folder"):
        StudyIndex(tmp_path / "missing")
