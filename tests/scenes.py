"""A scene made up for the tests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dse.report import Scene
from dse.report.drawing.road_picture import StandingLight, Strip
from dse.report.scene.data import Ground, Host, Instrument, Sensor

STEPS = 101
LIGHT = StandingLight("L1", np.array([100.0, -4.0, 0.0]), 0.0, np.array([[100.0, 1.75, 0.0], [100.0, -1.75, 0.0]]))


def made_up(title: str = "made up", **changed: object) -> Scene:
    """Ten seconds at 20 m/s behind a lorry 40 m ahead, which a pedestrian takes the place of after 5 s."""
    time = np.linspace(0.0, 10.0, STEPS)
    zero = np.zeros(STEPS)
    way = np.column_stack([np.linspace(-50, 400, 10), np.zeros(10)])
    lane = Strip(
        way + np.array([0, 1.75]),
        way - np.array([0, 1.75]),
        np.zeros(10),
        np.zeros(10),
        is_driven=True,
        is_inside=False,
    )
    host = dict.fromkeys(("y", "z", "heading", "roll", "pitch", "steering"), zero)
    late = time >= 5
    other = {
        "id": np.where(late, 2.0, 1.0),
        "class": np.where(late, 5.0, 2.0),
        "length": np.where(late, 0.5, 12.0),
        "width": np.where(late, 0.5, 2.5),
        "height": np.where(late, 1.8, 3.5),
        "x": np.where(late, 300.0, 40 + 20 * time),
        "speed": np.where(late, 0.0, 20.0),
        **dict.fromkeys(("y", "z", "heading"), zero),
    }
    seen = {"valid": 1 + zero, "range": 40 + zero, "azimuth": zero}
    made = Scene(
        title,
        "run 7",
        time,
        Ground((lane,), (), (LIGHT,)),
        Host({**host, "x": 20 * time, "speed": 20 + zero}, 4.5, 1.8, 2.3),
        (other,),
        (Sensor("sensor", "A radar", 2.3, 150.0, 0.5, (seen,)),),
        {"fog": 0.02 + zero, "rain": zero, "snow": zero, "darkness": zero},
        (Instrument("Speed", "km/h", 72 + zero, 80 + zero), Instrument("mode", "", 1 * late, items=("calm", "alarm"))),
    )
    return replace(made, **changed)
