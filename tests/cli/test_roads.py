"""Roads on the command line: started, checked, drawn, written for others."""

from __future__ import annotations

import pytest
from defusedxml import ElementTree


@pytest.mark.thorough
def test_a_road_is_started_drawn_and_written(dse_in, tmp_path):
    done = dse_in(tmp_path, "new", "road", "mine")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("roads/mine.yaml\n")
    (tmp_path / "components").mkdir()
    drawn = dse_in(tmp_path, "figure", "mine", "-o", "pictures", "--format", "svg")
    assert drawn.stdout == "pictures/mine.svg\n", drawn.stderr
    assert ElementTree.parse(tmp_path / "pictures" / "mine.svg").getroot().tag.endswith("svg")
    written = dse_in(tmp_path, "export", "opendrive", "mine", "-o", "mine.xodr")
    assert written.stdout == "mine.xodr: mine\n"
    drawn = dse_in(tmp_path, "figure", "mine.xodr")
    assert drawn.stdout == "out/figures/mine.png\n", drawn.stderr


def test_check_reads_roads_of_both_kinds_and_tells_what_is_wrong(dse_in, tmp_path):
    (tmp_path / "components").mkdir()
    assert dse_in(tmp_path, "new", "road", "mine").returncode == 0
    assert dse_in(tmp_path, "export", "opendrive", "mine", "-o", "roads/theirs.xodr").returncode == 0
    assert "2 roads" in dse_in(tmp_path, "check").stdout
    text = (tmp_path / "roads" / "mine.yaml").read_text(encoding="utf-8")
    (tmp_path / "roads" / "mine.yaml").write_text(text.replace("radius: 120 m", "radius: 12 m"), encoding="utf-8")
    theirs = (tmp_path / "roads" / "theirs.xodr").read_text(encoding="utf-8")
    (tmp_path / "roads" / "theirs.xodr").write_text(theirs.replace("<spiral", "<spirale"), encoding="utf-8")
    done = dse_in(tmp_path, "check")
    assert done.returncode == 1
    assert "roads/mine.yaml:8:67: spirals of 40 m and 40 m turn by more than the angle" in done.stderr
    assert "roads/theirs.xodr:" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("figure nowhere", "nowhere"),
        ("export opendrive straigt -o x.xodr", "did you mean 'straight'?"),
        ("export opendrive straight -o x.xml", "must end in .xodr"),
        ("figure straight --drive nothing.csv", "nor a file of waveforms"),
    ],
)
def test_what_cannot_be_drawn_or_written_is_named(dse, line, what):
    done = dse(*line.split())
    assert done.returncode in (1, 2)
    assert what in done.stderr
    assert "Traceback" not in done.stderr
