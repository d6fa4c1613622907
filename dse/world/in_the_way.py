"""The one rule of what is in the way: who may drive in a lane, how tall it is, and which roads are on one level.

The road component computes ``actor.above`` by it, `find_conflict_areas` and the ways through a network use it, and the
header ``components/road_users/in_the_way.h`` is its half for the components in C.
"""

from __future__ import annotations

from collections.abc import Iterable

CLASSES = ("none", "car", "truck", "motorcycle", "bicycle", "pedestrian", "obstacle")
"""The enumeration ``actor_class`` of the interfaces, in its order."""

HEIGHTS = (0.0, 1.5, 3.5, 1.5, 1.75, 1.75, 0.0)
"""m by class, where a road user has no height of its own: as the traffic of the shipped components has them.

A car: Euro NCAP Global Vehicle Target, 1.43 m, and the mean of new cars in the EU, about 1.55 m. A truck: at most 4.0 m
(Directive 96/53/EC, annex I, 1.3); 3.5 m is that of a box body without a high roof. With a rider or on foot: about
1.75 m (stature of men, median; DIN 33402-2). An obstacle has what it has.
"""

LEVEL = 2.0
"""m between two roads above each other, from which on they are on two levels: no vehicle passes below less.

Car parks have a headroom of 2.1 m and more (Garagenverordnungen of the German states: 2 m), roads of 4.5 m (RAS-Q).
"""
STEEPEST = 0.12
"""Rise of the ground beside a road: the steepest road (RASt 06, 6.1.2), for up to this it is still the same level."""

_MOTOR = frozenset({"car", "truck", "motorcycle"})
_ANY = _MOTOR | {"bicycle"}

_USERS = {
    **dict.fromkeys(("driving", "bidirectional", "slipLane", "connectingRamp"), _ANY),
    **dict.fromkeys(("entry", "exit", "onRamp", "offRamp", "mwyEntry", "mwyExit"), _MOTOR),
    "HOV": _MOTOR - {"truck"},
    "biking": frozenset({"bicycle"}),
    **dict.fromkeys(("sidewalk", "walking"), frozenset({"pedestrian"})),
}
"""Who may drive along a lane of a type (OpenDRIVE 1.8.1, 11.7.1); on all others no class of ours does.

A hard shoulder (stop, shoulder), a parking lane and roadworks are for nobody that drives on. Buses and taxis have no
class, so their lanes are empty. The occupancy of a car is not modelled: it may use an HOV lane.
"""

_RESTRICTED = {
    "passengerCar": ("car",),
    "truck": ("truck",),
    "trucks": ("truck",),
    "delivery": ("truck",),
    "motorcycle": ("motorcycle",),
    "bicycle": ("bicycle",),
    "pedestrian": ("pedestrian",),
    "throughTraffic": (),
    "none": (),
}
"""Classes by the words of <access restriction> (OpenDRIVE 1.8.1, 11.10.1)."""


def users_of(lane_type: str, rules: Iterable[tuple[str, str]] = ()) -> frozenset[str]:
    """The classes that may drive along a lane of *lane_type*; *rules* are ("allow" or "deny", restriction).

    If any rule allows, only those it names may; a lane type's own users are never widened.
    """
    users = _USERS.get(lane_type, frozenset[str]())
    listed = [(kind, frozenset(_RESTRICTED.get(word, ()))) for kind, word in rules]
    allowed = [classes for kind, classes in listed if kind == "allow"]
    if allowed:
        users &= frozenset[str]().union(*allowed)
    return users.difference(*(classes for kind, classes in listed if kind == "deny"))


def user_bits(users: Iterable[str]) -> int:
    """The sum of 2 to the power of the number of each class."""
    return sum(1 << CLASSES.index(user) for user in users)


ALL_USERS = user_bits(CLASSES)


def on_one_level(apart: float, aside: float = 0.0) -> bool:
    """Whether places that are *apart* in height, in m, and *aside* of each other in the plane are on one level."""
    return abs(apart) < LEVEL + STEEPEST * aside
