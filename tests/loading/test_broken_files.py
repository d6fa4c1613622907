"""Every kind of broken input gives one located message with a hint."""

from __future__ import annotations

import math
import os
from pathlib import Path

import pytest

from dse.domain.component import Kind, Type
from dse.errors import DseError, Location, Problem
from dse.loading.include import read_document
from dse.loading.values import read_number, read_value
from dse.loading.workspace import Workspace
from dse.units import UnitError, parse_unit


def problems(load: object, *arguments: str) -> tuple[Problem, ...]:
    with pytest.raises(DseError) as caught:
        load(*arguments)  # type: ignore[operator]
    return caught.value.problems


def everything(root: Path) -> None:
    workspace = Workspace(root)
    workspace.study("gains")


def one_problem(root: Path) -> tuple[str, str, str]:
    found = problems(everything, root)
    assert len(found) == 1, found
    (problem,) = found
    return str(problem.where), problem.what, problem.hint


def test_the_unbroken_workspace_loads(files):
    study = Workspace(files.root).study("gains")
    assert study.variables[0].high == 3.0
    assert study.bench.design.root.parts["sensor"].options[0].component.parameter("range").start == 150.0
    assert study.bench.simulation.stride == 10


CASES = [
    # what is broken: file, old text, new text, place, message, part of the hint
    ("a comma in braces", "testbenches/gains.pet.yaml", "testbench: following", "testbench: following\nconfigurations: {where: max(1, 2) > 1}", "testbenches/gains.pet.yaml:3:32", "unexpected '2) > 1'", "quote an expression"),
    ("unknown key", "components/pd/component.yaml", "unit: 1/s", "units: 1/s", "components/pd/component.yaml:5:36", "unknown key 'units'", "unit"),
    ("unknown key at the top", "testbenches/following.yaml", "design: car", "design: car\nscenario: x", "testbenches/following.yaml:3:1", "unknown key 'scenario'", "possible"),
    ("wrong unit", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 40 kg}", "testbenches/following.yaml:8:34", "wrong unit in '40 kg': expected length, found mass", "write it in m"),
    ("unknown unit", "components/radar/component.yaml", "mass: 300 g", "mass: 300 gs", "components/radar/component.yaml:8:34", "unknown unit 'gs'", "number and a unit"),
    ("no quantity", "components/radar/component.yaml", "cost: 45 EUR", "cost: cheap", "components/radar/component.yaml:8:20", "'cheap' is not a quantity", "write a number and a unit, as '70 km/h'"),
    ("unknown component", "designs/car.yaml", "[radar]", "[rader]", "designs/car.yaml:4:29", "unknown component 'rader'", "did you mean 'radar'?"),
    ("unknown interface", "components/pd/component.yaml", "implements: controller", "implements: controler", "components/pd/component.yaml:2:13", "unknown interface 'controler'", "controller"),
    ("unknown design", "testbenches/following.yaml", "design: car", "design: cart", "testbenches/following.yaml:2:9", "unknown design space 'cart'", "car"),
    ("unknown bench", "testbenches/gains.pet.yaml", "testbench: following", "testbench: followin", "testbenches/gains.pet.yaml:2:12", "unknown test bench 'followin'", "following"),
    ("unknown parameter", "testbenches/gains.pet.yaml", "controller.kp:", "controller.kq:", "testbenches/gains.pet.yaml:4:3", "'controller' has no port or parameter 'kq'", "kp"),
    ("unknown part", "testbenches/gains.pet.yaml", "controller.kp:", "contoller.kp:", "testbenches/gains.pet.yaml:4:3", "'contoller.kp' names no part", "controller"),
    ("empty range of a parameter", "components/pd/component.yaml", "max: 5", "max: -5", "components/pd/component.yaml:5:25", "the range of 'kp' is empty: min 0 > max -5", ""),
    ("start outside the range", "components/pd/component.yaml", "start: 0.8", "start: 8", "components/pd/component.yaml:5:15", "start of 'kp' is outside its range 0 … 5", "widen"),
    ("impossible range", "testbenches/gains.pet.yaml", "[0.1, 3.0]", "[3.0, 0.1]", "testbenches/gains.pet.yaml:4:26", "the range of 'controller.kp' is empty: 3.0 … 0.1", "low, then high"),
    ("range beyond the component's", "testbenches/gains.pet.yaml", "[0.1, 3.0]", "[0.1, 6.0]", "testbenches/gains.pet.yaml:4:26", "the range of 'controller.kp' leaves what component pd allows", "it allows 0 1/s … 5 1/s"),
    ("range with one end", "testbenches/gains.pet.yaml", "[0.1, 3.0]", "[0.1]", "testbenches/gains.pet.yaml:4:26", "'design_variables.controller.kp.range': expected 2 entries, found [0.1]", ""),
    ("value outside the range", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 40 m, controller.kp: 9}", "testbenches/following.yaml:8:55", "kp = 9 is outside its range 0 … 5 1/s", "set by component pd"),
    ("missing key", "testbenches/following.yaml", "{stop: 10 s, ", "{", "testbenches/following.yaml:9:1", "'stop' is missing in 'simulation'", "add 'stop: …'"),
    ("stop no multiple of step", "testbenches/following.yaml", "stop: 10 s", "stop: 10.05 s", "testbenches/following.yaml:9:20", "'stop' (10.05 s) is not a multiple of 'record_every' (100 ms)", "equal steps"),
    ("unknown metric", "testbenches/following.yaml", "metric: gap_undershoot", "metric: gap_undershot", "testbenches/following.yaml:13:16", "unknown metric 'gap_undershot'", "gap_undershoot"),
    ("requirement without a bound", "testbenches/following.yaml", ", at_most: 1 %", "", "testbenches/following.yaml:13:3", "requirement 'R1' has no bound", "at_most"),
    ("not a connection", "testbenches/following.yaml", "controller.torque -> world.torque", "controller.torque world.torque", "testbenches/following.yaml:7:5", "'controller.torque world.torque' is not a connection", "->"),
    ("part named twice", "testbenches/following.yaml", "world: {component: road}", "world: {component: road}\n  sensor: {component: road}", "testbenches/following.yaml:5:3", "'sensor' is a part of the design already", "rename"),
    ("unknown sampler", "testbenches/gains.pet.yaml", "full_factorial", "full_factoral", "testbenches/gains.pet.yaml:5:10", "unknown sampler 'full_factoral'", "full_factorial"),
    ("unknown source kind", "components/pd/component.yaml", "kind: c", "kind: cpp", "components/pd/component.yaml:3:16", "unknown component kind 'cpp'", "c"),
    ("missing source file", "components/pd/component.yaml", "[pd.c]", "[pe.c]", "components/pd/component.yaml:3:27", "no such file: components/pd/pe.c", "relative to"),
    ("enumeration item", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 40 m, sensor.setting: close}", "testbenches/following.yaml:8:56", "'close' is not one of enum[near, far]", "near"),
    ("constraint that says two things", "designs/car.yaml", "because: target price", "forbid: [sensor is radar]", "designs/car.yaml:9:3", "constraint 'budget' has require and forbid", "one of"),
    ("text for a list", "testbenches/following.yaml", "record: [world.gap]", "record: world.gap", "testbenches/following.yaml:9:47", "'simulation.record': expected a list, found 'world.gap'", "[a, b]"),
    ("yes is text in YAML 1.2", "components/pd/component.yaml", "unit: 1/s", "unit: 1/s, tunable: yes", "components/pd/component.yaml:5:56", "'parameters.kp.tunable': expected true or false, found 'yes'", "YAML 1.2"),
    ("port without a unit", "components/road/interfaces.yaml", "gap: m, speed", "gap: [m], speed", "components/road/interfaces.yaml:4:20", "port 'gap' needs a unit or a type", "m/s"),
    ("optional input that is none", "components/road/interfaces.yaml", "inputs: {torque: N.m}", "inputs: {torque: N.m}\n    optional: [torqe]", "components/road/interfaces.yaml:4:16", "there is no input 'torqe'", "did you mean 'torque'?"),
    ("port in a unit that is not SI", "components/road/interfaces.yaml", "speed: m/s", "speed: km/h", "components/road/interfaces.yaml:4:30", "port 'speed' must be in a coherent SI unit, not 'km/h'", "SI inside"),
    # values where none can be given
    ("value for an output", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 40 m, world.speed: 3 m/s}", "testbenches/following.yaml:8:40", "'world.speed' is an output", "inputs that nothing is connected to"),
    ("value for an output of the design", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 40 m, controller.mode: distance}", "testbenches/following.yaml:8:40", "'controller.mode' is an output", "only parameters"),
    ("value for a test component's output", "testbenches/following.yaml", "{component: road}", "{component: road, parameters: {gap: 3 m}}", "testbenches/following.yaml:4:41", "'world.gap' is an output", "only parameters"),
    ("output as a design variable", "testbenches/gains.pet.yaml", "levels: 5}", "levels: 5}\n  world.speed: {range: [1, 2], levels: 2}", "testbenches/gains.pet.yaml:5:3", "'world.speed' is an output", "only parameters"),
    # numbers
    ("time beyond all numbers", "testbenches/following.yaml", "stop: 10 s", "stop: 1e999 s", "testbenches/following.yaml:9:20", "'1e999 s' is beyond the range of numbers", ""),
    ("value beyond all numbers in SI", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 1e307 km}", "testbenches/following.yaml:8:34", "'1e307 km' is beyond the range of numbers", ""),
    ("bare number beyond all numbers", "components/pd/component.yaml", "start: 0.8", "start: 1e999", "components/pd/component.yaml:5:15", "inf is not a finite number", ""),
    ("number of many digits", "components/pd/component.yaml", "start: 0.8", f"start: {'9' * 5000}", "components/pd/component.yaml:5:15", "a number of more than 100 characters", ""),
    ("quantity of many digits", "components/radar/component.yaml", "cost: 45 EUR", f"cost: {'9' * 5000} EUR", "components/radar/component.yaml:8:20", "a number of more than 100 characters", ""),
    ("unit of a million digits", "components/radar/component.yaml", "cost: 45 EUR", "cost: 45 km^999999999", "components/radar/component.yaml:8:20", "unknown unit", ""),
    ("literal beyond all numbers", "testbenches/following.yaml", "undershoot(world.gap, target = controller.set_gap)", "final(world.gap) / 1e400 m", "testbenches/following.yaml:11:38", "beyond the range of numbers", "smaller"),
    ("negative seed", "testbenches/gains.pet.yaml", "sampler: full_factorial", "sampler: {latin_hypercube: {samples: 3}}\nseed: -1", "testbenches/gains.pet.yaml:6:7", "the seed must be 0 … 2^63 - 1, not -1", ""),
    ("more steps than can be kept", "testbenches/following.yaml", "stop: 10 s", "stop: 1e9 s", "testbenches/following.yaml:9:20", "'stop' (1e9 s) takes more than 10,000,000 steps of 10 ms", "longer step"),
    ("step of almost nothing", "testbenches/following.yaml", "step: 10 ms", "step: 1e-300 s", "testbenches/following.yaml:9:20", "takes more than 10,000,000 steps", ""),
    ("no duration", "testbenches/following.yaml", "stop: 10 s", "stop: 0 s", "testbenches/following.yaml:9:20", "'stop' must be positive, not 0 s", ""),
    # text
    ("lone surrogate", "testbenches/following.yaml", "design: car", 'title: "x\\ud800y"\ndesign: car', "testbenches/following.yaml:2:9", "the character U+D800 cannot be used in a text", "remove it"),
    ("terminal sequence", "testbenches/following.yaml", "design: car", 'title: "\\e[31mred"\ndesign: car', "testbenches/following.yaml:2:9", "the character U+001B cannot be used in a text", ""),
    ("terminal sequence as it is", "testbenches/following.yaml", "design: car", "title: x\x1b[31m\ndesign: car", "testbenches/following.yaml:2:9", "the character U+001B cannot be used in a text", ""),
    ("control character of C1", "testbenches/following.yaml", "design: car", 'title: "\\x9b31m"\ndesign: car', "testbenches/following.yaml:2:9", "the character U+009B cannot be used in a text", ""),
    ("text turned round", "testbenches/following.yaml", "design: car", "title: a\u202eb\ndesign: car", "testbenches/following.yaml:2:8", "the character U+202E cannot be used in a text", ""),
    ("isolate in a key", "testbenches/following.yaml", "design: car", '"de\\u2066x": car\ndesign: car', "testbenches/following.yaml:2:2", "the character U+2066 cannot be used in a text", ""),
    ("tag on a mapping", "testbenches/following.yaml", "simulation: {", "simulation: !sim {", "testbenches/following.yaml:9:13", "the tag '!sim' is not supported", "plain values"),
    ("tag on a list", "testbenches/following.yaml", "record: [", "record: !!set [", "testbenches/following.yaml:9:47", "the tag 'tag:yaml.org,2002:set' is not supported", "plain values"),
    ("tag on a key", "testbenches/following.yaml", "design: car", "!k design: car", "testbenches/following.yaml:2:1", "the tag '!k' is not supported", "plain values"),
    # what this version does not do, and shapes
    ("objective without a word", "testbenches/gains.pet.yaml", "sampler:", "objectives: [gap]\nsampler:", "testbenches/gains.pet.yaml:5:14", "expected an objective, found 'gap'", "minimize METRIC"),
    ("objective nobody measures", "testbenches/gains.pet.yaml", "sampler:", "objectives: [minimize gap]\nsampler:", "testbenches/gains.pet.yaml:5:14", "'gap' is not a metric of following", "gap_undershoot"),
    ("sum of what nothing states", "testbenches/gains.pet.yaml", "sampler:", "objectives: [minimize sum(volume)]\nsampler:", "testbenches/gains.pet.yaml:5:14", "no component of the design states 'volume'", "cost"),
    ("objective that calculates with what is none", "testbenches/gains.pet.yaml", "sampler:", "objectives: [minimize 2 * gap]\nsampler:", "testbenches/gains.pet.yaml:5:14", "'gap' is not a metric of following", "gap_undershoot"),
    ("range and values", "testbenches/gains.pet.yaml", "range: [0.1, 3.0]", "range: [0.1, 3.0], values: [1]", "testbenches/gains.pet.yaml:4:3", "give 'controller.kp' either a range or values", "range: [low, high]"),
    ("a value twice", "testbenches/gains.pet.yaml", "range: [0.1, 3.0], levels: 5", "values: [1, 2, 1]", "testbenches/gains.pet.yaml:4:27", "'controller.kp' has a value twice", "remove one"),
    ("a value beyond the component's", "testbenches/gains.pet.yaml", "range: [0.1, 3.0], levels: 5", "values: [1, 9]", "testbenches/gains.pet.yaml:4:27", "leaves what component pd allows", "5 1/s"),
    ("logarithm of zero", "testbenches/gains.pet.yaml", "range: [0.1, 3.0]", "range: [0, 3.0], scale: log", "testbenches/gains.pet.yaml:4:43", "'controller.kp' cannot be on a logarithmic scale", "above 0"),
    ("scale nobody has", "testbenches/gains.pet.yaml", "range: [0.1, 3.0]", "range: [0.1, 3.0], scale: cubic", "testbenches/gains.pet.yaml:4:45", "input should be 'linear' or 'log', found 'cubic'", ""),
    ("derived with a range", "testbenches/gains.pet.yaml", "range: [0.1, 3.0]", "range: [0.1, 3.0], derived: 2 1/s", "testbenches/gains.pet.yaml:4:3", "'controller.kp' is derived: it has no levels and range", "leave it out"),
    ("condition without levels", "testbenches/gains.pet.yaml", "design_variables:", "conditions:\n  controller.set_gap: {range: [30 m, 40 m]}\ndesign_variables:", "testbenches/gains.pet.yaml:4:3", "the condition 'controller.set_gap' needs values, or levels", "levels: 3"),
    ("weights of something else", "testbenches/gains.pet.yaml", "levels: 5}", "levels: 5, weights: [1]}", "testbenches/gains.pet.yaml:4:49", "only a condition with 'values' has weights", "leave them out"),
    ("a weight too few", "testbenches/gains.pet.yaml", "sampler:", "conditions:\n  controller.set_gap: {values: [30 m, 40 m], weights: [1]}\nsampler:", "testbenches/gains.pet.yaml:6:55", "there are 2 values and 1 weights", "one for each value"),
    ("weights of nothing", "testbenches/gains.pet.yaml", "sampler:", "conditions:\n  controller.set_gap: {values: [30 m, 40 m], weights: [0, 0]}\nsampler:", "testbenches/gains.pet.yaml:6:55", "a weight is at least 0", "[3, 2, 1]"),
    ("weights of one bench", "testbenches/gains.pet.yaml", "sampler:", "bench_weights: [1, 2]\nsampler:", "testbenches/gains.pet.yaml:5:16", "there are 1 values and 2 weights", ""),
    ("varied for two reasons", "testbenches/gains.pet.yaml", "sampler:", "conditions:\n  controller.kp: {values: [1]}\nsampler:", "testbenches/gains.pet.yaml:6:3", "'controller.kp' is under 'design_variables', too", "one reason"),
    ("two distributions", "testbenches/gains.pet.yaml", "sampler:", "uncertain:\n  controller.set_gap: {uniform: {low: 30 m, high: 40 m}, normal: {mean: 30 m, sd: 1 m}}\nsampler:", "testbenches/gains.pet.yaml:6:3", "give 'controller.set_gap' exactly one distribution", "normal:"),
    ("no deviation", "testbenches/gains.pet.yaml", "sampler:", "uncertain:\n  controller.set_gap: {normal: {mean: 30 m, sd: 0 m}}\nsampler: {sobol: {samples: 2}}\n#", "testbenches/gains.pet.yaml:6:32", "its standard deviation must be above 0", ""),
    ("correlation of one", "testbenches/gains.pet.yaml", "sampler:", "correlations: [[controller.kp, 0.5]]\nsampler:", "testbenches/gains.pet.yaml:5:16", "expected two names and a number between -1 and 1", ""),
    ("sample of configurations", "testbenches/gains.pet.yaml", "sampler:", "configurations: {sample: 3}\nsampler:", "testbenches/gains.pet.yaml:5:18", "'sample' is not supported in this version", "dse docs formats"),
    ("number for a sampler", "testbenches/gains.pet.yaml", "sampler: full_factorial", "sampler: 3", "testbenches/gains.pet.yaml:5:10", "'sampler': expected text or a mapping, found 3", ""),
    ("list for a value", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: [40]}", "testbenches/following.yaml:8:34", "'controller.set_gap' is not an array, but is given a list", "write one value"),
    ("mapping for a value", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: {a: 40}}", "testbenches/following.yaml:8:34", "'parameters.controller.set_gap': expected text, a number, true or false or a list, found a mapping", ""),
    ("unknown sampler with options", "testbenches/gains.pet.yaml", "sampler: full_factorial", "sampler: {latin_cube: {samples: 3}}", "testbenches/gains.pet.yaml:5:11", "unknown sampler 'latin_cube'", "latin_hypercube"),
    ("sampler without its options", "testbenches/gains.pet.yaml", "sampler: full_factorial", "sampler: {sobol: 3}", "testbenches/gains.pet.yaml:5:18", "'sampler.sobol': expected its options", "{sobol: {samples: 16}}"),
    ("points that are not in the workspace", "testbenches/gains.pet.yaml", "sampler: full_factorial", "sampler: {csv: {file: points.csv}}", "testbenches/gains.pet.yaml:5:23", "points.csv cannot be read: No such file or directory", "check its name"),
    ("executor of a wrong shape", "testbenches/gains.pet.yaml", "sampler:", "executor: {dask: [8786]}\nsampler:", "testbenches/gains.pet.yaml:5:18", "'executor.dask': expected its options", "executor: {dask: {workers: 2}}"),
    ("executor nobody has", "testbenches/gains.pet.yaml", "sampler:", "executor: lokal\nsampler:", "testbenches/gains.pet.yaml:5:11", "unknown executor 'lokal'", "did you mean 'local'"),
    # windows of metrics
    ("window after the run", "testbenches/following.yaml", "metrics:\n", "metrics:\n  late: {expression: final(world.gap), over: [2 s, 20 s]}\n", "testbenches/following.yaml:11:46", "the window [2 s, 20 s] is not within the run, which is from 0 s to 10 s", "'end'"),
    ("window before the run", "testbenches/following.yaml", "metrics:\n", "metrics:\n  late: {expression: final(world.gap), over: [-1 s, 2 s]}\n", "testbenches/following.yaml:11:46", "the window [-1 s, 2 s] is not within the run", "'end'"),
    ("window reversed", "testbenches/following.yaml", "metrics:\n", "metrics:\n  late: {expression: final(world.gap), over: [4 s, 2 s]}\n", "testbenches/following.yaml:11:46", "the window [4 s, 2 s] does not end after its start", "[10 s, 40 s]"),
    ("window of no length", "testbenches/following.yaml", "metrics:\n", "metrics:\n  late: {expression: final(world.gap), over: [end, end]}\n", "testbenches/following.yaml:11:46", "the window [end, end] does not end after its start", "[10 s, 40 s]"),
    ("window with one end", "testbenches/following.yaml", "metrics:\n", "metrics:\n  late: {expression: final(world.gap), over: [4 s]}\n", "testbenches/following.yaml:11:46", "'over' needs a start and an end", "[10 s, end]"),
    ("window in metres", "testbenches/following.yaml", "metrics:\n", "metrics:\n  late: {expression: final(world.gap), over: [4 m, end]}\n", "testbenches/following.yaml:11:47", "wrong unit in '4 m': expected time, found length", "write it in s"),
    ("window that is no list", "testbenches/following.yaml", "metrics:\n", "metrics:\n  late: {expression: final(world.gap), over: 4 s}\n", "testbenches/following.yaml:11:46", "'over' needs a start and an end", "[10 s, end]"),
    ("metric called time", "testbenches/following.yaml", "metrics:\n", "metrics:\n  time: final(world.gap)\n", "testbenches/following.yaml:11:3", "in metrics 'time' is the simulation time", "rename"),
    # names
    ("part called and", "designs/car.yaml", "    controller: pd\n", "    controller: pd\n    and: {optional: pd}\n", "designs/car.yaml:6:5", "'and' is a word of the expression language", "another name"),
    ("metric called if", "testbenches/following.yaml", "metrics:\n", "metrics:\n  if: final(world.gap)\n", "testbenches/following.yaml:11:3", "'if' is a word of the expression language", "another name"),
    ("parameter called double", "components/pd/component.yaml", "parameters:\n", "parameters:\n  double: {start: 1}\n", "components/pd/component.yaml:5:3", "'double' is a word of C", "another name"),
    ("port called while", "components/road/interfaces.yaml", "{gap: m, speed", "{while: m, gap: m, speed", "components/road/interfaces.yaml:4:15", "'while' is a word of C", "another name"),
    ("item called or", "components/radar/component.yaml", "enum: [near, far]", "enum: [near, or]", "components/radar/component.yaml:7:32", "the item 'or' is a word of the expression language", "another word"),
    # sampling
    ("slice that repeats", "testbenches/gains.pet.yaml", "sampler: full_factorial", "sampler: {full_factorial: {slices: [[controller.kp, controller.kp]]}}", "testbenches/gains.pet.yaml:5:53", "'controller.kp' occurs twice in a slice", "remove"),
    ("empty slice", "testbenches/gains.pet.yaml", "sampler: full_factorial", "sampler: {full_factorial: {slices: [[controller.kp], []]}}", "testbenches/gains.pet.yaml:5:54", "a slice names no design variable", "remove"),
    ("nominal outside the range", "testbenches/gains.pet.yaml", "levels: 5}", "levels: 5, nominal: 4}", "testbenches/gains.pet.yaml:4:58", "the nominal value of 'controller.kp' is outside its range 0.1 … 3.0", "widen"),
    # recording
    ("record of a part that is not there", "testbenches/following.yaml", "[world.gap]", "[world.gap, wold.gap]", "testbenches/following.yaml:9:59", "'wold.gap' names no part", "world"),
    ("record of an input", "testbenches/following.yaml", "[world.gap]", "[world.torque]", "testbenches/following.yaml:9:48", "cannot record 'world.torque': no such output", "gap"),
    ("record twice", "testbenches/following.yaml", "[world.gap]", "[world.gap, world.gap]", "testbenches/following.yaml:9:59", "'world.gap' is recorded twice", "remove"),
    ("unknown test component alone", "testbenches/following.yaml", "{component: road}", "{component: rod}", "testbenches/following.yaml:4:22", "unknown component 'rod'", "road"),
    # what lies elsewhere
    ("path for a name", "testbenches/following.yaml", "design: car", "design: /etc/hosts", "testbenches/following.yaml:2:9", "unknown design space '/etc/hosts'", ""),
    ("C file outside the workspace", "components/pd/component.yaml", "[pd.c]", "[pd.c, ../../../secret.c]", "components/pd/component.yaml:3:33", "'../../../secret.c' is outside the workspace", "copy"),
    ("absolute C file", "components/pd/component.yaml", "[pd.c]", "[pd.c, /etc/passwd]", "components/pd/component.yaml:3:33", "'/etc/passwd' is outside the workspace", "copy"),
    ("text for C", "components/pd/component.yaml", "[pd.c]", "[pd.c, component.yaml]", "components/pd/component.yaml:3:33", "'component.yaml' must be a .c or .h file", "another"),
    ("C file for a header", "components/pd/component.yaml", "[pd.c]", "[pd.c], header: pd.c", "components/pd/component.yaml:3:42", "'pd.c' must be a .h file", "another"),
    ("file with a name no disk holds", "components/pd/component.yaml", "[pd.c]", f"[pd.c, {'a' * 300}.c]", "components/pd/component.yaml:3:33", "no such file", "relative"),
    ("include from outside the workspace", "designs/car.yaml", "design: car", "include: [/etc/shadow]\ndesign: car", "designs/car.yaml:1:11", "'/etc/shadow' is outside the workspace", "copy"),
    ("include of another kind of file", "designs/car.yaml", "design: car", "include: [../components/pd/pd.c]\ndesign: car", "designs/car.yaml:1:11", "must be a .yaml or .yml file", "another"),
    ("syntax of a constraint", "designs/car.yaml", "sum(cost) <= 100 EUR", "sum(cost <= 100 EUR", "designs/car.yaml", "", ""),
]  # fmt: skip


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("file", "old", "new", "where", "what", "hint"), [case[1:] for case in CASES], ids=[case[0] for case in CASES]
)
def test_broken_input_is_named_where_it_stands(files, file, old, new, where, what, hint):
    files.edit(file, old, new)
    at, said, advice = one_problem(files.root)
    assert at.startswith(where)
    assert what in said
    assert hint in advice


