"""What is wrong with a road is told with its place and how to mend it."""

from __future__ import annotations

import pytest

from dse.errors import DseError
from dse.loading import Workspace
from dse.world import opendrive_of

CASES = [
    # what stands below `segments:`, line:column, what, hint
    ("  - straight: 10 kg", "3:15", "wrong unit in '10 kg'", "write it in m"),
    ("  - straight: -5 m", "3:15", "'straight' cannot be -5 m", "from 0.1 m to 100000 m"),
    ("  - straigt: 5 m", "3:5", "unknown key 'straigt'", "did you mean 'straight'?"),
    ("  - lanes: 2", "3:5", "the segment does not define its shape", "give one of straight, curve"),
    ("  - {straight: 5 m, hill: {grade: 5 %, radius: 1 km}}", "3:5", "is straight and hill at once", "give one of"),
    ("  - curve: {radius: 120 m}", "3:5", "'angle' is missing", "add 'angle"),
    ("  - curve: {radius: 1 m, angle: 90 deg}", "3:21", "'radius' cannot be 1 m", "from 2 m"),
    ("  - curve: {radius: 120 m, angle: 20 deg, spiral: 60 m}", "3:51", "spirals of 60 m and 60 m turn by more", "at most 41.888 m each"),
    ("  - curve: {radius: 120 m, angle: 20 deg, bank: 5 %}", "3:49", "needs spirals", "add 'spiral"),
    ("  - curve: {radius: 120 m, angle: 20 deg, direction: lef}", "3:54", "'direction' cannot be 'lef'", "did you mean 'left'?"),
    ("  - curve: {radius: 120 m, angle: 20 deg, spiral: [1 m, 2 m, 3 m]}", "3:51", "'spiral' has two lengths", "[60 m, 40 m]"),
    ("  - hill: {grade: 0 %, radius: 1 km}", "3:19", "a hill without a grade", "grade: 5 %"),
    ("  - {straight: 50 m, grade: 3 %}\n  - {straight: 50 m, grade: -5 %}", "4:29", "takes 80.0 m of road", "a smaller 'rounding'"),
    ("  - {straight: 50 m, grade: 3 %}\n  - hill: {grade: 5 %, radius: 1 km}", "4:5", "a hill begins level", "'grade: 0'"),
    ("  - {straight: 50 m, grade: 3 %}\n  - intersection: {arms: 4}", "4:5", "a crossing is level", "'grade: 0'"),
    ("  - {straight: 50 m, height: [0.1, 0, 0]}\n  - {straight: 50 m, height: [0, 0, 0]}", "4:31", "grade of 0.1, and continues with 0", "write 0.1: a road has no kinks"),
    ("  - {straight: 50 m, height: [0.1, 0]}", "3:30", "the factors of s, s² and s³", "height: ["),
    ("  - {straight: 50 m, rounding: 1 km}", "3:22", "'rounding' is that of a change", "add 'grade"),
    ("  - {straight: 50 m, lanes: 2}", "3:22", "are defined above its segments", "move them there"),
    ("  - straight: 50 m\n  - {straight: 50 m, lanes: 2}", "4:22", "but not within which length", "add 'widening"),
    ("  - straight: 50 m\n  - {straight: 50 m, lanes: 2, widening: 60 m}", "4:42", "'widening' cannot be 60 m", "from 1 m to 50 m"),
    ("  - straight: 50 m\n  - {straight: 50 m, widening: 60 m}", "4:22", "nothing widens here", "remove it"),
    ("  - {straight: 50 m, friction: [{along: [40 m, 60 m], friction: 0.1}]}", "3:48", "'along' cannot be 60 m", "from 0 m to 50 m"),
    ("  - {straight: 50 m, friction: [{along: [40 m, 20 m], friction: 0.1}]}", "3:41", "ends before it starts", "[20 m, 40 m]"),
    ("  - {straight: 50 m, friction: [{along: [1 m, 9 m], friction: 0.1}, {along: [5 m, 20 m], friction: 0.2}]}", "3:32", "patches across the whole road overlap", "let one end"),
    ("  - intersection: {arms: 4}", "3:5", "needs a stretch of road that leads there", "- straight: 100 m"),
    ("  - straight: 50 m\n  - intersection: {arms: 5}", "4:26", "5 arms are not supported", "3 or 4"),
    ("  - straight: 50 m\n  - intersection: {side: left}", "4:20", "with four arms there is one at each side", "arms: 3"),
    ("  - straight: 50 m\n  - intersection: {arms: 3, exit: left}", "4:35", "'exit' cannot be 'left'", "possible: right, straight"),
    ("  - straight: 50 m\n  - intersection: {lights: {cycle: 10 s}}", "4:36", "no time is left for green", "more than 10 s"),
    ("  - straight: 50 m\n  - {intersection: {}, friction: []}\n  - intersection: {}", "5:5", "needs a stretch", "straight"),
    ("  - straight: 50 m\n  - roundabout: {radius: 5 m}", "4:26", "'radius' cannot be 5 m", "from 10.5 m to 200 m"),
    ("  []", "3:3", "the road has no segments", "straight: 200 m"),
]  # fmt: skip


@pytest.mark.parametrize(("segments", "place", "what", "hint"), CASES, ids=[case[2] for case in CASES])
def test_a_mistake_is_named_at_its_place_with_a_hint(tmp_path, segments, place, what, hint):
    (tmp_path / "road.yaml").write_text(f"road: road\nsegments:\n{segments}\n", encoding="utf-8")
    with pytest.raises(DseError) as caught:
        opendrive_of(Workspace(tmp_path).road(str(tmp_path / "road.yaml")))
    (problem,) = caught.value.problems
    assert what in problem.what
    assert hint in problem.hint
    assert f"{problem.where.line}:{problem.where.column}" == place


def test_all_mistakes_of_a_file_are_told_at_once(tmp_path):
    text = (
        "road: road\nlanes: 9\nspeed_limit: 50 kg\nsegments:\n  - curve: {radius: 0 m, angle: 9 deg}\n"
        "  - {straight: 50 m, friction: [{along: [1 m], friction: 0.1}, {along: [1 m, 2 m], friction: 7}]}\n"
    )
    (tmp_path / "road.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(DseError) as caught:
        Workspace(tmp_path).road(str(tmp_path / "road.yaml"))
    assert [problem.where.line for problem in caught.value.problems] == [2, 3, 5, 6, 6]
