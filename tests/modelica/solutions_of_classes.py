"""Tables, packages, redeclarations, connections and records."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from language_case import Cases, Given, Values
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.linalg import expm

CASES = Cases()
case = CASES.case

EXACT = 1e-14
ROUNDED = 1e-12

HOLD, LINEAR = 1, 2


def straight(x: float, xs: Sequence[float], ys: Sequence[float], extrapolation: int) -> float:
    """Straight lines between the points."""
    if extrapolation == HOLD:
        x = min(max(x, xs[0]), xs[-1])
    k = min(max(int(np.searchsorted(xs, x, "right")) - 1, 0), len(xs) - 2)
    return ys[k] + (ys[k + 1] - ys[k]) * (x - xs[k]) / (xs[k + 1] - xs[k])


def monotone(x: float, xs: Sequence[float], ys: Sequence[float], extrapolation: int) -> float:
    """scipy's monotone cubic, continued by its slope or held."""
    curve = PchipInterpolator(xs, ys)
    inside = min(max(x, xs[0]), xs[-1])
    beyond = (x - inside) * curve(inside, 1) if extrapolation == LINEAR else 0.0
    return float(curve(inside) + beyond)


def parabolic_slopes(xs: NDArray[np.float64], ys: NDArray[np.float64]) -> NDArray[np.float64]:
    """Slopes at *xs* of the parabolas through three points next to each other."""
    slopes = []
    for k in range(len(xs)):
        first = min(max(k - 1, 0), len(xs) - 3)
        three = slice(first, first + 3)
        slopes.append(np.polyval(np.polyder(np.polyfit(xs[three], ys[three], 2)), xs[k]))
    return np.array(slopes)


def hermite(x: float, xs: Sequence[float], ys: Sequence[float], extrapolation: int) -> float:
    """Cubic Hermite through the points with parabolic slopes."""
    x_array, y_array = np.asarray(xs, float), np.asarray(ys, float)
    slopes = parabolic_slopes(x_array, y_array)
    inside = min(max(x, xs[0]), xs[-1])
    k = min(max(int(np.searchsorted(x_array, inside, "right")) - 1, 0), len(xs) - 2)
    h = x_array[k + 1] - x_array[k]
    s = (inside - x_array[k]) / h
    value = (
        (1 + 2 * s) * (1 - s) ** 2 * y_array[k]
        + s * s * (3 - 2 * s) * y_array[k + 1]
        + h * s * (1 - s) * ((1 - s) * slopes[k] - s * slopes[k + 1])
    )
    if extrapolation == LINEAR and x != inside:
        value += (x - inside) * slopes[0 if x < inside else -1]
    return float(value)


@case("Tables1D", stop=1.05, step=0.035, error=ROUNDED)
def tables_1d(t: float, given: Given) -> Values:
    xs, ys = [-1.0, 0, 0.5, 2, 3], [2.0, 0, 1, 1.5, -3]
    x = 6 * t - 2
    return {"y": [curve(x, xs, ys, kind) for curve in (straight, monotone) for kind in (HOLD, LINEAR)]}


@case("Tables2D", given={"zs[2,3]": 4.0}, variants=({"zs[2,3]": -1.0},), stop=1.05, step=0.035, error=ROUNDED)
def tables_2d(t: float, given: Given) -> Values:
    xs, ys = [0.0, 1, 3], [-1.0, 0, 2, 3]
    zs = [[1.0, 2, 0, 5], [-1, 3, given["zs[2,3]"], 1], [2, 2, -3, 0]]
    x, y = 1.5 + 2.5 * math.cos(2 * math.pi * t), 1 + 3 * math.sin(2 * math.pi * t)
    return {
        "z": [
            curve(x, xs, [curve(y, ys, row, kind) for row in zs], kind)
            for curve in (straight, hermite)
            for kind in (HOLD, LINEAR)
        ]
    }


@case(
    "TableParameters",
    given={"scale": 1.0, "xs[3]": 2.0, "ys[3]": 4.0},
    variants=({"scale": 2.0}, {"xs[3]": 3.0}, {"ys[3]": -1.0}),
)
def table_parameters(t: float, given: Given) -> Values:
    k = given["scale"]
    slope = (given["ys[3]"] - k) / (given["xs[3]"] - 1)
    reached = math.log(1 + k) / k  # the time at which x = 1
    x = (math.exp(k * t) - 1) / k
    if t > reached:
        rest = 1 - (k + 1) / slope
        x = rest + (1 - rest) * math.exp(slope * (t - reached))
    return {"y": x, "z": k * t}


