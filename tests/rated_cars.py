"""A car whose impact speed is what its brake cannot take off, with a rating; and what three designs come to."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from dse.rating import Prediction, Protocol

if TYPE_CHECKING:
    from dse.rating.protocol import Cell

FILES = {
    "components/interfaces.yaml": """\
interfaces:
  brake: {outputs: {taken: m/s}}
  target: {inputs: {taken: m/s}, outputs: {left: m/s, at: 1}}
""",
    "components/brake/component.yaml": """\
component: brake
implements: brake
source: {kind: c, files: [brake.c]}
parameters: {strength: {start: 35 km/h}}
""",
    "components/brake/brake.h": """\
typedef struct { struct { double taken; } out; struct { double strength; } par; } brake;
void brake_init(brake *self);
void brake_step(brake *self, double h);
""",
    "components/brake/brake.c": """\
#include "brake.h"
void brake_init(brake *self) { self->out.taken = self->par.strength; }
void brake_step(brake *self, double h) { (void)self; (void)h; }
""",
    "components/target/component.yaml": """\
component: target
implements: target
source: {kind: c, files: [target.c]}
parameters:
  host_speed: {start: 10 km/h, max: 200 km/h}
  speed: {start: 0 km/h}
  location: {start: 50 %, min: -50 %, max: 150 %}
  light: {enum: [day, night], start: day}
  fog: {start: 10 km}
""",
    "components/target/target.h": """\
typedef enum { day, night } light;
typedef struct {
    struct { double taken; } in; struct { double left, at; } out;
    struct { double host_speed, speed, location, fog; light light; } par;
} target;
void target_init(target *self);
void target_step(target *self, double h);
""",
    "components/target/target.c": """\
#include "target.h"
static void answer(target *self) {
    double left = self->par.host_speed - self->par.speed - self->in.taken;
    if (self->par.light == night) left += 5.0;
    if (self->par.fog < 100.0) left += 5.0;
    self->out.left = left > 0.0 ? left : 0.0;
    self->out.at = self->par.location;
}
void target_init(target *self) { answer(self); }
void target_step(target *self, double h) { (void)h; answer(self); }
""",
    "designs/car.yaml": """\
design: car
root: {compound: {brake: brake}}
""",
    "testbenches/wall.yaml": """\
testbench: wall
design: car
test_components: {target: {component: target}}
connections: [brake.taken -> target.taken]
simulation: {stop: 0.2 s, step: 0.1 s, record: [target.left], record_every: 0.1 s}
metrics:
  impact_speed: {expression: final(target.left), unit: km/h}
  place: {expression: final(target.at)}
""",
}

RATING = """\
rating: small
protocol: euroncap-rating-2026
tests:
  CCRs:
    bench: wall
    cells: {target.host_speed: VUT speed, target.speed: Target speed, target.location: Impact location}
    values: {v_rel_impact: impact_speed}
  CPNA day:
    bench: wall
    cells: {target.host_speed: VUT speed, target.location: Impact location, target.light: Day/Night}
    values: {v_rel_impact: impact_speed}
layers:
  Adverse weather conditions: {target.fog: 50 m}
"""


def speed(cell: Cell) -> float:
    """The host's speed in km/h; 10 where it starts from standstill, 50 where the cell has none."""
    return float(cell.attributes.get("VUT speed", "50 km/h").replace("SfS", "10").removesuffix(" km/h"))


NAN = float("nan")
ANSWERS: dict[str, dict[str, Callable[[Cell], float]]] = {
    "none": {
        "v_rel_impact": speed,
        "v_reduction": lambda _: 0.0,
        "v_impact": speed,
        "fcw_ttc": lambda _: NAN,
        "TTC": lambda _: 0.0,
        "dtle_t_end": lambda _: -1.0,
        "impact_occurred": lambda _: 1.0,
    },
    "perfect": {
        "v_rel_impact": lambda _: 0.0,
        "v_reduction": lambda _: 25.0,
        "v_impact": lambda _: 0.0,
        "fcw_ttc": lambda _: 2.0,
        "TTC": lambda _: 3.0,
        "dtle_t_end": lambda _: 0.3,
        "impact_occurred": lambda _: 0.0,
    },
    "middling": {
        "v_rel_impact": lambda cell: max(0.0, speed(cell) - 35.0),
        "v_reduction": lambda _: 15.0,
        "v_impact": lambda cell: max(0.0, speed(cell) - 35.0),
        "fcw_ttc": lambda cell: 2.5 - speed(cell) / 80.0,
        "TTC": lambda _: 3.0,
        "dtle_t_end": lambda cell: 0.3 - speed(cell) / 200.0,
        "impact_occurred": lambda cell: float(speed(cell) > 70.0),
    },
}
"""What three designs come to in each cell, by the KPI."""

WARNED = frozenset({"CPLA day", "CPLA night"})
"""In the rows of these tests whose function can be chosen a warning is declared, in those of CBLA braking."""

INPUTS = {"Vehicle response": "Retention", "Extended range performance": "ELK"}


def predicted(protocol: Protocol, name: str) -> Prediction:
    """The prediction of all cells for one of the three designs; the middling one claims two layers.

    For that one also what a laboratory assesses is declared.
    """
    cells = {cell.key: cell for cell in reversed(protocol.cells(WARNED))}
    values = {(key, ""): ANSWERS[name][cell.kpi](cell) for key, cell in cells.items()}
    colours = {key: protocol.colour(cell, values[key, ""], INPUTS) for key, cell in cells.items()}
    layers = {("Adverse weather conditions", "CCRs"), ("Speed", "CPNA")} if name == "middling" else set()
    assessed = {"Driveability": "Pass", "Driver state link": "Pass"} if name == "middling" else {}
    return Prediction(colours, values, frozenset(layers), INPUTS | assessed)
