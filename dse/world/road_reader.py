"""Road files, however they are written."""

from __future__ import annotations

from pathlib import Path

from dse.formats import read_xml, shown
from dse.loading import Workspace
from dse.world.opendrive.reading import network_in, read_network
from dse.world.opendrive.structure import Network
from dse.world.writing.opendrive import opendrive_of


def opendrive_text(name: str, workspace: Workspace) -> bytes:
    """The OpenDRIVE of a road of *workspace*, or of the file *name*, as it stands. Raises DseError."""
    path = Path(name)
    return path.read_bytes() if path.suffix.lower() == ".xodr" else opendrive_of(workspace.road(name)).encode()


def open_roads(name: str, workspace: Workspace) -> Network:
    """The network in a road of *workspace*, or in the file *name*: YAML, or OpenDRIVE (``.xodr``).

    Raises DseError with all that is wrong with it.
    """
    path = Path(name)
    if path.suffix.lower() == ".xodr":
        return read_network(path, shown(path))
    road = workspace.road(name)
    return network_in(read_xml(opendrive_of(road).encode(), f"{road.name} as OpenDRIVE"))
