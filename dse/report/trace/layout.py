"""What Foxglove and Lichtblick show of a trace: the scene, the camera and the bench's figures, each in a panel."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.report.trace.foxglove import HOST
from dse.report.trace.rows import is_in_row
from dse.scratch import written_whole

if TYPE_CHECKING:
    from dse.report.trace.data import Trace

_MOST_PLOTS = 3  # more are too small to be read
_ITEM = re.compile(r"\[(\d+)\]")
# Behind and above the car, as in a replay; angles are in degrees.
_CAMERA = {"perspective": True, "distance": 25, "phi": 68, "thetaOffset": 90, "fovy": 45, "near": 0.5, "far": 5000}
# Frames are there, but not drawn; those of the whole run are read at once, so that a jump finds them.
_FRAMES = {"showLabel": False, "axisScale": 0, "lineWidth": 0, "enablePreloading": True}


def write_layout(trace: Trace, topics: Collection[str], target: Path) -> None:
    """Write the layout of a trace file with these *topics*, to be imported by the viewer."""
    panels: dict[str, object] = {
        "3D!scene": {
            "topics": {topic: {"visible": True} for topic in sorted(topics) if topic.startswith("/scene/")},
            "scene": {"transforms": _FRAMES},
            "cameraState": _CAMERA,
            "followTf": HOST,
            "followMode": "follow-pose",
        }
    }
    if "/camera" in topics:
        panels["Image!camera"] = {"imageMode": {"imageTopic": "/camera"}}
    known = {title: tuple(filter(is_in_row, signals)) for title, signals in trace.plots.items()}
    for title in [title for title, signals in known.items() if signals][:_MOST_PLOTS]:
        panels[f"Plot!{len(panels)}"] = _plot(title, known[title])
    scene, *others = panels
    beside = {"direction": "row", "first": scene, "second": _column(others), "splitPercentage": 60} if others else scene
    page = {"configById": panels, "globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1}}
    with written_whole(target) as path:
        path.write_text(json.dumps({**page, "layout": beside}, indent=1) + "\n", encoding="utf-8")


def _plot(title: str, signals: Sequence[str]) -> dict[str, Any]:
    paths = [{"value": _path(signal), "enabled": True, "timestampMethod": "receiveTime"} for signal in signals]
    titles = dict.fromkeys(("foxglovePanelTitle", "lichtblickPanelTitle"), title)
    return {**titles, "paths": paths, "showLegend": False, "isSynced": True}


def _path(signal: str) -> str:
    """Viewers count the items of arrays from 0."""
    return "/signals/" + _ITEM.sub(lambda found: f"[{int(found[1]) - 1}]", signal)


def _column(panels: Sequence[str]) -> Any:
    """*panels* one below the other, each as high as the others."""
    first, *rest = panels
    if not rest:
        return first
    return {"direction": "column", "first": first, "second": _column(rest), "splitPercentage": round(100 / len(panels))}
