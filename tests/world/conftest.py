"""Roads as the parts that `components.conftest` runs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from components.conftest import WORKSPACE, Shelf

from dse.domain.component import Component, CSource, Kind, Parameter, Type
from dse.world import Conflict, RoadPath, RoadTables, road_files

PARAMETERS = (
    Parameter("start_station", Type(Kind.REAL), 0.0),
    Parameter("start_lane", Type(Kind.INTEGER), 0),
    Parameter("start_offset", Type(Kind.REAL), 0.0),
    Parameter("preview_spacing", Type(Kind.REAL), 0.0),
)


@pytest.fixture(scope="session")
def new_road(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Any]:
    """A fresh road component with these paths; equal ones are compiled once."""
    shelf = Shelf(tmp_path_factory.mktemp("roads"), WORKSPACE, warnings=())
    known: dict[str, Component] = {}

    def new(*paths: RoadPath, conflicts: tuple[Conflict, ...] = (), **parameters: float) -> Any:
        tables = RoadTables(paths, conflicts)
        text = road_files(tables)["road_tables.c"]
        if text not in known:
            known[text] = road_component(tables, shelf.folder / f"road_{len(known)}")
        return shelf.instance(known[text], **parameters)

    return new


def road_component(tables: RoadTables, folder: Path) -> Component:
    """The component in C of a road with these *tables*, written into the new *folder*."""
    folder.mkdir()
    files = road_files(tables)
    for file, content in files.items():
        (folder / file).write_text(content, encoding="utf-8")
    units = tuple(folder / file for file in files if file.endswith(".c"))
    source = CSource(units, folder / "road.h", "road", "road_init", "road_step", None)
    return Component(folder.name, WORKSPACE.interfaces["road"], source=source, parameters=PARAMETERS)