def test_a_part_that_is_unknown_brings_no_further_problems(files):
    files.edit("testbenches/following.yaml", "{component: road}", "{component: rod}")
    files.edit("testbenches/following.yaml", "figures:\n", "figures:\n  other: {current: world.speed, unit: m/s}\n")
    _, what, _ = one_problem(files.root)
    assert what == "unknown component 'rod'"


def test_a_link_does_not_lead_out_of_the_workspace(files, tmp_path_factory):
    outside = tmp_path_factory.mktemp("outside") / "secret.yaml"
    outside.write_text("password: x\n", encoding="utf-8")
    (files.root / "designs/_link.yaml").symlink_to(outside)
    files.edit("designs/car.yaml", "design: car", "include: [_link.yaml]\ndesign: car")
    where, what, _ = one_problem(files.root)
    assert (where, what) == ("designs/car.yaml:1:11", "'_link.yaml' is outside the workspace")


def test_a_circle_of_links_is_told(files):
    (files.root / "designs/_link.yaml").symlink_to("_link.yaml")
    files.edit("designs/car.yaml", "design: car", "include: [_link.yaml]\ndesign: car")
    where, what, _ = one_problem(files.root)
    assert where == "designs/car.yaml:1:11"
    assert "_link.yaml" in what


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_what_is_no_regular_file_is_not_read(files):
    os.mkfifo(files.root / "designs/_pipe.yaml")
    files.edit("designs/car.yaml", "design: car", "include: [_pipe.yaml]\ndesign: car")
    where, what, _ = one_problem(files.root)
    assert (where, what) == ("designs/_pipe.yaml", "not a regular file")


