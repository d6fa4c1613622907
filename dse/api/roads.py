"""Roads at the front door: as OpenDRIVE, and as pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.lookup import workspace_of
from dse.api.studies.results import results
from dse.errors import Location, fail

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from dse.report import RoadPicture

_KINDS = (".csv", ".parquet")


def is_road(name: Path) -> bool:
    """Whether *name* is a file of roads, or else, where nothing lies there, a road of the workspace around here."""
    from dse.loading import Workspace, find_root

    if name.suffix.lower() in (".yaml", ".xodr"):
        return True
    root = None if name.exists() else find_root(Path())
    return root is not None and any(path.stem == str(name) for path in Workspace(root).files("roads"))


def opendrive_text(name: str) -> tuple[str, str]:
    """A road's name, and the text of it as OpenDRIVE. Raises DseError."""
    from dse.world import opendrive_of

    road = workspace_of(name).road(name)
    return road.name, opendrive_of(road)


def write_road_mesh(name: str, target: Path) -> tuple[str, int]:
    """Write the surface of a road as ``.glb`` or ``.obj``; returns its name, and the number of triangles.

    *name* is that of a road of the workspace, or an OpenDRIVE file. Raises DseError.
    """
    from dse.report import write_mesh

    picture = picture_of(Path(name))
    return picture.title, write_mesh(picture.strips, picture.title, target)


def picture_of(name: Path, driven: Iterable[tuple[Path, int]] = ()) -> RoadPicture:
    """What a picture of a road shows, with paths that were driven: of runs of study folders, or of files that
    'dse simulate -o' wrote. Raises DseError."""
    from dse.formats import shown
    from dse.report import road_picture, with_driven
    from dse.world import open_roads, read_network

    if name.suffix.lower() == ".xodr":
        network, title = read_network(name, shown(name)), name.stem
    else:
        workspace = workspace_of(str(name))
        network, road = open_roads(str(name), workspace), workspace.road(str(name))
        title = road.title or road.name
    picture = road_picture(network, title)
    for source, run in driven:
        label, x, y = _driven(source, run)
        picture = with_driven(picture, network, label, x, y)
    return picture


def _driven(source: Path, run: int) -> tuple[str, NDArray[np.float64], NDArray[np.float64]]:
    """What the path is called, and its points."""
    if source.is_dir():
        columns: Mapping[str, NDArray[np.float64]] = results(source).run(run).waveforms
        label, hint = f"{source.name}, run {run}", "'keep_waveforms: all' in the study, and"
    else:
        columns, label, hint = _columns(source), source.stem, ""
    x, y = (_ending(columns, f"motion.{axis}") for axis in "xy")
    if x is None or y is None:
        what = "no position was recorded: neither 'motion.x' nor 'motion.y' of any part"
        record = "'record: [chassis.motion.x, chassis.motion.y]' in the bench"
        raise fail(what, Location(str(source)), f"{hint} {record}".strip())
    return label, columns[x], columns[y]


def _ending(columns: Iterable[str], end: str) -> str | None:
    return next((name for name in columns if f".{name}".endswith(f".{end}")), None)


def _columns(source: Path) -> Mapping[str, NDArray[np.float64]]:
    """The columns of a file of waveforms, by their names without units."""
    import pandas as pd

    if source.suffix.lower() not in _KINDS or not source.is_file():
        raise fail(
            "this is neither a study folder nor a file of waveforms",
            Location(str(source)),
            f"it ends in {' or '.join(_KINDS)}",
        )
    try:
        frame = pd.read_csv(source) if source.suffix.lower() == ".csv" else pd.read_parquet(source)
        return {str(name).split(" [")[0]: frame[name].to_numpy(dtype=float) for name in frame}
    except (OSError, ValueError) as error:
        raise fail(
            f"cannot be read as waveforms: {error}", Location(str(source)), "write it with 'dse simulate -o'"
        ) from error
