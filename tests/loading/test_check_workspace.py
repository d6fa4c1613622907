"""What shows only when files are put together: wiring, metrics, constraints. All of it located."""

from __future__ import annotations

import zipfile

import pytest
from command_line import run_dse

from dse.fmu.component_build import build
from dse.loading.workspace import Workspace
from dse.testbench.check import check_workspace


def test_the_unbroken_workspace_has_no_problem(files):
    problems, counts = check_workspace(Workspace(files.root))
    assert problems == []
    assert counts == {"interface": 3, "component": 3, "design space": 1, "test bench": 1, "study": 1}


CASES = [
    # file, old text, new text, place, message
    ("testbenches/following.yaml", "world.scene -> sensor.scene", "world.scene -> sensor.picture", "testbenches/following.yaml:6:27", "no port"),
    ("testbenches/following.yaml", "world.scene -> sensor.scene", "world.speed -> sensor.scene.range", "testbenches/following.yaml:6:5", "world.speed -> sensor.scene.range: units differ: m/s and m"),
    ("testbenches/following.yaml", "  - controller.torque -> world.torque\n", "", "testbenches/following.yaml:1:12", "input world.torque (road) is neither connected nor given a value"),
    ("testbenches/following.yaml", "undershoot(world.gap,", "undershoot(world.gapp,", "testbenches/following.yaml:11:30", "world.gapp"),
    ("testbenches/following.yaml", "undershoot(world.gap,", "undershot(world.gap,", "testbenches/following.yaml:11:19", "undershot"),
    ("testbenches/following.yaml", "at_most: 1 %", "at_most: 1 m", "testbenches/following.yaml:13:3", "'gap_undershoot' is"),
    ("testbenches/following.yaml", "record: [world.gap]", "record: [world.gapp]", "testbenches/following.yaml:9:48", "cannot record 'world.gapp'"),
    ("testbenches/following.yaml", "target = controller.set_gap)", "target = controller.kp)", "testbenches/following.yaml:11:50", "'target' of undershoot must be length, found 1/time"),
    ("designs/car.yaml", "sum(cost) <= 100 EUR", "sum(cost) <= 100 kg", "designs/car.yaml:9:34", "cannot compare currency and mass"),
    ("designs/car.yaml", "sum(cost) <= 100 EUR", "sum(csot) <= 100 EUR", "designs/car.yaml:9:", "csot"),
    ("designs/car.yaml", "sum(cost) <= 100 EUR", "sum(cost) <= 1 EUR", "designs/car.yaml", "no valid configuration"),
    ("testbenches/gains.pet.yaml", "testbench: following", "testbench: following\nconfigurations: {where: sensr is radar}", "testbenches/gains.pet.yaml:3:25", "sensr"),
    ("testbenches/gains.pet.yaml", "testbench: following", "testbench: following\nconfigurations: {where: sum(cost) > 1000 EUR}", "testbenches/gains.pet.yaml:3:25", "no configuration meets the condition"),
    ("testbenches/following.yaml", "step: 10 ms,", "step: 20 ms,", "testbenches/following.yaml:9:1", "controller (pd) samples every 0.01 s, no multiple of the step 0.02 s"),
    ("designs/car.yaml", "[radar]", "[radar, pd]", "designs/car.yaml:4", "different interfaces"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("file", "old", "new", "where", "what"), CASES, ids=[case[2].strip() or "removed" for case in CASES]
)
def test_what_does_not_fit_together_is_named_where_it_stands(files, file, old, new, where, what):
    files.edit(file, old, new)
    problems, _ = check_workspace(Workspace(files.root))
    assert problems
    assert any(str(p.where).startswith(where) and what in p.what for p in problems), problems


@pytest.mark.thorough
def test_the_command_line_shows_problems_and_no_traceback(files):
    files.edit("components/radar/component.yaml", "min: 10 m", "min: 10 kg")
    files.edit("designs/car.yaml", "because", "becuase")
    done = run_dse(files.root, "check", cache=files.root / "cache")
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr == (
        "components/radar/component.yaml:6:30: wrong unit in '10 kg': expected length, found mass\n"
        "    hint: write it in m\n"
        "designs/car.yaml:9:43: unknown key 'becuase'\n"
        "    hint: did you mean 'because'?\n"
        "2 problems\n"
    )


def test_c_that_does_not_compile_is_told_with_all_other_problems_at_its_line(files):
    files.edit("components/pd/pd.c", "(void)self;\n}\n", "self->out.torqe = 1;\n}\n")
    files.edit("components/road/road.c", "    (void)self;\n", "    oops(self);\n")
    files.edit("components/radar/component.yaml", "min: 10 m", "min: 10 kg")
    files.edit("testbenches/following.yaml", "stop: 10 s", "stop: 10 m")
    files.edit("testbenches/gains.pet.yaml", "full_factorial", "full_factorio")
    problems, _ = check_workspace(Workspace(files.root))
    assert {str(problem.where).rpartition(":")[0] for problem in problems} == {
        "components/pd/pd.c:4",
        "components/radar/component.yaml:6",
        "components/road/road.c:4",
        "testbenches/following.yaml:9",
        "testbenches/gains.pet.yaml:5",
    }


def test_a_broken_interface_does_not_hide_what_is_wrong_elsewhere(files):
    files.edit("components/interfaces.yaml", "      set_gap: m\n", "      set_gap: mm/\n")
    files.edit("testbenches/following.yaml", "at_most: 1 %", "at_mots: 1 %")
    files.edit("testbenches/gains.pet.yaml", "levels: 5", "lvels: 5")
    problems, _ = check_workspace(Workspace(files.root))
    assert {str(problem.where).partition(":")[0] for problem in problems} == {
        "components/interfaces.yaml",
        "testbenches/following.yaml",
        "testbenches/gains.pet.yaml",
    }


def test_without_a_compiler_c_is_passed_over_and_that_is_told(files, monkeypatch):
    from dse.fmu.toolchain import compiler

    def none(*_):
        raise compiler.no_compiler()

    monkeypatch.setattr("dse.fmu.c.build.with_compiler", none)
    ignored = []
    assert check_workspace(Workspace(files.root), None, ignored)[0] == []
    assert "C was not compiled: there is no C compiler on this machine" in {problem.what for problem in ignored}


def test_a_file_must_be_called_after_what_it_defines(files):
    files.write("designs/other.yaml", (files.root / "designs/car.yaml").read_text(encoding="utf-8"))
    (problem,) = check_workspace(Workspace(files.root))[0]
    assert str(problem.where) == "designs/other.yaml:1:9"
    assert problem.what == "'car' is defined in a file called 'other.yaml'"


def test_two_files_of_one_name_are_refused(files):
    files.write("designs/old/car.yaml", (files.root / "designs/car.yaml").read_text(encoding="utf-8"))
    problems = check_workspace(Workspace(files.root))[0]
    assert [problem.what for problem in problems] == ["two files are called 'car.yaml'"]


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_does_not_depend_on_where_its_workspace_lies(tmp_path, version):
    """A component that shares its C, by a path upwards, with another."""
    archives = []
    for place in ("here", "some/where/else"):
        root = tmp_path / place
        (root / "components/shared").mkdir(parents=True)
        (root / "components/own/part").mkdir(parents=True)
        (root / "components/shared/gain.h").write_text(
            "typedef struct { struct { double u; } in; struct { double y; } out; struct { double k; } par; } gain;\n"
            "void gain_init(gain *g);\nvoid gain_step(gain *g, double h);\n",
            encoding="utf-8",
        )
        (root / "components/shared/gain.c").write_text(
            '#include "gain.h"\nvoid gain_init(gain *g) { g->out.y = g->par.k * g->in.u; }\n'
            "void gain_step(gain *g, double h) { (void)h; gain_init(g); }\n",
            encoding="utf-8",
        )
        (root / "components/interfaces.yaml").write_text(
            "interfaces: {amplifier: {inputs: {u: m}, outputs: {y: m}}}\n", encoding="utf-8"
        )
        (root / "components/own/part/component.yaml").write_text(
            "component: part\nimplements: amplifier\nparameters: {k: {start: 2}}\n"
            "source: {kind: c, files: [../../shared/gain.c], header: ../../shared/gain.h, struct: gain}\n",
            encoding="utf-8",
        )
        component = Workspace(root).component("part")
        archives.append(build(component, version=version, cache=tmp_path / place / "cache"))
    first, second = archives
    assert first.read_bytes() == second.read_bytes()
    with zipfile.ZipFile(first) as opened:
        own = [name for name in opened.namelist() if name.startswith("sources/component/")]
    assert own == ["sources/component/gain.c", "sources/component/gain.h"]
    assert str(tmp_path).encode() not in first.read_bytes()


def test_newton_metres_are_not_read_as_nanometres(files):
    files.edit("components/interfaces.yaml", "torque: N.m", "torque: Nm")
    problems = check_workspace(Workspace(files.root))[0]
    assert problems[0].what == "unknown unit 'Nm': write N.m"


def test_what_is_being_checked_is_told(files):
    told = []
    check_workspace(Workspace(files.root), lambda *said: told.append(said))
    assert [said for said in told if said[0] == "components"] == [
        ("components", 1, 3, "pd"),
        ("components", 2, 3, "radar"),
        ("components", 3, 3, "road"),
    ]
    assert told[3:] == [
        ("design spaces", 1, 1, "car.yaml"),
        ("test benches and studies", 1, 2, "following.yaml"),
        ("test benches and studies", 2, 2, "gains.pet.yaml"),
    ]