def test_a_file_of_more_than_10_mb_is_refused(files):
    files.write("designs/car.yaml", "#" * 10_000_001)
    where, what, _ = one_problem(files.root)
    assert (where, what) == ("designs/car.yaml", "the file is larger than 10 MB")


@pytest.mark.parametrize(("length", "fits"), [(19, True), (21, False)])
def test_a_chain_of_includes_has_an_end(files, length, fits):
    files.edit("designs/car.yaml", "design: car", "include: [_0.yaml]\ndesign: car")
    for number in range(length):
        files.write(f"designs/_{number}.yaml", f"include: [_{number + 1}.yaml]\n")
    files.write(f"designs/_{length}.yaml", "title: The end\n")
    if fits:
        assert Workspace(files.root).design("car").title == "The end"
        return
    where, what, _ = one_problem(files.root)
    assert (where, what) == ("designs/_19.yaml:1:11", "files include each other more than 20 deep")


def test_includes_that_double_at_every_level_are_refused(files):
    files.edit("designs/car.yaml", "design: car", "include: [_0.yaml]\ndesign: car")
    for number in range(15):
        files.write(f"designs/_{number}.yaml", f"include: [_{number + 1}.yaml, _{number + 1}.yaml]\n")
    files.write("designs/_15.yaml", "include: []\n")
    _, what, _ = one_problem(files.root)
    assert what == "more than 200 files are included"


