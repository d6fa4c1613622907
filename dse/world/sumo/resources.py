"""All that a simulation of SUMO reads, for the FMU of traffic by SUMO."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dse.errors import Location, fail
from dse.world.sumo.lanes import check_way, has_lights, placed_lanes, sumo_lanes
from dse.world.sumo.network import sumo_network, sumo_version
from dse.world.tables import RoadTables


def sumo_resources(
    roads: bytes, tables: RoadTables, about: Mapping[str, Any], where: Location | None, cache: Path | None
) -> dict[str, bytes]:
    """By file name: the network made of the OpenDRIVE *roads*, and where its lanes lie along the paths of *tables*.

    *about* is put beside the latter. Raises DseError located at *where*: SUMO is not here, netconvert fails, SUMO has
    no way along a path, or lights, whose programme would not be that of the road.
    """
    network = sumo_network(roads, where, cache)
    if has_lights(network):
        what = "the road has traffic lights, and SUMO's would not show what the road's do"
        raise fail(what, where, "use a road without lights, or idm_traffic")
    placed = placed_lanes(sumo_lanes(network), tables.paths, where)
    check_way(network, placed, tables.paths, where)
    told = {**about, "version": sumo_version(where), **placed}
    return {"road.net.xml": network, "lanes.json": json.dumps(told, sort_keys=True).encode()}
