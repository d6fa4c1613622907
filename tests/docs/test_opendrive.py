"""docs/opendrive.md: its Python runs, on a file that its YAML could name."""

from pathlib import Path

import pytest
from opendrive_texts import geometry, lane, opendrive, road, section, to_road

TEXT = (Path(__file__).parents[2] / "docs" / "opendrive.md").read_text(encoding="utf-8")


def test_the_python_of_the_page_lists_ways_and_makes_a_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    roads = ""
    for number, (before, id_, after) in enumerate((("", "1", "12"), ("1", "12", "7"), ("12", "7", ""))):
        link = (to_road("predecessor", before, "end") if before else "") + (
            to_road("successor", after, "start") if after else ""
        )
        lanes = section(0.0, "", lane(-1, before=-1 if before else 0, after=-1 if after else 0))
        roads += road(id_, geometry(0.0, 50.0 * number, 0.0, 0.0, 50.0), 50.0, lanes, link=link)
    (tmp_path / "town.xodr").write_text(opendrive(roads), "utf-8")
    monkeypatch.chdir(tmp_path)
    block = TEXT.split("```python\n")[1].split("```")[0]
    made: dict[str, object] = {}
    exec(block, made)  # noqa: S102  # a block of our own page
    assert capsys.readouterr().out == "('1', '12', '7') -1 False\n"
    assert made["path"].length == 150.0  # type: ignore[attr-defined]