def test_a_file_may_include_from_its_own_folder(tmp_path):
    (tmp_path / "a.yaml").write_text("include: [b.yaml]\na: 1\n", encoding="utf-8")
    (tmp_path / "b.yaml").write_text("b: 2\n", encoding="utf-8")
    assert read_document(tmp_path / "a.yaml", tmp_path).data == {"a": 1, "b": 2}


def test_a_path_that_is_not_there_is_in_no_workspace(files):
    (problem,) = problems(Workspace.around, files.root / "nope")
    assert str(problem.where) == "nope"
    assert problem.what == "no such file or folder"


def test_line_breaks_and_tabs_stand_in_texts(files):
    files.edit("designs/car.yaml", "design: car", 'title: "a\\n\\tb ü ∞ 🚗"\ndesign: car')
    assert Workspace(files.root).design("car").title == "a\n\tb ü ∞ 🚗"


@pytest.mark.parametrize("raw", [float("inf"), float("nan"), 10**400, "1e400", "9" * 200, "1e307 km"])
def test_no_number_beyond_floating_point_becomes_a_value(raw):
    with pytest.raises(DseError):
        read_number(raw, parse_unit("m"), Location("here"))


@pytest.mark.parametrize("raw", ["1e99999999", "1/0", "1_000", "0.5", True, "", 2**53 + 1, float("inf")])
def test_what_is_no_whole_number_is_refused_at_once(raw):
    with pytest.raises(DseError):
        read_value(raw, Type(Kind.INTEGER), Location("here"))


