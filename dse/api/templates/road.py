"""The start of a road: a straight, a bend, a straight."""

from __future__ import annotations

from pathlib import PurePosixPath

from dse.api.templates.write import headed

_TEXT = """\
road: {name}
title: {name}
lanes: 1                         # each way; or {{forward: 3, backward: 0, width: 3.75 m}}
speed_limit: 80 km/h
segments:                        # end to end; also hill, intersection, roundabout: 'dse docs formats'
  - straight: 200 m
  - curve: {{radius: 120 m, angle: 60 deg, direction: left, spiral: 40 m, bank: 3 %}}
  - straight: 200 m
"""


def new_road(name: str) -> dict[PurePosixPath, str]:
    """The file of a road *name*."""
    return {PurePosixPath("roads", f"{name}.yaml"): headed(_TEXT.format(name=name), 1, "road")}