@case("TableInReduction", stop=2.1, step=0.07, events=(8 / 15, 1.2), error=1e-6)
def table_in_reduction(t: float, given: Given) -> Values:
    curve = PchipInterpolator([0, 1, 2, 4], [0, 0.5, 2, 3])
    phi = 0.2 + 1.5 * t
    return {"speed": 1.5 * float(curve(phi, 1)), "force": 2 * 1.5**2 * float(curve(phi, 2))}


@case("Redeclare", given={"u": 2.0}, variants=({"u": -1.0},), stop=0.14, error=EXACT)
def redeclare(t: float, given: Given) -> Values:
    u = given["u"]
    return {"a": 5 * u + 600 * u + 20000 * (u + 1), "b": 7 * u**3 + 50 * (3 * u) ** 3 - 10000 * (u + 1)}


@case("RedeclareMedium", given={"h": 1.5}, stop=0.14, error=EXACT)
def redeclare_medium(t: float, given: Given) -> Values:
    h = given["h"]
    return {"water": 9810 * h + 1000, "oil": 850 * 9.81 * h + 850}


@case(
    "InnerOuter",
    given={"world.g": 10.0, "pair.planet.world.g": 3.7, "pair.bodies[2].m": 4.0},
    variants=({"world.g": 5.0}, {"pair.planet.world.g": 1.0}, {"pair.bodies[2].m": 7.0}),
    stop=0.14,
    error=EXACT,
)
def inner_outer(t: float, given: Given) -> Values:
    return {"here": (3 + given["pair.bodies[2].m"]) * given["world.g"], "there": 2 * given["pair.planet.world.g"]}


@case("ExtendsModified", given={"T": 0.25, "other.T": 0.5}, variants=({"T": 2.0}, {"other.T": 1.0}))
def extends_modified(t: float, given: Given) -> Values:
    own, other = given["T"], given["other.T"]
    # T x' = u - x with u = 1 - 1 + 5 exp(-t/other)
    gain = 5 / (1 - own / other)
    x = gain * math.exp(-t / other) + (2 - gain) * math.exp(-t / own)
    return {"y": x + 3, "z": 5 * math.exp(-t / other) - 1}


@case("ConditionalComponents", given={"u": 3.0, "a.k": 2.0}, variants=({"a.k": -1.0},), stop=0.14, error=EXACT)
def conditional_components(t: float, given: Given) -> Values:
    a = given["a.k"] * given["u"] + 10
    return {"y": a, "z": 4 * a + 1000 * given["u"]}


@case("ComponentArrays", given={"u": 1.0, "lag[2].k": 2.0}, variants=({"lag[2].k": -1.0}, {"u": 0.0}))
def component_arrays(t: float, given: Given) -> Values:
    middle = given["lag[2].k"]
    a = np.array([[-2.0, 0, 0], [middle, -1, 0], [0, 8, -4]])
    rest = np.linalg.solve(a, [-4 * given["u"], 0, 0])
    return {"y": (rest + expm(a * t) @ (np.array([1.0, 0, -1]) - rest))[2]}


def network_residuals(v: dict[str, float]) -> list[float]:
    return [
        v["r1.p.i"] + v["r3.p.i"] + v["source.p.i"],
        v["r1.n.i"] + v["r2.p.i"] + v["bridge.p.i"],
        v["r3.n.i"] + v["r4.p.i"] + v["bridge.n.i"],
        v["r1.n.v"] - v["bridge.p.v"],
        v["bridge.v"] - 5 * v["bridge.i"],
        v["r4.v"] - 4 * v["r4.i"],
        v["source.n.v"],
        v["ground.p.i"],
    ]


@case(
    "ElectricNetwork",
    residuals=network_residuals,
    given={"bridge.R": 5.0, "r2.R": 2.0},
    variants=({"bridge.R": 0.5}, {"r2.R": 20.0}),
    stop=0.14,
    error=ROUNDED,
)
def electric_network(t: float, given: Given) -> Values:
    r1, r2, r3, r4, bridge = 1.0, given["r2.R"], 3.0, 4.0, given["bridge.R"]
    nodes = np.array([[1 / r1 + 1 / r2 + 1 / bridge, -1 / bridge], [-1 / bridge, 1 / r3 + 1 / r4 + 1 / bridge]])
    a, b = np.linalg.solve(nodes, [10 / r1, 10 / r3])
    return {"across": a - b, "total": (10 - a) / r1 + (10 - b) / r3}


@case("HierarchicalConnections", given={"inertia.J": 2.0}, variants=({"inertia.J": 0.5},))
def hierarchical_connections(t: float, given: Given) -> Values:
    phi = 0.1 * math.cos(math.sqrt(40 / given["inertia.J"]) * t)
    return {"angle": phi, "middle": 0.2 * phi, "load": 40 * phi}