def test_units_that_fmus_spell_in_their_own_way():
    # Modelica writes Ohm; a dash is how some tools say that there is none.
    assert parse_unit("kOhm").to_si(2.0) == 2000.0 * parse_unit("V/A").to_si(1.0)
    assert parse_unit("kOhm").dimension == parse_unit("V/A").dimension
    assert parse_unit("-") == parse_unit("1")


def test_conversion_to_a_unit_of_display_overflows_to_infinity():
    assert parse_unit("nm").from_si(-1e300) == -math.inf
    assert parse_unit("km").to_si(1e308) == math.inf
    assert math.isnan(parse_unit("km").from_si(math.nan))


@pytest.mark.parametrize("text", ["km^999999999", "km^9^9^9^9", "(((km^99)^99)^99)^99", "Ym^40"])
def test_a_unit_whose_factor_is_beyond_all_numbers_is_refused_at_once(text):
    with pytest.raises(UnitError):
        parse_unit(text)


def test_a_duplicate_key_names_both_lines(files):
    files.edit("components/pd/component.yaml", "implements: controller", "implements: controller\nimplements: sensor")
    where, what, hint = one_problem(files.root)
    assert where == "components/pd/component.yaml:3:1"
    assert what == "duplicate key 'implements'"
    assert "line 2" in hint


