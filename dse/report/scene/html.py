"""One offline HTML file in which a run is driven again, in three dimensions."""

from __future__ import annotations

import html
import os
import re
from pathlib import Path
from typing import Protocol

import numpy as np

from dse.report.content.data import Floats
from dse.report.drawing.road_picture import StandingLight, Strip
from dse.report.page.encoding import Block
from dse.report.page.html import HEAD, ICON, bundle, hash_of
from dse.report.page.payload import script_json
from dse.report.scene.data import CLASSES, COLOURS, Scene
from dse.scratch import write_whole

_PAGE = (
    HEAD
    + """</head>
<body>
<div id="scene"><noscript>This scene draws itself with JavaScript, which is switched off.</noscript></div>
<script type="application/json" id="document">{document}</script>
<script type="application/octet-stream;base64" id="columns">{columns}</script>
<script>{script}</script>
</body>
</html>
<!-- {mark} -->
"""
)


_TAIL = 200


class Columns(Protocol):
    """Takes the columns of a scene, each by its name and how exact a page needs it."""

    def add(self, name: str, kind: str, values: Floats) -> None: ...  # noqa: D102


def write_scene(scene: Scene, target: Path) -> None:
    """Write the page to *target*, whole or not at all. Raises DseError if the file or the bundle cannot be used."""
    write_whole(target, scene_page(scene))


def scene_page(scene: Scene) -> str:
    """The page as text; the same scene gives the same text."""
    script, style = bundle("scene.js"), bundle("scene.css")
    policy = (
        f"default-src 'none'; script-src '{hash_of(script)}'; style-src '{hash_of(style)}' 'unsafe-inline'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    columns = Block()
    document = _document(scene, columns)
    document["columns"] = columns.directory
    return _PAGE.format(
        policy=policy,
        title=html.escape(scene.title),
        icon=ICON,
        style=style,
        document=script_json(document),
        columns=columns.text(),
        script=script,
        mark=re.sub(r"[^0-9a-f]", "", scene.mark),
    )


def scene_mark(page: Path) -> str:
    """The mark of the scene that the file *page* shows; "" if it shows none, or is not there."""
    try:
        with page.open("rb") as file:
            file.seek(max(file.seek(0, os.SEEK_END) - _TAIL, 0))
            found = re.search(rb"<!-- ([0-9a-f]+) -->\s*$", file.read(_TAIL))
    except OSError:
        return ""
    return found[1].decode("ascii") if found else ""


def _document(scene: Scene, columns: Columns) -> dict[str, object]:
    def add(stem: str, of: dict[str, Floats] | None) -> None:
        for name, values in (of or {}).items():
            columns.add(f"{stem}.{name}", "f4", values)

    add("host", dict(scene.host.columns))
    add("weather", dict(scene.weather))
    for number, colour in enumerate(scene.lights.values()):
        columns.add(f"light.{number}", "f4", colour)
    for number, other in enumerate(scene.others):
        add(f"other.{number}", dict(other))
    for number, sensor in enumerate(scene.sensors):
        for place, each in enumerate(sensor.returns):
            add(f"sensor.{number}.{place}", dict(each))
    for number, instrument in enumerate(scene.instruments):
        columns.add(f"instrument.{number}", "f4", instrument.values)
        if instrument.target is not None:
            columns.add(f"target.{number}", "f4", instrument.target)
    steps = len(scene.time)
    return {
        "title": scene.title,
        "subtitle": scene.subtitle,
        "steps": steps,
        "step": float(scene.time[1] - scene.time[0]) if steps > 1 else 0.0,
        "classes": CLASSES,
        "strips": [_strip(strip) for strip in scene.ground.strips],
        "areas": [[np.round(area.outline, 2).reshape(-1).tolist(), area.friction] for area in scene.ground.areas],
        "colours": COLOURS,
        "lights": [_light(light, scene) for light in scene.ground.lights],
        "host": {"length": scene.host.length, "width": scene.host.width, "front": scene.host.front},
        "others": len(scene.others),
        "sensors": [
            {
                "name": s.name,
                "title": s.title,
                "mount": s.mount,
                "reach": s.reach,
                "angle": s.angle,
                "returns": len(s.returns),
            }
            for s in scene.sensors
        ],
        "instruments": [
            {"title": i.title, "unit": i.unit, "items": list(i.items), "hasTarget": i.target is not None}
            for i in scene.instruments
        ],
    }


def _light(light: StandingLight, scene: Scene) -> dict[str, object]:
    """*told* is its column of what it shows, -1 where nobody told."""
    return {
        "place": np.round(light.place, 2).tolist(),
        "heading": round(light.heading, 4),
        "line": np.round(light.line, 2).reshape(-1).tolist(),
        "told": [*scene.lights].index(light.id) if light.id in scene.lights else -1,
    }


def _strip(strip: Strip) -> dict[str, object]:
    sides = ((strip.left, strip.left_height), (strip.right, strip.right_height))
    left, right = (np.round(np.column_stack(side), 2).reshape(-1).tolist() for side in sides)
    return {"left": left, "right": right, "isDriven": strip.is_driven, "isInside": strip.is_inside}


def scene_document(scene: Scene, columns: Columns) -> dict[str, object]:
    """What a page draws *scene* from, but for the *columns*, which are added there."""
    return _document(scene, columns)
