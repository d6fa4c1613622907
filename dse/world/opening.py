"""Road files, however they are written."""

from __future__ import annotations

from pathlib import Path

from dse.errors import Location, fail
from dse.formats import read_xml, shown
from dse.loading import Workspace
from dse.world.opendrive.reading import network_in, read_network
from dse.world.opendrive.structure import Network
from dse.world.writing.opendrive import opendrive_of

SUFFIXES = (".yaml", ".xodr")


def open_roads(path: Path, inside: Path) -> Network:
    """The network in a file: OpenDRIVE, or a road in YAML of the workspace *inside*.

    Raises DseError with all that is wrong with it.
    """
    if path.suffix not in SUFFIXES:
        hint = f"its name ends in {' or '.join(SUFFIXES)}"
        raise fail(f"'{path.name}' is no file of roads", Location(shown(path)), hint)
    if path.suffix == ".xodr":
        return read_network(path, shown(path))
    return network_in(read_xml(opendrive_of(Workspace(inside).road(str(path))).encode(), shown(path)))