def test_not_yaml_names_the_place(files):
    files.edit("components/pd/component.yaml", "[pd.c]", "[pd.c")
    where, what, _ = one_problem(files.root)
    assert where == "components/pd/component.yaml:3:44"
    assert what.startswith("not valid YAML:")


def test_an_empty_file_says_so(files):
    files.write("designs/car.yaml", "")
    where, what, _ = one_problem(files.root)
    assert (where, what) == ("designs/car.yaml", "the file is empty")


def test_a_list_at_the_top_is_refused(files):
    files.write("designs/car.yaml", "- a\n- b\n")
    where, what, _ = one_problem(files.root)
    assert where == "designs/car.yaml:1:1"
    assert "expected a mapping" in what


def test_a_folder_is_not_a_file(files):
    (problem,) = problems(Workspace(files.root).design, "designs")
    assert str(problem) == "designs: this is a folder, not a file\n    hint: name one of the YAML files in it"


def test_a_missing_file_hints_at_a_similar_name(files):
    (problem,) = problems(Workspace(files.root).design, "designs/cat.yaml")
    assert str(problem) == "designs/cat.yaml: no such file\n    hint: did you mean car.yaml?"


def test_a_file_that_is_not_utf8_is_refused(files):
    (files.root / "designs/car.yaml").write_bytes(b"design: caf\xe9\n")
    where, what, _ = one_problem(files.root)
    assert (where, what) == ("designs/car.yaml", "not UTF-8 text (byte 11)")


