"""Small roads with bridges, shoulders and lanes for some: what is right about each is written beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from opendrive_texts import factors, geometry, lane, road, section

LENGTH = 400.0
CROSSING = 200.0
"""m along both roads to the place where they cross."""


@dataclass(frozen=True)
class Crossing:
    """Road 1 along x and road 2 across it at x = 200 m; *above* is road 2 above road 1 there, 0 on one level."""

    over: str = ""
    under: str = ""
    heading: float = math.pi / 2
    above: float = 0.0
    meet: bool = True

    @property
    def parts(self) -> tuple[str, str]:
        x, y = CROSSING - 200 * math.cos(self.heading), -200 * math.sin(self.heading)
        return (_road("1", 0.0, 0.0, 0.0, _profile(self.under)), _road("2", x, y, self.heading, _profile(self.over)))


@dataclass(frozen=True)
class Lanes:
    """A road with these lanes from the middle to the right: *users* by lane from the right, and its middle."""

    right: str
    users: tuple[str, ...]
    middles: tuple[float, ...]

    @property
    def parts(self) -> tuple[str]:
        return (_road("1", 0.0, 0.0, 0.0, "", section(0.0, "", self.right)),)


def _road(id_: str, x: float, y: float, heading: float, more: str, sections: str = "") -> str:
    one = section(0.0, "", lane(-1))
    return road(id_, geometry(0.0, x, y, heading, LENGTH), LENGTH, sections or one, more=more)


def _profile(elevations: str) -> str:
    return f"<elevationProfile>{elevations}</elevationProfile>" if elevations else ""


def _at(s: float, *factors_: float) -> str:
    return f'<elevation s="{s!r}"{factors(*factors_)}/>'


CROSSINGS = {
    "a bridge 8 m above": Crossing(_at(0.0, 8.0), above=8.0, meet=False),
    "the host on the bridge": Crossing(under=_at(0.0, 6.0), above=-6.0, meet=False),
    "a deck of a car park": Crossing(_at(0.0, 2.6), above=2.6, meet=False),
    "an oblique bridge": Crossing(_at(0.0, 5.0), heading=0.6, above=5.0, meet=False),
    "a ramp that rises to a bridge": Crossing(
        _at(0.0, 0.0) + _at(80.0, 0.0, 0.06) + _at(180.0, 6.0) + _at(220.0, 6.0, -0.06) + _at(320.0, 0.0),
        above=6.0,
        meet=False,
    ),
    "an underpass in a dip": Crossing(
        under=_at(0.0, 0.0) + _at(100.0, 0.0, -0.06) + _at(180.0, -4.8) + _at(220.0, -4.8, 0.06) + _at(300.0, 0.0),
        above=4.8,
        meet=False,
    ),
    "a level crossing": Crossing(),
    "a crossing on a crest": Crossing(
        _at(0.0, -12.0, 0.06) + _at(200.0, 0.0, -0.06), _at(0.0, -12.0, 0.06) + _at(200.0, 0.0, -0.06)
    ),
    "a crossing with a kerb": Crossing(_at(0.0, 0.15)),
}

LANES = {
    "a hard shoulder": Lanes(lane(-1) + lane(-2, 2.5, "stop"), ("", "ctmb"), (-3.0, 0.0)),
    "a bus lane": Lanes(lane(-1) + lane(-2, 3.0, "bus"), ("", "ctmb"), (-3.25, 0.0)),
    "parked cars": Lanes(lane(-1) + lane(-2, 2.0, "parking"), ("", "ctmb"), (-2.75, 0.0)),
    "a cycle path": Lanes(lane(-1) + lane(-2, 1.5, "biking"), ("b", "ctmb"), (-2.5, 0.0)),
    "bus and bicycle beside two lanes": Lanes(
        lane(-1, 3.25) + lane(-2) + lane(-3, 3.0, "bus") + lane(-4, 1.5, "biking"),
        ("b", "", "ctmb", "ctmb"),
        (-5.5, -3.25, 0.0, 3.375),
    ),
    "lanes of a motorway": Lanes(
        lane(-1, 3.75) + lane(-2, 3.75) + lane(-3, 3.75, "exit"), ("ctm", "ctmb", "ctmb"), (-3.75, 0.0, 3.75)
    ),
    "no trucks on the left": Lanes(
        lane(-1, more='<access sOffset="0" rule="deny" restriction="truck"/>') + lane(-2), ("ctmb", "cmb"), (0.0, 3.5)
    ),
    "a lane for bicycles and motorcycles": Lanes(
        lane(-1)
        + lane(
            -2, more="".join(f'<access sOffset="0" rule="allow" restriction="{w}"/>' for w in ("bicycle", "motorcycle"))
        ),
        ("mb", "ctmb"),
        (-3.5, 0.0),
    ),
    "a carpool lane": Lanes(lane(-1, 3.6, "HOV") + lane(-2, 3.6), ("ctmb", "cm"), (0.0, 3.6)),
    "works on the left": Lanes(lane(-1, 3.0, "roadWorks") + lane(-2), ("ctmb", ""), (0.0, 3.25)),
}
"""Users: c for car, t for truck, m for motorcycle, b for bicycle. The own lane is the outermost one of driving."""
