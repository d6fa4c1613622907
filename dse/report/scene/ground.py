"""The ground of a scene: what is near the way that was driven."""

from __future__ import annotations

import numpy as np

from dse.report.content.data import Floats
from dse.report.drawing.road_picture import Strip
from dse.report.roads import road_picture, standing_lights
from dse.report.roadside import kind_of, markings_of, standing_objects, standing_signs
from dse.report.scene.data import Ground
from dse.world import Network

_LANE = 3.5


def ground_of(network: Network, way: Floats, reach: float) -> Ground:
    """What of *network* is within *reach* m of the box around *way* (n, 2). Raises DseError if nothing is driven on."""
    picture = road_picture(network, "")
    strips = tuple(strip for strip in picture.strips if _is_near(strip.left, way, reach))
    areas = tuple(area for area in picture.areas if _is_near(area.outline, way, reach))
    lights = tuple(light for light in standing_lights(network) if _is_near(light.place[None, :2], way, reach))
    marks = tuple(mark for mark in markings_of(network) if _is_near(mark.line[:, :2], way, reach))
    signs = tuple(sign for sign in standing_signs(network) if _is_near(sign.place[None, :2], way, reach))
    objects = tuple(each for each in standing_objects(network) if _is_near(each.place[None, :2], way, reach))
    return Ground(strips, areas, lights, marks, signs, objects, kind_of(network))


def straight_ground(way: Floats, reach: float) -> Ground:
    """Two lanes along the x-axis, the host in the right one."""
    x = np.linspace(way[:, 0].min() - reach / 5, way[:, 0].max() + reach, 41)
    zero = np.zeros_like(x)

    def strip(right: float, left: float, *, is_back: bool = False) -> Strip:
        sides = [
            np.column_stack([x, zero + t])[:: -1 if is_back else 1]
            for t in ((right, left) if is_back else (left, right))
        ]
        return Strip(sides[0], sides[1], zero, zero, is_driven=True, is_inside=False)

    return Ground((strip(-_LANE / 2, _LANE / 2), strip(_LANE / 2, 1.5 * _LANE, is_back=True)), ())


def _is_near(points: Floats, way: Floats, reach: float) -> bool:
    low, high = way.min(axis=0) - reach, way.max(axis=0) + reach
    return bool(np.any(np.all((points >= low) & (points <= high), axis=1)))