def test_an_unreadable_file_says_why(files, monkeypatch):
    path = files.root / "designs/car.yaml"
    if os.name == "nt" or os.geteuid() == 0:
        # Permissions do not bind an administrator: the system's answer is given in its place.
        real = Path.open

        def refuse(self: Path, *arguments: str) -> object:
            if self.name == "car.yaml":
                raise PermissionError(13, "Permission denied")
            return real(self, *arguments)

        monkeypatch.setattr(Path, "open", refuse)
    else:
        path.chmod(0)
    where, what, hint = one_problem(files.root)
    assert (where, what) == ("designs/car.yaml", "cannot be read: Permission denied")
    assert "permissions" in hint


def test_files_that_include_each_other_are_refused(files):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    files.write("designs/more.yaml", "include: [car.yaml]\nconstraints: {}\n")
    where, what, _ = one_problem(files.root)
    assert where == "designs/more.yaml:1:11"
    assert what == "files include each other in a circle: designs/car.yaml -> designs/more.yaml -> designs/car.yaml"


def test_an_included_file_that_is_missing_is_named_at_the_include(files):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    where, what, _ = one_problem(files.root)
    assert where == "designs/car.yaml:1:11"
    assert what == "included file designs/more.yaml does not exist"


def test_included_constraints_keep_their_own_place(files):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    files.write("designs/more.yaml", "constraints:\n  mass: {require: sum(mass <= 1 kg}\n")
    where, _, _ = one_problem(files.root)
    assert where.startswith("designs/more.yaml:2:")


