"""Pictures of components: what stands where, and what a Modelica model is made of."""

from __future__ import annotations

from itertools import combinations, pairwise
from pathlib import Path
from xml.etree import ElementTree as ET  # reads what was written a line before

import pytest

from dse.domain.component import Component
from dse.domain.diagram import Diagram, Link
from dse.loading.workspace import Workspace
from dse.pictures.component import draw_component, lay_out, pictured

COMPONENTS = Path(__file__).parents[2] / "components"


def component(name: str) -> Component:
    return Workspace.around(COMPONENTS).component(name)


def chain(*parts: str) -> Diagram:
    links = tuple(Link((a, b), is_physical=True) for a, b in pairwise(parts))
    return Diagram(parts, ("demand",), ("force",), (*links, Link(("demand", parts[0]), is_physical=False)))


def test_a_driveline_runs_from_left_to_right() -> None:
    layout = lay_out(chain("engine", "gearbox", "shaft", "wheels"), ["demand"], ["force"], "A driveline")
    boxes = list(layout.parts.values())
    assert all(left.right < right.x for left, right in pairwise(boxes))
    assert len({box.middle for box in boxes}) == 1


def test_a_part_without_a_shaft_stands_where_its_signals_go() -> None:
    driveline = chain("engine", "gearbox", "shaft", "wheels")
    watched = Diagram(
        (*driveline.parts, "schedule"),
        driveline.inputs,
        driveline.outputs,
        (*driveline.links, Link(("schedule", "gearbox"), is_physical=False)),
    )
    boxes = lay_out(watched, ["demand"], ["force"], "A driveline").parts
    assert boxes["schedule"].x == boxes["shaft"].x
    assert boxes["wheels"].x > boxes["shaft"].x > boxes["gearbox"].x > boxes["engine"].x


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", ["combustion_6at", "bev_single_speed", "hybrid_dct7", "rex_control", "straight_road"])
def test_nothing_overlaps_and_all_lies_inside(name: str) -> None:
    part = component(name)
    ports = {port.name: port for port in part.interface.ports}
    inputs = [name for name in ports if ports[name].causality == "input"]
    outputs = [name for name in ports if ports[name].causality == "output"]
    layout = lay_out(pictured(part), inputs, outputs, part.title)
    boxes = list(layout.parts.values())
    for one, other in combinations(boxes, 2):
        apart = one.right < other.x or other.right < one.x or abs(one.middle - other.middle) >= one.height
        assert apart, (one, other)
    assert all(layout.frame.x < box.x and box.right < layout.frame.right for box in boxes)
    assert all(0 < middle < layout.height for _, middle in layout.ports.values())
    assert set(layout.ports) == set(ports)


def test_a_picture_shows_the_ports_with_units_and_the_parts() -> None:
    part = component("bev_single_speed")
    root = ET.fromstring(draw_component(part, pictured(part)))  # noqa: S314
    texts = {element.text for element in root.iter() if element.tag.endswith("text")}
    assert {"wheel_speed.front [rad/s]", "co2 [kg/s]", "machine", "battery", "axle", part.title} <= texts


def test_a_picture_escapes_what_users_write() -> None:
    part = component("pd_acc")
    named = Component(part.name, part.interface, title='<b>"P&D"</b>')
    root = ET.fromstring(draw_component(named, Diagram(())))  # noqa: S314
    assert '<b>"P&D"</b>' in [element.text for element in root.iter()]


def test_physical_connections_are_told_from_signals() -> None:
    found = pictured(component("combustion_6at"))
    physical = {link.ends for link in found.links if link.is_physical}
    assert {("engine", "gearbox"), ("shaft", "wheels")} <= physical
    assert ("engine", "torque_demand") not in physical
    assert any("torque_demand" in link.ends for link in found.links)


@pytest.mark.thorough
def test_the_library_names_every_component_and_shows_pictures_as_they_are_drawn_today() -> None:
    library, shown = Workspace.around(COMPONENTS), (COMPONENTS / "README.md").read_text(encoding="utf-8")
    assert [name for name in library.component_files if f"**{name}**" not in shown] == []
    for file in (COMPONENTS / "pictures").glob("*.svg"):
        part = library.component(file.stem)
        assert file.read_text(encoding="utf-8") == draw_component(part, pictured(part)), (
            f"dse components --graph components/pictures: {file.stem} has changed"
        )
        assert f"(pictures/{file.name})" in shown


def test_the_values_of_an_array_share_a_row() -> None:
    text = draw_component(component("pure_pursuit"), Diagram(()))
    assert text.count("preview[24].x [m]") == 1
    assert "preview[1]" not in text
