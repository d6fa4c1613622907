"""One offline HTML file in which a run is driven again, in three dimensions."""

from __future__ import annotations

import html
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from dse.report.content.data import Floats
from dse.report.drawing.road_picture import Marking, StandingLight, StandingObject, StandingSign, Strip
from dse.report.page.encoding import Block
from dse.report.page.html import HEAD, ICON, bundle, hash_of
from dse.report.page.payload import script_json
from dse.report.page.simulation import POLICY, PageSimulation
from dse.report.scene.data import CLASSES, COLOURS, Scene

_PAGE = (
    HEAD
    + """</head>
<body>
<div id="scene"><noscript>This scene draws itself with JavaScript, which is switched off.</noscript></div>
<script type="application/json" id="document">{document}</script>
<script type="application/octet-stream;base64" id="columns">{columns}</script>{simulation}
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


@dataclass(frozen=True, slots=True, eq=False)
class LiveScene:
    """What a page needs to simulate its scene: each column is a sum of *signals* and a constant.

    *sums* is the scene in n + 1 frames: of no signal, and of each of the n alone at 1. They are columns of the only
    system of *simulation*.
    """

    sums: Scene
    signals: tuple[str, ...]
    simulation: PageSimulation


def scene_page(scene: Scene, live: LiveScene | None = None) -> str:
    """The page as text; the same scene gives the same text. With *live* it can be driven on from any moment."""
    script, style = bundle("scene.js"), bundle("scene.css")
    compiled, workers = POLICY if live else ("", "")
    policy = (
        f"default-src 'none'; script-src '{hash_of(script)}'{compiled}; style-src '{hash_of(style)}' 'unsafe-inline'; "
        f"img-src data: blob:; base-uri 'none'; form-action 'none'{workers}"
    )
    columns = Block()
    document = _document(scene, columns)
    document["columns"] = columns.directory
    if live:
        sums = _Sums()
        document["live"] = {"document": _document(live.sums, sums), "sums": sums.found, "signals": live.signals}
    return _PAGE.format(
        policy=policy,
        title=html.escape(scene.title),
        icon=ICON,
        style=style,
        document=script_json(document),
        columns=columns.text(),
        simulation=live.simulation.elements(bundle("simulate.js")) if live else "",
        script=script,
        mark=re.sub(r"[^0-9a-f]", "", scene.mark),
    )


class _Sums:
    """Columns in frames of no signal, and of each alone, as ``[constant, [signal, factor], …]`` by name."""

    def __init__(self) -> None:
        self.found: dict[str, list[object]] = {}

    def add(self, name: str, kind: str, values: Floats) -> None:
        del kind
        # A sum with the constant has rounded what is added to it.
        factors = [round(float(value - values[0]), 9) for value in values[1:]]
        self.found[name] = [float(values[0]), *([at, factor] for at, factor in enumerate(factors) if factor)]


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
    add("driver", dict(scene.driver))
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
        "kind": scene.ground.kind,
        "markings": [_marking(mark) for mark in scene.ground.markings],
        "signs": [_sign(sign) for sign in scene.ground.signs],
        "objects": [_object(each) for each in scene.ground.objects],
        "host": {
            "length": scene.host.length,
            "width": scene.host.width,
            "front": scene.host.front,
            "wheel": scene.host.wheel,
        },
        "others": len(scene.others),
        "sensors": [
            {
                "name": s.name,
                "title": s.title,
                "mount": s.mount,
                "left": s.left,
                "turn": s.turn,
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
    return {"left": left, "right": right, "isDriven": strip.is_driven, "isInside": strip.is_inside, "kind": strip.kind}


def _marking(mark: Marking) -> dict[str, object]:
    line = np.round(mark.line, 2).reshape(-1).tolist()
    return {"line": line, "kind": mark.kind, "width": round(mark.width, 3), "colour": mark.colour}


def _sign(sign: StandingSign) -> dict[str, object]:
    place = np.round(sign.place, 2).tolist()
    return {"place": place, "heading": round(sign.heading, 4), "kind": sign.kind, "text": sign.text}


def _object(each: StandingObject) -> dict[str, object]:
    place, size = np.round(each.place, 2).tolist(), [round(side, 2) for side in each.size]
    return {"place": place, "heading": round(each.heading, 4), "kind": each.kind, "size": size}


def scene_document(scene: Scene, columns: Columns) -> dict[str, object]:
    """What a page draws *scene* from, but for the *columns*, which are added there."""
    return _document(scene, columns)