@pytest.mark.parametrize(
    ("more", "place"),
    [("root:\n  compound: {horn: nobody}\n", "2:20"), ("root:\n  connections: [sensor.target]\n", "2:17")],
)
def test_included_parts_and_wires_of_a_design_are_joined_and_keep_their_places(files, more, place):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    files.write("designs/more.yaml", more)
    assert {str(problem.where) for problem in problems(everything, files.root)} == {f"designs/more.yaml:{place}"}


def test_a_constraint_in_both_files_is_refused(files):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    files.write("designs/more.yaml", "constraints:\n  budget: {require: sum(cost) <= 1 EUR}\n")
    where, what, hint = one_problem(files.root)
    assert where == "designs/more.yaml:2:3"
    assert "is defined in an including file too" in what
    assert "designs/car.yaml:10:3" in hint


def test_all_problems_of_a_file_are_found_at_once(files):
    files.edit("components/radar/component.yaml", "start: 150 m", "start: 150 kg")
    files.edit("components/radar/component.yaml", "cost: 45 EUR", "cost: 45 EURO")
    found = problems(Workspace(files.root).component, "radar")
    assert [p.where.line for p in found] == [6, 8]


def test_aliases_that_stand_for_billions_of_values_are_refused(files):
    lines = ["a: &a [x, x, x, x, x, x, x, x, x, x]"]
    names = "abcdefghij"
    lines += [f"{names[i]}: &{names[i]} [{', '.join([f'*{names[i - 1]}'] * 10)}]" for i in range(1, 10)]
    files.write("designs/car.yaml", "\n".join(lines))
    _, what, _ = one_problem(files.root)
    assert "more than 500,000 values once aliases" in what


def test_an_alias_within_its_own_anchor_is_refused(files):
    files.write("designs/car.yaml", "a: &a [*a]")
    _, what, hint = one_problem(files.root)
    assert "more than 100 levels" in what
    assert "never ends" in hint


def test_no_tag_runs_a_constructor(files):
    files.write("designs/car.yaml", "design: !!python/object/apply:os.getcwd []\n")
    with pytest.raises(DseError):
        Workspace(files.root).design("designs/car.yaml")


@pytest.mark.thorough
def test_deep_nesting_is_refused(files):
    files.write("designs/car.yaml", "a: " + "[" * 5000)
    with pytest.raises(DseError):
        Workspace(files.root).design("designs/car.yaml")


def test_outside_a_workspace_the_hint_is_to_make_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (problem,) = problems(Workspace.around, tmp_path)
    assert "dse init" in problem.hint


@pytest.mark.parametrize("name", ["absent", "present"])
def test_what_says_whether_a_part_is_there_is_no_name_of_what_stands_there(files, name):
    path = files.write("components/more.yaml", f"components:\n  {name}: {{properties: {{cost: 1 EUR}}}}\n")
    where, what, _ = one_problem(files.root)
    assert (where, what.partition(" ")[0]) == ("components/more.yaml:2:3", f"'{name}'")
    path.write_text("components:\n  sum: {properties: {cost: 1 EUR}}\n", encoding="utf-8")
    files.write(
        "designs/two.yaml",
        f"design: two\nroot: {{compound: {{a: {{alternatives: [sum, {name}: {{compound: {{b: sum}}}}]}}}}}}\n",
    )
    (problem,) = problems(Workspace(files.root).design, "two")
    assert (problem.where.line, problem.what.partition(" ")[0]) == (2, f"'{name}'")
