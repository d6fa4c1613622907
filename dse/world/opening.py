"""Road files, however they are written."""

from __future__ import annotations

from pathlib import Path

from dse.errors import Location, fail
from dse.formats import read_xml, shown
from dse.loading import read_road
from dse.world.opendrive.reading import network_in, read_network
from dse.world.opendrive.structure import Network
from dse.world.writing.opendrive import opendrive_of

SUFFIXES = (".yaml", ".xodr")


def open_roads(path: Path, inside: Path) -> Network:
    """The network in a file: OpenDRIVE, or a road in YAML of the workspace *inside*. Raises DseError with all that is
    wrong with it."""
    if path.suffix not in SUFFIXES:
        raise fail(
            f"'{path.name}' is no file of roads", Location(shown(path)), f"its name ends in {' or '.join(SUFFIXES)}"
        )
    if path.suffix == ".xodr":
        return read_network(path, shown(path))
    return network_in(read_xml(opendrive_of(read_road(path, inside)).encode(), shown(path)))
