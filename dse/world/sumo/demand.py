"""What drives in SUMO: its classes of vehicles and the flows along the paths, as SUMO reads them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

MODELS = ("Krauss", "IDM", "EIDM", "ACC")
"""What SUMO calls the models of following, in the order of the parameter's items."""

HOST = "host"


@dataclass(frozen=True)
class Shape:
    """SUMO's word for the class, and sizes in m; the parameter called *share* is its part of the flow."""

    vehicle_class: str
    length: float
    width: float
    height: float
    share: str = ""


SHAPES = {
    "car": Shape("passenger", 4.5, 1.8, 1.5),
    "truck": Shape("truck", 12.0, 2.5, 3.6, "truck_share"),
    "motorcycle": Shape("motorcycle", 2.2, 0.9, 1.5, "motorcycle_share"),
}


def demand_text(parameters: Mapping[str, float], routes: Sequence[Sequence[str]]) -> str:
    """Types, routes ``path0``, ``path1``, … and flows. Departures are those of a Poisson process in each path.

    What a driver wants to drive is normally distributed about the limit; trucks are no faster than ``truck_speed``.
    """
    lines = ["<routes>", '  <vTypeDistribution id="mix">']
    share = {name: parameters[shape.share] for name, shape in SHAPES.items() if shape.share}
    share = {"car": max(0.0, 1.0 - sum(share.values())), **share}
    common = (
        f'carFollowModel="{MODELS[int(parameters["model"])]}" tau="{parameters["time_gap"]!r}" '
        f'minGap="{parameters["standstill_gap"]!r}" '
        f'speedFactor="normc(1,{parameters["speed_deviation"]!r},0.2,2)"'
    )
    for name, shape in SHAPES.items():
        top = f' maxSpeed="{parameters["truck_speed"]!r}"' if name == "truck" else ""
        lines.append(f'    <vType id="{name}" {_sizes(shape)} {common}{top} probability="{share[name]!r}"/>')
    host = Shape("passenger", parameters["host_front"] + parameters["host_rear"], parameters["host_width"], 1.5)
    lines += ["  </vTypeDistribution>", f'  <vType id="{HOST}" {_sizes(host)} minGap="0"/>']
    lines += [f'  <route id="path{number}" edges="{" ".join(edges)}"/>' for number, edges in enumerate(routes)]
    for number in range(len(routes)):
        flow = parameters.get(f"flow[{number + 1}]", parameters.get("flow", 0.0) if number == 0 else 0.0)
        if flow > 0:
            lines.append(
                f'  <flow id="flow{number}" type="mix" route="path{number}" begin="0" end="1000000" '
                f'period="exp({flow!r})" departLane="free" departSpeed="max" departPos="base"/>'
            )
    return "\n".join([*lines, "</routes>", ""])


def _sizes(shape: Shape) -> str:
    return f'vClass="{shape.vehicle_class}" length="{shape.length!r}" width="{shape.width!r}" height="{shape.height!r}"'
