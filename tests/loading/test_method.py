"""The keys of ``simulation`` that choose the algorithm, and what they become for one configuration."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dse.domain.method import PLAIN, Adaptive, Algorithm, Bond, Coupling, Extrapolation, Method
from dse.errors import DseError
from dse.loading.workspace import Workspace
from dse.testbench.check import check_workspace
from dse.testbench.method import method_of
from dse.testbench.selection import one_configuration
from dse.testbench.wired_bench import WiredBench, wire_bench

BENCH = "testbenches/following.yaml"
ROAD = """\
interfaces:
  world:
    inputs: {torque: N.m}
    outputs: {gap: m, speed: rad/s, scene: {range: m, visible: bool}}
"""


def with_keys(files, keys: str) -> Workspace:
    files.edit(BENCH, "record_every: 100 ms", f"record_every: 100 ms, {keys}")
    return Workspace(files.root)


def method(files, keys: str) -> Method:
    return with_keys(files, keys).bench("following").simulation.method


def test_without_keys_the_method_is_the_plain_one(files):
    assert Workspace(files.root).bench("following").simulation.method == PLAIN


def test_every_key_is_read(files):
    found = method(
        files,
        "algorithm: gauss_seidel, coupling: solve, extrapolation: {world: linear}, steps: {controller: 5 ms, world: 20 ms}",
    )
    assert (found.algorithm, found.coupling) == (Algorithm.GAUSS_SEIDEL, Coupling.SOLVE)
    assert found.extrapolation is Extrapolation.HOLD
    assert found.extrapolations == {"world": Extrapolation.LINEAR}
    assert found.steps == {"controller": 0.005, "world": 0.02}


def test_one_extrapolation_is_for_all(files):
    assert method(files, "extrapolation: linear").extrapolation is Extrapolation.LINEAR


def test_what_fmus_are_told_is_read(files):
    assert with_keys(files, "tolerance: 1e-8").bench("following").simulation.tolerance == 1e-8


def test_an_adaptive_step_has_defaults(files):
    assert method(files, "adaptive: {tolerance: 1e-3}").adaptive == Adaptive(1e-3, 1e-6, 1e-6)


PROBLEMS = [
    ("algorithm: jakobi", "'jakobi' is none of jacobi, gauss_seidel", "did you mean 'jacobi'?"),
    ("coupling: loose", "'loose' is none of none, propagate, solve", ""),
    ("extrapolation: cubic", "'cubic' is none of hold, linear", ""),
    ("algorithm: [jacobi]", "'simulation.algorithm': expected text, found a list", "jacobi or gauss_seidel"),
    ("coupling: 3", "'simulation.coupling': expected text, found 3", "none, propagate or solve"),
    ("adaptive: true", "'simulation.adaptive': expected a mapping, found true", "or {} for these defaults"),
    ("memory: 4", "'memory' is 4 B, less than", "write it as '4 GB'"),
    ("extrapolation: {wrld: linear}", "'wrld' names no part", "did you mean 'world'?"),
    ("steps: {wrld: 1 ms}", "'wrld' names no part", "did you mean 'world'?"),
    ("steps: {world: 3 ms}", "neither a multiple nor a fraction of 'step' (10 ms)", ""),
    ("steps: {world: 0 ms}", "'world' must be positive, not 0 ms", ""),
    ("steps: {world: 1 m}", "wrong unit in '1 m'", ""),
    ("tolerance: 1", "'tolerance' must be below 1", ""),
    ("tolerance: 0", "'tolerance' must be positive, not 0", ""),
    ("tolerance: 1 ms", "wrong unit in '1 ms'", ""),
    ("adaptive: {tolerance: 2}", "'tolerance' must be below 1", ""),
    ("adaptive: {smallest: 1 s}", "'smallest' (1 s) is longer than the step", ""),
    ("adaptive: {}, steps: {world: 20 ms}", "'world' cannot have a longer step", ""),
    ("bonds: {axle: {effort: controller.torque, flow: world.gap}}", "is not a power", ""),
    ("bonds: {axle: {effort: controller.torque, flow: world.torque}}", "'world.torque' is not an output", ""),
    ("bonds: {axle: {effort: controller.torqe, flow: world.speed}}", "no port or parameter 'torqe'", ""),
    ("bonds: {axle: {effort: controller.torque}}", "'flow' is missing", ""),
    ("bonds: {2nd: {effort: controller.torque, flow: world.speed}}", "'2nd' cannot be a name", ""),
]


@pytest.mark.parametrize(("keys", "what", "hint"), PROBLEMS, ids=[case[0] for case in PROBLEMS])
def test_what_is_wrong_is_named_in_the_line_of_the_simulation(files, keys, what, hint):
    workspace = with_keys(files, keys)
    with pytest.raises(DseError) as caught:
        workspace.bench("following")
    found = [problem for problem in caught.value.problems if what in problem.what]
    assert found, caught.value.problems
    assert str(found[0].where).startswith(f"{BENCH}:9:")
    assert hint in found[0].hint


def test_a_part_called_bonds_is_refused_where_there_are_bonds(files):
    files.write("components/road/interfaces.yaml", ROAD)
    files.edit(BENCH, "  world: {component: road}", "  world: {component: road}\n  bonds: {component: road}")
    workspace = with_keys(files, "bonds: {axle: {effort: controller.torque, flow: world.speed}}")
    with pytest.raises(DseError, match="a part is called 'bonds'"):
        workspace.bench("following")


def test_a_bond_that_is_not_wired_both_ways_is_refused(files):
    files.write("components/road/interfaces.yaml", ROAD)
    workspace = with_keys(files, "bonds: {axle: {effort: controller.torque, flow: world.speed}}")
    problems, _ = check_workspace(workspace)
    (found,) = problems
    assert found.what == "bond 'axle': world.speed is not connected to controller"
    assert str(found.where).startswith(f"{BENCH}:9:1")


def wired(files) -> None:
    files.write("components/road/interfaces.yaml", ROAD)
    files.edit("components/interfaces.yaml", "      set_gap: m\n", "      set_gap: m\n      rim: rad/s\n")
    files.edit(BENCH, "  - controller.torque", "  - world.speed -> controller.rim\n  - controller.torque")


def test_the_energy_of_a_bond_can_be_recorded_and_measured(files):
    wired(files)
    files.edit(BENCH, "record: [world.gap]", "record: [world.gap, bonds.axle]")
    files.edit(BENCH, "metrics:\n", "metrics:\n  lost: maximum(bonds.axle)\n")
    files.edit(BENCH, "requirements:\n", "requirements:\n  R0: {metric: lost, at_most: 1 J}\n")
    workspace = with_keys(files, "bonds: {axle: {effort: controller.torque, flow: world.speed}}")
    assert check_workspace(workspace)[0] == []


def test_a_bond_that_is_not_there_cannot_be_recorded(files):
    files.edit(BENCH, "record: [world.gap]", "record: [bonds.axle]")
    with pytest.raises(DseError, match=r"'bonds\.axle' names no part"):
        Workspace(files.root).bench("following")


def roads(files, said: Method, *places: str) -> WiredBench:
    """The component at all *places* of a bench with this method."""
    workspace = Workspace(files.root)
    bench = workspace.bench("following")
    bench = replace(bench, simulation=replace(bench.simulation, method=said))
    parts = dict.fromkeys(places, workspace.component("road"))
    return WiredBench(parts, bench=bench, configuration=one_configuration(bench.design, None), faces={})


def test_bench_names_become_those_of_elements(files):
    wired(files)
    workspace = with_keys(
        files, "steps: {controller: 5 ms}, bonds: {axle: {effort: controller.torque, flow: world.speed}}"
    )
    bench = workspace.bench("following")
    found = method_of(wire_bench(bench, one_configuration(bench.design, None)), [])
    assert found.steps == {"controller": 0.005}
    assert found.bonds == (Bond("axle", "controller.torque", "world.speed"),)


def test_what_is_said_of_an_architecture_holds_for_its_parts_unless_they_have_their_own(files):
    said = Method(steps={"powertrain": 0.001, "powertrain.engine": 0.002, "absent": 0.003})
    found = method_of(roads(files, said, "powertrain.engine", "powertrain.gearbox", "world"), [])
    assert found.steps == {"powertrain.engine": 0.002, "powertrain.gearbox": 0.001}


def test_a_bond_of_an_absent_part_is_left_out(files):
    said = Method(bonds=(Bond("axle", "world.speed", "powertrain.torque"),))
    problems: list = []
    assert method_of(roads(files, said, "world"), problems).bonds == ()
    assert problems == []
