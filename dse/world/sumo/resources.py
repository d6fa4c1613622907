"""All that a simulation of SUMO reads, for the FMU of traffic by SUMO."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import json
import os
import re
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dse.cache import cache_folder, content_key, keep_file
from dse.errors import Location, fail
from dse.world.sumo.lanes import check_way, has_lights, placed_lanes, sumo_lanes
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


# OpenDRIVE → a network of SUMO, by SUMO's own netconvert.


_OPTIONS = (
    "--opendrive.curve-resolution", "0.5",  # m: a chord stays within 1 mm of an arc of 32 m and more
    "--precision", "9",
    "--output.original-names",
    "--offset.disable-normalization",
    "--no-turnarounds",
)  # fmt: skip
_LONGEST = 600  # s
_WHEELS = ("eclipse-sumo", "libsumo")
NEEDED = "run: pip install 'dse-workbench[traffic]'"
"""What to do where SUMO is missing."""


def sumo_version(where: Location | None) -> str:
    """The version of SUMO here. Raises DseError at *where* if it is missing, or its two wheels do not fit together."""
    versions = []
    for wheel in _WHEELS:
        try:
            versions.append(importlib.metadata.version(wheel))
        except importlib.metadata.PackageNotFoundError:
            what = f"traffic by SUMO needs the package '{wheel}', which is not installed"
            raise fail(what, where, NEEDED) from None
    if len(set(versions)) > 1:
        found = " and ".join(f"{wheel} {version}" for wheel, version in zip(_WHEELS, versions, strict=True))
        raise fail(f"{found} do not belong together", where, NEEDED)
    return versions[0]


def sumo_network(roads: bytes, where: Location | None, cache: Path | None) -> bytes:
    """The network that netconvert makes of OpenDRIVE; the same bytes for the same *roads* and version of SUMO.

    Raises DseError at *where* with what netconvert says.
    """
    about = repr((sumo_version(where), _OPTIONS)).encode()
    key = content_key([("roads", roads), ("by", about)])
    return keep_file(cache_folder(cache) / "sumo" / f"{key}.net.xml", lambda: _converted(roads, where)).read_bytes()


def _converted(roads: bytes, where: Location | None) -> bytes:
    found = importlib.util.find_spec("sumo")
    home = Path(found.origin).parent if found and found.origin else None
    if home is None or not (home / "bin").is_dir():
        raise fail("the package 'eclipse-sumo' lacks its programs", where, NEEDED)
    with tempfile.TemporaryDirectory() as folder:
        given, made = Path(folder, "roads.xodr"), Path(folder, "roads.net.xml")
        given.write_bytes(roads)
        command = [str(home / "bin" / "netconvert"), "--opendrive", str(given), "--output-file", str(made), *_OPTIONS]
        settings = {**os.environ, "SUMO_HOME": str(home)}
        try:
            done = subprocess.run(command, capture_output=True, text=True, env=settings, timeout=_LONGEST, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise fail(f"SUMO's netconvert could not be run: {error}", where, NEEDED) from error
        if done.returncode != 0 or not made.is_file():
            lines = [line for line in done.stderr.splitlines() if line.startswith("Error")] or done.stderr.splitlines()
            said = " ".join(lines[:3]).replace(str(given), "the road") or f"it ended with {done.returncode}"
            raise fail(f"SUMO's netconvert cannot read the road: {said[:400]}", where, "dse export opendrive shows it")
        # The first comment has the time, and names of files.
        return re.sub(rb"<!--.*?-->\s*", b"", made.read_bytes(), flags=re.DOTALL)
