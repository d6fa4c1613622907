"""An example of each kind of component that comes with dse, by the kind's name: a gain."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

from answerers import Answerer
from background import LIMIT
from coded_texts import gain
from scenario_texts import car, declared, private, scenario as scenario_text, speed, teleport, world

from dse.fmu.component_build import build
from dse.testing.kinds import Files, lay_out, the_component

INTERFACES = "interfaces:\n  gain:\n    inputs: {u: m}\n    outputs: {y: m}\n"
COMPONENT = "component: twice\nimplements: gain\nsource: {source}\nparameters:\n  factor: {{start: 2, min: 0}}\n"

HEADER = """\
#ifndef TWICE_H
#define TWICE_H
typedef struct {
    struct { double u; } in;
    struct { double y; } out;
    struct { double factor; } par;
} twice;
void twice_init(twice *self);
void twice_step(twice *self);
#endif
"""
CODE = """\
#include "twice.h"
void twice_init(twice *self) { twice_step(self); }
void twice_step(twice *self) { self->out.y = self->par.factor * self->in.u; }
"""
MODEL = """\
model Twice
  parameter Real factor = 2;
  input Real u(unit = "m");
  output Real y(unit = "m");
equation
  y = factor * u;
end Twice;
"""


def written(source: str) -> dict[str, str | bytes]:
    return {"interfaces.yaml": INTERFACES, "twice/component.yaml": COMPONENT.format(source=source)}


def c() -> Files:
    block = "\n  kind: c\n  files: [twice.c]\n  step: 10 ms"
    return {**written(block), "twice/twice.h": HEADER, "twice/twice.c": CODE}


CLASS = """\
class Twice:
    def __init__(self, parameters):
        self.parameters = parameters

    def step(self, inputs, h):
        return {"y": self.parameters["factor"] * inputs["u"]}
"""


def python() -> Files:
    return {**written("{kind: python, files: [twice.py]}"), "twice/twice.py": CLASS}


def modelica() -> Files:
    return {**written("{kind: modelica, model: Twice, files: [twice.mo]}"), "twice/twice.mo": MODEL}


def fmu() -> Files:
    with tempfile.TemporaryDirectory() as folder:
        archive = build(the_component(lay_out(c(), Path(folder))), cache=Path(folder, "cache"))
        return {**written("{kind: fmu, file: twice.fmu}"), "twice/twice.fmu": archive.read_bytes()}


def time_series() -> Files:
    return {
        "interfaces.yaml": "interfaces: {profile: {outputs: {y: m}}}\n",
        "twice/component.yaml": (
            "component: twice\nimplements: profile\nsource: {kind: time_series, file: y.csv, columns: {y: y}}\n"
            "parameters: {offset: {start: 0.25 s}, gain: {start: 2}}\n"
        ),
        "twice/y.csv": "t [s],y [km]\n0,0\n0.3,1\n2,-3\n",
    }


def road() -> Files:
    shared = Path(__file__).parents[2] / "components" / "interfaces.yaml"
    return {
        "interfaces.yaml": shared.read_bytes(),
        "twice/component.yaml": (
            "component: twice\nimplements: road\n"
            "source: {kind: road, file: ../../roads/bend.yaml, paths: {same: {route: [1]}}}\n"
            "parameters:\n"
            "  {preview_spacing: {start: 2 m}, start_station: {start: 5 m}, start_lane: {start: 0, type: int}}\n"
        ),
        "../roads/bend.yaml": (
            "road: bend\nlanes: 4\nsegments: [{straight: 50 m}, {curve: {radius: 60 m, angle: 40 deg, spiral: 20 m}}]\n"
        ),
    }


def scenario() -> Files:
    """A road user in the plane."""
    shared = Path(__file__).parents[2] / "components" / "interfaces.yaml"
    start = teleport(world("$x", 2)) + speed(3)
    return {
        "interfaces.yaml": shared.read_bytes(),
        "twice/component.yaml": (
            "component: twice\nimplements: scenario\nsource: {kind: scenario, file: alone.xosc}\nparameters:\n"
            "  x: {start: 5, tunable: false}\n"
            "  drives_host: {start: false, tunable: false}\n  host_front: {start: 2 m, tunable: false}\n"
        ),
        "twice/alone.xosc": scenario_text(car("One"), private("One", start), parameters=declared(x=1)),
    }


def sumo() -> Files:
    """A lane and traffic that minds nobody."""
    root = Path(__file__).parents[2] / "components"
    ours = (root / "traffic" / "sumo_traffic" / "component.yaml").read_text("utf-8")
    text = ours.replace("component: sumo_traffic", "component: twice").replace(
        "../../../roads/motorway", "../../roads/lane"
    )
    return {
        "interfaces.yaml": (root / "interfaces.yaml").read_bytes(),
        "twice/component.yaml": text.replace("minds_host: {start: true", "minds_host: {start: false"),
        "../roads/lane.yaml": (
            "road: lane\nlanes: {forward: 1, backward: 0}\nspeed_limit: 50 km/h\nsegments: [{straight: 900 m}]\n"
        ),
    }


def simulink() -> Files:
    source = "{kind: simulink, folder: twice_ert_rtw, step: 10 ms}\nmap: {factor: twice_P.factor}"
    files: Files = {f"twice/twice_ert_rtw/{name}": text for name, text in gain().items()}
    return {**written(source), **files}


@cache
def _doubling() -> int:
    """The port of somebody outside that multiplies, there until the tests are over."""
    other = Answerer(lambda time, step, values: [values[0] * values[1]])
    other.__enter__()
    return other.port


def udp() -> Files:
    return written(f"{{kind: udp, port: {_doubling()}, timeout: {LIMIT:g} s}}")


EXAMPLES: dict[str, Callable[[], Files]] = {
    "c": c,
    "fmu": fmu,
    "modelica": modelica,
    "python": python,
    "road": road,
    "scenario": scenario,
    "sumo": sumo,
    "time_series": time_series,
    "simulink": simulink,
    "udp": udp,
}
