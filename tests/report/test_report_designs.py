"""What the page is told to compare designs with: properties, objectives, and what hangs on what."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping

import numpy as np
from known_functions import study, variable

from dse.domain.definition import DefinedConfiguration, DefinedObjective, DefinedTotal
from dse.report.content.architecture import parts_and_links
from dse.report.content.data import ConfigurationEntry, MetricColumn, ObjectiveEntry, Property, ReportContent
from dse.report.content.objectives import composites_of, objectives_of
from dse.report.content.reading import lacking
from dse.report.page.designs import designs_of
from dse.report.page.encoding import Block
from dse.report.page.payload import payload_of


class Numbers(Block):
    """A block that keeps what was added, to be looked at."""

    def __init__(self) -> None:
        super().__init__()
        self.added: dict[str, list[float]] = {}

    def add(self, name: str, kind: str, values: np.ndarray) -> None:
        super().add(name, kind, values)
        self.added[name] = values.tolist()


def with_properties(content: ReportContent, *given: Mapping[str, Property]) -> ReportContent:
    entries = tuple(ConfigurationEntry(f"c{place}", {}, properties) for place, properties in enumerate(given))
    runs = dataclasses.replace(content.runs, configurations=("c0",) * len(content.runs))
    return dataclasses.replace(content, configurations=entries, runs=runs)


def test_a_property_is_one_number_per_configuration_in_one_unit(scattered: ReportContent) -> None:
    mass, none = {"mass": Property(2.0, "kg")}, dict[str, Property]()
    columns = Numbers()
    document = designs_of(with_properties(scattered, mass, none, {"mass": Property(500.0, "g")}), columns)
    assert document["properties"] == [{"name": "mass", "title": "mass", "unit": "kg", "isPrice": False}]
    assert np.array(columns.added["property.0"]).tolist()[::2] == [2.0, 0.5]
    assert np.isnan(columns.added["property.0"][1])


def test_objectives_name_the_columns_they_are_about(scattered: ReportContent) -> None:
    content = dataclasses.replace(
        with_properties(scattered, {"cost": Property(1.0, "EUR"), "mass": Property(2.0, "kg")}),
        objectives=(
            ObjectiveEntry("mass", is_property=True),
            ObjectiveEntry("peak_deceleration", maximize=True),
            ObjectiveEntry("sum(cost) + 2 * peak_deceleration"),
        ),
        composites=(MetricColumn("sum(cost) + 2 * peak_deceleration", "both", "", np.ones(len(scattered.runs))),),
    )
    columns = Numbers()
    assert designs_of(content, columns)["objectives"] == [
        {"column": "property.1", "maximize": False},
        {"column": "metric.2", "maximize": True},
        {"column": "composite.0", "maximize": False},
    ]
    assert columns.added["composite.0"] == [1.0] * len(scattered.runs)


def test_an_objective_that_nothing_has_a_value_of_is_left_out(scattered: ReportContent) -> None:
    content = dataclasses.replace(scattered, objectives=(ObjectiveEntry("range", is_property=True),))
    assert designs_of(content, Numbers())["objectives"] == []


def test_parts_are_linked_by_the_longest_path_that_owns_a_wire() -> None:
    entry = DefinedConfiguration(
        "c",
        components={"drive": "rear_drive", "drive.gear": "gear_10", "sensor": "radar"},
        start={"world": {}, "drive": {}, "drive.gear": {}, "sensor": {}},
        wires=(
            "world.scene.range -> sensor.scene.range",
            "drive.gear.ratio.value -> drive.ratio",
            "drive.torque -> drive.gear.torque",
            "drive.a -> drive.b",
            "sensor.target -> gone.target",
        ),
    )
    parts, links = parts_and_links(entry)
    assert parts == {"drive": "rear_drive", "drive.gear": "gear_10", "sensor": "radar", "world": ""}
    assert sorted(map(sorted, links)) == [["drive", "drive.gear"], ["sensor", "world"]]


def test_configurations_that_hang_together_alike_share_a_picture(scattered: ReportContent) -> None:
    def entry(name: str, parts: dict[str, str], links: tuple[tuple[str, str], ...]) -> ConfigurationEntry:
        return ConfigurationEntry(name, {}, {}, parts, links)

    long = "a_sensor_with_a_long_name"
    two, chain = (("sensor", "world"),), (("sensor", "video"), ("sensor", "world"))
    entries = (
        entry("c0", {"sensor": "radar", "world": ""}, two),
        entry("c1", {"sensor": long, "world": ""}, two),
        entry("c2", {"sensor": "radar", "video": "camera", "world": ""}, chain),
        entry("c3", {}, ()),
    )
    runs = dataclasses.replace(scattered.runs, configurations=("c0",) * len(scattered.runs))
    document = json.loads(payload_of(dataclasses.replace(scattered, configurations=entries, runs=runs)).document)
    assert document["pictureOf"] == [0, 0, 1, -1]
    components = document["components"]
    assert [[components[code] for code in parts] for parts in document["partsOf"]] == [
        ["radar", ""],
        [long, ""],
        ["radar", "camera", ""],
        [],
    ]
    first = document["pictures"][0]
    assert [part[0] for part in first["parts"]] == ["sensor", "world"]
    assert first["links"] == [[0, 1]]
    # The box has room for the longest name in it.
    assert first["parts"][0][3] > 6 * len(long)


def test_an_objective_that_is_an_expression_is_computed_for_every_run() -> None:
    table = study(
        np.array([[0.1], [0.2]]),
        {"use": np.array([3.0, np.nan])},
        variables=[variable("gain")],
        choices=[{"motor": "small"}, {"motor": "large"}],
    )
    prices = {"small": 10.0, "large": 40.0}
    priced = tuple(
        dataclasses.replace(each, totals={"cost": DefinedTotal(prices[each.choices["motor"]], "EUR")})
        for each in table.header.definition.configurations
    )
    text = "sum(cost) * (1 + use)"
    objectives = (DefinedObjective("use"), DefinedObjective(text, maximize=True, is_composite=True))
    definition = dataclasses.replace(table.header.definition, configurations=priced, objectives=objectives)
    table = dataclasses.replace(table, header=dataclasses.replace(table.header, definition=definition))
    (composite,) = composites_of(definition, table)
    assert (composite.name, composite.unit_symbol) == (text, "EUR")
    assert composite.values[0] == 40.0
    assert np.isnan(composite.values[1])
    assert objectives_of(definition) == (ObjectiveEntry("use"), ObjectiveEntry(text, maximize=True))


def test_configurations_of_a_study_without_variables_lack_none() -> None:
    table = study(np.zeros((2, 0)), {"use": np.ones(2)}, variables=[], choices=[{"motor": "a"}, {"motor": "b"}])
    assert lacking(table.header) == []