@case("ExpandableBus", given={"speed.k": 3.0}, variants=({"speed.k": -2.0},), error=EXACT)
def expandable_bus(t: float, given: Given) -> Values:
    return {"y": 2 * given["speed.k"] * t, "z": 14 * t}


@case("ExpandableMembers", given={"plant.speed.k": 3.0}, variants=({"plant.speed.k": -2.0},), error=1e-9)
def expandable_members(t: float, given: Given) -> Values:
    x = given["plant.speed.k"] * max(t * t - 0.35**2, 0) / 2
    return {"x": x, "z": 3 * t + (2 if t > 0.55 else 1), "twice": 14 * t}


@case("OuterParameters", given={"world.g": 10.0, "area": 4.0}, variants=({"world.g": 4.0, "area": 9.0},), error=EXACT)
def outer_parameters(t: float, given: Given) -> Values:
    return {"a": 3, "b": 3, "c": 6, "d": given["world.g"] / 4, "e": math.sqrt(given["area"]) * t, "f": 3, "g": 13}


@case("OuterAggregates", given={"world.k": 5.0}, variants=({"world.k": -1.0},), error=EXACT)
def outer_aggregates(t: float, given: Given) -> Values:
    return {"y": 1 + 10 * t + given["world.k"], "z[1]": 6 + t, "z[2]": 2 * t + 2}


@case("Streams", given={"left.h": 5.0}, variants=({"left.h": -2.0},), stop=0.14, error=EXACT)
def streams(t: float, given: Given) -> Values:
    return {"flow_rate": 4, "forward": given["left.h"] + 1, "backward": 10, "carried": given["left.h"] + 1}


@case(
    "RecordParameters",
    given={"u": 2.0, "data.k": 1.0, "c.data.k": 7.0, "sport.c[2]": 4.0},
    variants=({"data.k": 3.0}, {"c.data.k": 0.5}, {"sport.c[2]": 1.0}),
    stop=0.14,
    error=EXACT,
)
def record_parameters(t: float, given: Given) -> Values:
    u = given["u"]
    return {"y": [given["data.k"] * u + 20, 5 * u + 3 * given["sport.c[2]"], given["c.data.k"] * u + 6]}


@case("RecordBinding", given={"k": 3.0}, variants=({"k": 0.0},), error=EXACT)
def record_binding(t: float, given: Given) -> Values:
    return {"y": math.hypot(given["k"], 4), "z": given["k"] + t}


@case("ParameterIndex", given={"gear": 1}, variants=({"gear": 3},), error=EXACT)
def parameter_index(t: float, given: Given) -> Values:
    return {"y": 10 * given["gear"] + t}


@case(
    "TypesAndUnits", given={"demand": 50.0, "efficiency": 0.9, "loss": 5.0}, variants=({"loss": 0.0}, {"demand": 500.0})
)
def types_and_units(t: float, given: Given) -> Values:
    torque = given["efficiency"] * given["demand"] - given["loss"]
    return {"torque": torque, "speed": 10 + torque * t / 10}


@case("ConnectionCount", given={"connected.v": 3.0}, variants=({"connected.v": -1.0},), stop=0.14, error=EXACT)
def connection_count(t: float, given: Given) -> Values:
    return {"y": -5, "z": 2 * given["connected.v"]}


@case("StringParameter", stop=0.14, error=EXACT)
def string_parameter(t: float, given: Given) -> Values:
    return {"y": 1}


@case("InnerNested", given={"k": 3.0}, variants=({"k": -5.0},), error=1e-12)
def inner_nested(t: float, given: Given) -> Values:
    return {"y": [2 * t, 2 * given["k"] * t, -2 * t, -2 * t]}


@case("InstanceNames", stop=0.14, error=EXACT)
def instance_names(t: float, given: Given) -> Values:
    return {"y": [1, 2, 3]}


@case("ConstantOfOtherClass", given={"a.k": 3.0}, variants=({"a.k": -2.0},), error=ROUNDED)
def constant_of_other_class(t: float, given: Given) -> Values:
    return {"y": [given["a.k"] * (2 * t + 10), 70, 2.5 * t]}


@case("RedeclaredByInterface", given={"controller.ti": 0.5}, error=1e-5)
def redeclared_by_interface(t: float, given: Given) -> Values:
    rate = math.sqrt(0.5 / given["controller.ti"])
    return {"y": 2 * (1 - math.cos(rate * t)), "command": 2 * rate * math.sin(rate * t)}
