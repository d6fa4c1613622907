"""What a scenario declares twice, or finds by another name."""

from __future__ import annotations

from pathlib import Path

import pytest
from scenario_texts import car, catalog, declared, private, scenario, speed, teleport, world
from workspaces import written

from dse.errors import DseError
from dse.world.openscenario.scenario import read_scenario

CAR = car("x").removeprefix('<ScenarioObject name="x">').removesuffix("</ScenarioObject>\n")


def test_of_two_declarations_of_a_parameter_the_last_holds(tmp_path: Path) -> None:
    text = scenario(car("Ego"), private("Ego", teleport(world("$x", 0))), parameters=declared(x=10) + declared(x=20))
    read = read_scenario(written(tmp_path, {"a.xosc": text}) / "a.xosc")
    assert [(each.name, each.start) for each in read.parameters] == [("x", 20)]
    assert (
        len([each for each in read.ignored if "'x' was declared before; the last declaration holds" in str(each)]) == 1
    )


def test_an_entry_is_found_by_the_name_of_its_file_too(tmp_path: Path) -> None:
    entity = '<ScenarioObject name="Ego"><CatalogReference catalogName="CarFile" entryName="car"/></ScenarioObject>'
    places = '<VehicleCatalog><Directory path="cars"/></VehicleCatalog>'
    text = scenario(entity, private("Ego", speed(1)), catalogs=places)
    written(tmp_path, {"a.xosc": text, "cars/CarFile.xosc": catalog("cars", CAR)})
    assert read_scenario(tmp_path / "a.xosc").entities == ("Ego",)


def test_times_that_a_line_lacks_are_not_needed(tmp_path: Path) -> None:
    line = f"<Polyline><Vertex>{world(0, 0)}</Vertex><Vertex>{world(9, 0)}</Vertex></Polyline>"
    followed = (
        '<PrivateAction><RoutingAction><FollowTrajectoryAction><Trajectory name="l" closed="false"><Shape>'
        f"{line}</Shape></Trajectory><TimeReference><Timing domainAbsoluteRelative='absolute' scale='1' offset='0'/>"
        "</TimeReference></FollowTrajectoryAction></RoutingAction></PrivateAction>"
    )
    text = scenario(car("Ego"), private("Ego", teleport(world(0, 0)), followed))
    read = read_scenario(written(tmp_path, {"a.xosc": text}) / "a.xosc")
    assert any("no times" in str(each) for each in read.ignored)


def towing(name: str, trailer: str) -> str:
    return car(name).replace("</Vehicle>", f'<Trailer><TrailerRef entityRef="{trailer}"/></Trailer></Vehicle>')


@pytest.mark.parametrize(
    ("entities", "message"),
    [
        ((towing("A", "C"),), "the trailer 'C' is no entity"),
        ((towing("A", "B"), towing("B", "A")), "the trailer 'A' has a tow already, or is its own"),
        ((towing("A", "C"), towing("B", "C"), car("C")), "the trailer 'C' has a tow already, or is its own"),
    ],
)
def test_trailers_that_cannot_be_drawn_are_refused(tmp_path: Path, entities: tuple[str, ...], message: str) -> None:
    written(tmp_path, {"a.xosc": scenario("".join(entities))})
    with pytest.raises(DseError, match=message):
        read_scenario(tmp_path / "a.xosc")


def test_a_trailer_may_stand_before_its_tow(tmp_path: Path) -> None:
    written(tmp_path, {"a.xosc": scenario(car("B") + towing("A", "B"))})
    rows = read_scenario(tmp_path / "a.xosc").tables.rows["entities"]
    assert [row["tow"] for row in rows if isinstance(row, dict)] == [1, -1]
