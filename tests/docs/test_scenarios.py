"""docs/scenarios.md: its table of supported elements is that of the code, its YAML that of the shipped example."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from dse.errors import DseError, Location
from dse.formats import XmlElement
from dse.world.openscenario.actions import GLOBAL_ACTIONS, PRIVATE_ACTIONS, SHAPES, WITHOUT_EFFECT
from dse.world.openscenario.conditions import CONDITIONS
from dse.world.openscenario.document import Context, Node
from dse.world.openscenario.positions import POSITIONS, TRAJECTORY_SHAPES, Layout
from dse.world.openscenario.tables import Tables

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "scenarios.md").read_text(encoding="utf-8")
ROWS = {
    "private actions": PRIVATE_ACTIONS - WITHOUT_EFFECT,
    "private actions without effect": PRIVATE_ACTIONS & WITHOUT_EFFECT,
    "global actions": GLOBAL_ACTIONS,
    "conditions": CONDITIONS,
    "positions": POSITIONS,
    "shapes of trajectories": TRAJECTORY_SHAPES,
    "shapes of dynamics": frozenset(SHAPES),
}


def test_the_python_of_the_page_reads_the_shipped_scenario(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT / "components" / "traffic" / "scenario_cut_in")
    exec(TEXT.split("```python\n")[1].split("```")[0], {})  # noqa: S102  # a block of our own page
    entities, parameters, events = capsys.readouterr().out.splitlines()
    assert entities == "('Ego', 'CutIn')"
    assert "('gap', 20.0)" in parameters
    assert events == "[('event', 'CutInStory/CutInAct/CutInGroup/CutInManeuver/CutInEvent')]"


def test_the_components_of_the_page_are_those_that_come_along() -> None:
    for block in TEXT.split("```yaml\n")[1:3]:
        text = block.split("```")[0]
        written = YAML(typ="safe").load(text)
        shipped = YAML(typ="safe").load((ROOT / text.splitlines()[0].removeprefix("# ")).read_text("utf-8"))
        assert {key: shipped[key] for key in ("component", "implements", "source")} == {
            key: written[key] for key in ("component", "implements", "source")
        }
        assert set(written.get("parameters", {})) <= set(shipped["parameters"])


@pytest.mark.parametrize("kind", ROWS)
def test_the_page_lists_what_the_code_supports(kind: str) -> None:
    row = re.search(rf"^\| {kind} \| (.*) \|$", TEXT, re.MULTILINE)
    assert row is not None
    assert re.findall(r"`(\w+)`", row[1]) == sorted(ROWS[kind])


@pytest.mark.parametrize("tag", [*sorted(POSITIONS), "GeoPosition", "Nonsense"])
def test_a_position_is_refused_by_name_just_if_it_is_not_listed(tag: str) -> None:
    where = Location("x.xosc", 7, 3)
    inner = XmlElement(tag, "", {}, "", (), where)
    position = Node(XmlElement("Position", "", {}, "", (inner,), where), {}, Context(Path("x.xosc"), {}, frozenset()))
    with pytest.raises(DseError) as refused:
        Layout(Tables(), {}, None).position(position)
    assert ("is not supported" in str(refused.value)) == (tag not in POSITIONS)
    assert str(refused.value).startswith("x.xosc:7:3: ")
