"""A workspace with one bench that several people can share: points on a line that see each other, and traffic."""

from __future__ import annotations

from pathlib import Path

from workspaces import written

_INTERFACES = """\
types:
  mover:
    id: int
    class: 'enum[none, car]'
    length: m
    width: m
    height: m
    path: int
    station: m
    offset: m
    turn: rad
    speed: m/s
    acceleration: m/s2
  actor:
    id: int
    class: 'enum[none, car]'
    length: m
    width: m
    height: m
    x: m
    y: m
    z: m
    heading: rad
    speed: m/s
interfaces:
  driver:
    outputs: {accelerator: "1", brake: "1", cruise: bool}
  car:
    inputs: {accelerator: "1", brake: "1", cruise: bool, start: {x: m}}
    outputs: {motion: {x: m, y: m, heading: rad, speed: m/s, acceleration: m/s2}}
  road:
    inputs: {motion: {x: m, y: m, heading: rad, speed: m/s, acceleration: m/s2}, movers: "mover[2]"}
    optional: [movers]
    outputs: {start: {x: m}, lane: {station: m}, actors: "actor[2]", gap: m}
  traffic:
    outputs: {movers: "mover[2]"}
"""
_MOTION = "struct { double x, y, heading, speed, acceleration; } motion;"
_MOVER = (
    "struct { int32_t id, class; double length, width, height; int32_t path;"
    " double station, offset, turn, speed, acceleration; } movers[2];"
)
_ACTOR = "struct { int32_t id, class; double length, width, height, x, y, z, heading, speed; } actors[2];"


def _part(name: str, interface: str, members: str, step: str, start: str = "", parameters: str = "") -> dict[str, str]:
    include = "#include <stdbool.h>\n#include <stdint.h>\n#include <math.h>\n#include <stdlib.h>\n#include <unistd.h>\n"
    header = f"{include}typedef struct {{ {members} }} {name};\n"
    header += f"void {name}_init({name} *self);\nvoid {name}_step({name} *self, double h);\n"
    code = f'#include "{name}.h"\nvoid {name}_init({name} *s) {{ (void)s; {start} }}\n'
    code += f"void {name}_step({name} *s, double h) {{ (void)s; (void)h; {step} }}\n"
    described = f"component: {name}\nimplements: {interface}\nsource: {{kind: c, files: [{name}.c]}}\n{parameters}"
    where = f"components/{name}"
    return {f"{where}/component.yaml": described, f"{where}/{name}.h": header, f"{where}/{name}.c": code}


_SEE = """
    s->out.gap = 1000;
    s->out.lane.station = s->in.motion.x;
    for (int i = 0; i < 2; i++) {
        s->out.actors[i].id = s->in.movers[i].id;
        s->out.actors[i].class = s->in.movers[i].class;
        s->out.actors[i].length = s->in.movers[i].length;
        s->out.actors[i].x = s->in.movers[i].station;
        s->out.actors[i].y = s->in.movers[i].offset;
        s->out.actors[i].heading = s->in.movers[i].turn;
        s->out.actors[i].speed = s->in.movers[i].speed;
        double ahead = s->in.movers[i].station - s->in.motion.x;
        if (s->in.movers[i].class && ahead > 0) s->out.gap = fmin(s->out.gap, ahead);
    }
"""
_FILES = {
    "components/interfaces.yaml": _INTERFACES,
    **_part("idle", "driver", "struct { double accelerator, brake; bool cruise; } out;", ""),
    **_part(
        "dot",
        "car",
        f"struct {{ double accelerator, brake; bool cruise; struct {{ double x; }} start; }} in;"
        f"struct {{ {_MOTION} }} out;"
        "struct { double hangs; } par; double time;",
        """
        s->time += h;
        if (s->time > s->par.hangs) sleep(3600);
        s->out.motion.acceleration = 5 * s->in.accelerator - 8 * s->in.brake;
        s->out.motion.speed = fmax(s->out.motion.speed + s->out.motion.acceleration * h, 0);
        s->out.motion.x += s->out.motion.speed * h;
        """,
        "s->out.motion.x = s->in.start.x; s->out.motion.speed = 10;",
        "parameters: {hangs: {start: 1000 s, min: 0 s, max: 2000 s, title: when it does not answer any more}}\n",
    ),
    **_part(
        "way",
        "road",
        f"struct {{ {_MOTION} {_MOVER} }} in; struct {{ struct {{ double x; }} start;"
        f"struct {{ double station; }} lane; {_ACTOR} double gap; }} out; struct {{ double start_station; }} par;",
        _SEE,
        f"s->out.start.x = s->par.start_station; {_SEE}",
        "parameters: {start_station: {start: 100 m, min: 0 m}}\n",
    ),
    **_part(
        "flow", "traffic", f"struct {{ {_MOVER} }} out;", "", "s->out.movers[0].class = 1; s->out.movers[0].id = 77;"
    ),
    "designs/cars.yaml": "design: cars\nroot:\n  compound:\n    car: {alternatives: [dot]}\n",
}
RECORDED = "car.motion.x, road.gap, 'road.actors[1].speed'"
_BENCH = """\
testbench: field
title: Cars on a line
design: cars
test_components: {driver: {component: idle}, road: {component: way}, traffic: {component: flow}}
connections:
  - driver.accelerator -> car.accelerator
  - driver.brake -> car.brake
  - driver.cruise -> car.cruise
  - road.start -> car.start
  - car.motion -> road.motion
  - traffic.movers -> road.movers
simulation: {stop: STOP, step: 10 ms, algorithm: gauss_seidel, record: [RECORDED], record_every: 10 ms}
metrics:
  least_gap: {expression: minimum(road.gap), unit: m}
requirements:
  R1: {title: keeps its distance, metric: least_gap, at_least: 5 m}
figures:
  speed: {title: Speed, current: car.motion.speed, unit: km/h}
"""


def shared_workspace(root: Path, stop: str = "20 s") -> Path:
    """The folder *root* as that workspace, whose bench ``field`` lasts *stop*."""
    return written(
        root, {**_FILES, "testbenches/field.yaml": _BENCH.replace("STOP", stop).replace("RECORDED", RECORDED)}
    )
