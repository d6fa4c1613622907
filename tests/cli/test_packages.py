"""SSP packages as a user meets them: a bench exported, simulated here and in FMPy, and made a workspace again."""

from __future__ import annotations

import csv
import importlib.util
import json
import re
import zipfile
from io import BytesIO
from pathlib import Path

import fmpy
import numpy as np
import pytest
from reference_fmus import build
from ssp_packages import (
    binding,
    bindings,
    component,
    connection,
    connections,
    connectors,
    description,
    elements,
    pack,
    parameter_set,
)
from workspaces import written

from dse import DseError, simulate
from dse.api import simulate as simulate_package

FILES = {
    "components/interfaces.yaml": """\
interfaces:
  source: {outputs: {y: m}}
  lag: {inputs: {u: m, back: m}, outputs: {x: m, mode: "enum[low, high]", steps: int, positive: bool}}
""",
    "components/ramp/component.yaml": """\
component: ramp
implements: source
source: {kind: c, files: [ramp.c]}
parameters: {rate: {start: 2 m/s}}
""",
    "components/ramp/ramp.h": """\
typedef struct { struct { double y; } out; struct { double rate; } par; double time; } ramp;
void ramp_init(ramp *self);
void ramp_step(ramp *self, double h);
""",
    "components/ramp/ramp.c": """\
#include "ramp.h"
void ramp_init(ramp *self) { self->time = 0; self->out.y = 0; }
void ramp_step(ramp *self, double h) { self->time += h; self->out.y = self->par.rate * self->time; }
""",
    "components/lag/component.yaml": """\
component: lag
implements: lag
source: {kind: c, files: [lag.c]}
parameters: {time_constant: {start: 0.5 s, min: 0.01 s}, start_value: {start: 0 m}}
""",
    "components/lag/lag.h": """\
#include <stdbool.h>
#include <stdint.h>
typedef struct {
    struct { double u, back; } in;
    struct { double x; int32_t mode, steps; bool positive; } out;
    struct { double time_constant, start_value; } par;
} lag;
void lag_init(lag *self);
void lag_step(lag *self, double h);
""",
    "components/lag/lag.c": """\
#include "lag.h"
void lag_init(lag *self) {
    self->out.x = self->par.start_value;
    self->out.steps = self->out.mode = 0;
    self->out.positive = false;
}
void lag_step(lag *self, double h) {
    self->out.x += h * (self->in.u - self->in.back - self->out.x) / self->par.time_constant;
    self->out.steps += 1;
    self->out.mode = self->out.x > 0.5;
    self->out.positive = self->out.x > 0;
}
""",
    "designs/chain.yaml": """\
design: chain
root:
  compound: {first: lag, second: lag}
  connections: [first.x -> second.u, second.x -> first.back, second.x -> second.back]
""",
    "testbenches/ramped.yaml": """\
testbench: ramped
title: Two lags behind a ramp
design: chain
test_components: {drive: {component: ramp}}
connections: [drive.y -> first.u]
parameters: {first.time_constant: 250 ms}
simulation:
  stop: 2 s
  step: 15.625 ms
  record: [first.x, second.x, second.mode, first.steps, first.positive]
  record_every: 31.25 ms
  tolerance: 1e-7
metrics: {end: final(second.x)}
""",
}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("lags")
    return written(folder, FILES)


@pytest.fixture(scope="module")
def package(workspace, dse_in) -> Path:
    done = dse_in(workspace, "export", "ssp", "ramped", "-o", "ramped.ssp")
    assert done.returncode == 0, done.stderr
    assert "ramped.ssp: configuration" in done.stdout
    assert "note: the package lacks the bench's 1 metric, for which SSP has no place" in done.stderr
    return workspace / "ramped.ssp"


def waveforms(file: Path) -> dict[str, np.ndarray]:
    with file.open(encoding="utf-8", newline="") as opened:
        header, *rows = csv.reader(opened)
    return dict(zip(header, np.array(rows, dtype=np.float64).T, strict=True))


@pytest.fixture(scope="module")
def simulated(package, dse_in) -> dict[str, np.ndarray]:
    """The package's waveforms at every step."""
    done = dse_in(package.parent, "simulate", package.name, "--step", "15.625 ms", "-o", "out.csv")
    assert done.returncode == 0, done.stderr
    return waveforms(package.parent / "out.csv")


@pytest.mark.thorough
def test_a_package_is_simulated_as_it_says(dse, package):
    done = dse("simulate", str(package))
    assert done.returncode == 0, done.stderr
    assert "2 s (the package) in steps of 0.015625 s (the package)" in done.stdout
    assert [line.split()[0] for line in done.stdout.splitlines()[4:]][:3] == ["drive.y", "first.x", "first.steps"]


@pytest.mark.thorough
def test_the_package_gives_what_the_bench_gives_bit_for_bit(workspace, dse_in, package, tmp_path):
    done = dse_in(workspace, "run", "ramped", "-o", str(tmp_path / "study"))
    assert done.returncode == 0, done.stderr
    from dse.storage.folder import StudyFolder

    with StudyFolder.open(tmp_path / "study") as study:
        expected = study.run(0).waveforms.values
    done = dse_in(workspace, "simulate", "ramped.ssp", "-o", str(tmp_path / "kept.csv"))
    assert done.returncode == 0, done.stderr
    kept = waveforms(tmp_path / "kept.csv")
    assert len(kept["time"]) == 65
    for name, values in expected.items():
        assert np.array_equal(kept[name], values), name


@pytest.mark.thorough
def test_a_package_is_simulated_in_one_line_of_python(package, simulated):
    found = simulate_package(package, step=1 / 64)
    assert np.array_equal(found.time, simulated["time"])
    for name in found:
        assert np.array_equal(found[name], simulated[name]), name


def test_fmpy_simulates_the_exported_package_alike(package, simulated):
    """FMPy leaves out the parameter bindings of a package (they are given to it by hand here), starts every input with
    0 in its first step whatever the outputs are (so they are 0 here), writes a step's end beside its beginning's time
    (so rows are shifted), and knows neither transformations nor units."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import ParameterSet, find_components, read_ssd

    given = ParameterSet(name="by hand")
    for part in find_components(read_ssd(str(package)).system):
        for bound in part.parameterBindings:
            for value in bound.parameterValues[0].parameters:
                value.name = f"{part.name}.{value.name}"
                given.parameters.append(value)
    assert [p.name for p in given.parameters] == ["first.time_constant"]
    rows = simulate_ssp(str(package), stop_time=2.0, step_size=1 / 64, parameter_set=given)
    assert len(rows) == 128
    compared = [name for name in rows.dtype.names if name in simulated and name != "time"]
    assert {"first.x", "second.x", "second.mode", "first.steps", "first.positive", "drive.y"} <= set(compared)
    for name in compared:
        # The same FMUs are given the same numbers: nothing but rounding in FMPy's sum of steps could differ.
        np.testing.assert_allclose(rows[name].astype(float), simulated[name][1:], rtol=1e-9, atol=1e-12, err_msg=name)


@pytest.fixture(scope="module")
def imported(package, dse_in, tmp_path_factory) -> Path:
    """The workspace that is made of the package. Tests do not change it."""
    folder = tmp_path_factory.mktemp("imported")
    done = dse_in(folder, "import", "ssp", str(package), "back")
    assert done.returncode == 0, done.stderr
    assert "next: dse simulate back/testbenches/ramped.yaml" in done.stdout
    return folder / "back"


def test_import_and_export_again_gives_the_same_bytes(package, dse_in, imported, tmp_path):
    done = dse_in(imported, "export", "ssp", "ramped", "-o", str(tmp_path / "again.ssp"))
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "again.ssp").read_bytes() == package.read_bytes()


@pytest.mark.thorough
@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")
def test_a_package_for_other_platforms_differs_by_their_libraries_only(package, workspace, dse_in):
    done = dse_in(workspace, "export", "ssp", "ramped", "-o", "others.ssp", "--platform", "win64")
    assert done.returncode == 0, done.stderr
    plain, others = (zipfile.ZipFile(workspace / name) for name in ("ramped.ssp", "others.ssp"))
    assert plain.namelist() == others.namelist()
    for name in plain.namelist():
        if name.endswith(".fmu"):
            before, after = (set(zipfile.ZipFile(BytesIO(each.read(name))).namelist()) for each in (plain, others))
            assert after - before == {f"binaries/win64/{Path(name).stem}.dll"}
        else:
            assert plain.read(name) == others.read(name)


@pytest.mark.thorough
def test_an_imported_workspace_is_checked_and_simulated_at_once(dse_in, imported, simulated):
    done = dse_in(imported, "check")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "ok: 2 interfaces, 2 components, 1 design space, 1 test bench, 0 studies\n"
    done = dse_in(imported, "simulate", "ramped", "--format", "json", "--set", "drive.rate=4 m/s")
    assert done.returncode == 0, done.stderr
    # The chain is linear, so twice the ramp is twice the answer, to the last bit as two is a power of two.
    assert json.loads(done.stdout)["metrics"]["second_x_at_the_end"] == 2 * simulated["second.x"][-1]


def test_nothing_that_is_there_is_overwritten(package, dse_in, imported):
    done = dse_in(imported.parent, "import", "ssp", str(package), "back")
    assert done.returncode == 1
    assert "back/designs/ramped.yaml: the file already exists" in done.stderr


@pytest.mark.thorough
def test_waveforms_are_written_as_json_too_and_the_values_are_the_same(package, dse_in, tmp_path, simulated):
    target = tmp_path / "out.json"
    done = dse_in(package.parent, "simulate", package.name, "--step", "15.625 ms", "-o", str(target))
    assert done.returncode == 0, done.stderr
    data = json.loads(target.read_text(encoding="utf-8"))
    assert data["system"] == "ramped"
    assert data["signals"]["first.x"]["unit"] == "m"
    assert data["signals"]["first.x"]["values"] == simulated["first.x"].tolist()
    assert data["time"] == simulated["time"].tolist()


@pytest.mark.thorough
def test_a_setting_changes_a_package_too(package, dse_in, simulated):
    done = dse_in(package.parent, "simulate", package.name, "--set", "drive.rate=4", "--format", "json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["signals"]["second.x"]["end"] == 2 * simulated["second.x"][-1]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("arguments", "code", "expected"),
    [
        (["ramped.ssp", "--set", "drive.rat=4"], 1, "no 'drive.rat' to set\n    hint: did you mean 'drive.rate'?"),
        (["ramped.ssp", "--step", "0.3 s"], 1, "is not a whole number of steps"),
        (["ramped.ssp", "-o", "out.txt"], 2, "must end in .csv, .json or .parquet"),
        (["ramped.ssp", "--algorithm", "jakobi"], 2, "'jakobi' is none of jacobi, gauss_seidel"),
        (["ramped", "--stop", "1 s"], 2, "this is for a package"),
        (["ramped", "--tolerance", "1e-8"], 2, "this is for a package"),
        (["ramped.ssp", "--fmi", "3"], 2, "this is for a bench"),
        (["radar.fmu"], 1, "radar.fmu: there is no such file"),
        (["gone.ssp"], 1, "gone.ssp: there is no such file"),
    ],
)  # fmt: skip
def test_what_cannot_be_simulated_is_told(package, dse_in, arguments, code, expected):
    done = dse_in(package.parent, "simulate", *arguments)
    assert done.returncode == code
    assert expected in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.thorough
def test_the_order_of_exchange_can_be_chosen(package, dse_in, simulated):
    done = dse_in(package.parent, "simulate", package.name, "--algorithm", "gauss_seidel", "--format", "json")
    assert done.returncode == 0, done.stderr
    newest = json.loads(done.stdout)["signals"]["second.x"]["end"]
    # What comes through the chain a step earlier is larger behind a ramp, by no more than the ramp's steps.
    assert simulated["second.x"][-1] < newest < simulated["second.x"][-1] + 2 * 2 * 2 / 64


# Packages of others


@pytest.fixture(scope="module")
def dahlquist(tmp_path_factory) -> bytes:
    return build("Dahlquist", 2, "CoSimulation", tmp_path_factory.mktemp("fmus")).read_bytes()


def decay(k: str, name: str, source: str = "resources/Dahlquist.fmu") -> str:
    own = bindings(binding(parameter_set(f"k Real {k}")))
    inner = elements(component("d", "output x", source=source, more=own))
    more = connectors("output level") + inner + connections(connection("d.x", ".level"))
    return description(more, '<ssd:DefaultExperiment stopTime="1"/>', name=name)


@pytest.fixture
def foreign(tmp_path, dahlquist) -> Path:
    files = {
        "SystemStructure.ssd": decay("1", "slow"),
        "Fast.ssd": decay("2", "fast"),
        "resources/Dahlquist.fmu": dahlquist,
    }
    return pack(tmp_path / "foreign.ssp", files)


@pytest.mark.thorough
def test_a_foreign_package_and_its_variants_are_simulated(foreign, dse_in, tmp_path):
    for variant, rate in (("SystemStructure", 1.0), ("fast", 2.0)):
        done = dse_in(tmp_path, "simulate", "foreign.ssp", "--variant", variant, "--format", "json")
        assert done.returncode == 0, done.stderr
        data = json.loads(done.stdout)
        assert (data["stop"], data["step"]) == (1.0, 0.1)
        # The FMU integrates with RK4 in steps of its own of at most 0.1 s: its error is below (k h)^5.
        assert data["signals"]["level"]["end"] == pytest.approx(np.exp(-rate), abs=(0.1 * rate) ** 5)


@pytest.mark.thorough
def test_a_single_fmu_is_simulated_by_the_names_it_has_itself(dse_in, tmp_path, dahlquist, monkeypatch):
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    path = tmp_path / "2 body.fmu"  # its name is no word
    path.write_bytes(dahlquist)
    done = dse_in(tmp_path, "simulate", path.name, "--set", "k=2", "--stop", "1 s", "--format", "json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["signals"]["x"]["end"] == pytest.approx(np.exp(-2), abs=0.2**5)
    assert dse_in(tmp_path, "check", path.name).stdout == "ok: 1 FMU, 1 output\n"
    wrong = dse_in(tmp_path, "simulate", path.name, "--set", "kk=2")
    assert wrong.returncode == 1
    meant = wrong.stderr.partition("did you mean '")[2].partition("'")[0]
    assert dse_in(tmp_path, "simulate", path.name, "--set", f"{meant}=2").returncode == 0

    theirs = fmpy.simulate_fmu(str(path), stop_time=1.0, step_size=0.1, start_values={"k": 2.0})
    ours = simulate(path, stop=1, step=0.1, set={"k": 2})
    assert list(ours) == ["x"]
    # Its points in time are sums of steps, ours multiples.
    np.testing.assert_allclose(ours["x"], theirs["x"], rtol=1e-14)
    assert list(simulate(path, record=["k", "der(x)"])) == ["k", "der(x)"]
    with pytest.raises(DseError, match=r"no 'x2_body\.q' to record"):
        simulate(path, record=["q"])
    with pytest.raises(DseError, match=r"README\.md"):
        simulate("README.md")


@pytest.mark.thorough
def test_what_is_ignored_is_told_by_every_command_and_refused_if_asked(dse_in, tmp_path, dahlquist):
    text = decay("1", "slow").replace("<ssd:Component ", '<ssd:Component colour="red" ')
    fmu = rezipped(dahlquist, tmp_path / "Dahlquist.fmu", "extra/aux.txt")
    pack(tmp_path / "odd.ssp", {"SystemStructure.ssd": text, "resources/Dahlquist.fmu": fmu})
    told = ("odd.ssp/SystemStructure.ssd:4:", "<Component> has no attribute 'colour'", "Dahlquist.fmu: the path")
    for arguments in (["check", "odd.ssp"], ["simulate", "odd.ssp", "--format", "json"]):
        done = dse_in(tmp_path, *arguments)
        assert done.returncode == 0, done.stderr
        assert done.stderr.count("ignored: ") == 2
        assert all(piece in done.stderr for piece in told)
        if "json" in arguments:
            assert ["colour" in what for what in json.loads(done.stdout)["ignored"]] == [True, False]
        strict = dse_in(tmp_path, *arguments, "--strict")
        assert strict.returncode == 1
        assert not strict.stdout
        assert all(piece in strict.stderr for piece in told)
    done = dse_in(tmp_path, "import", "fmu", "Dahlquist.fmu", "-o", "work")
    assert "ignored: Dahlquist.fmu: the path 'extra/aux.txt'" in done.stdout
    done = dse_in(tmp_path / "work", "check")
    assert done.returncode == 0, done.stderr
    assert "ignored: " in done.stderr
    assert dse_in(tmp_path / "work", "check", "--strict").returncode == 1


@pytest.mark.thorough
def test_variants_become_benches_of_one_design(foreign, dse_in, tmp_path):
    done = dse_in(tmp_path, "import", "ssp", "foreign.ssp", "work")
    assert done.returncode == 0, done.stderr
    assert sorted(p.name for p in (tmp_path / "work" / "testbenches").iterdir()) == ["Fast.yaml", "slow.yaml"]
    assert [p.name for p in (tmp_path / "work" / "designs").iterdir()] == ["slow.yaml"]
    for bench, rate in (("slow", 1.0), ("Fast", 2.0)):
        done = dse_in(tmp_path / "work", "simulate", bench, "--format", "json")
        assert done.returncode == 0, done.stderr
        (value,) = json.loads(done.stdout)["metrics"].values()
        assert value == pytest.approx(np.exp(-rate), abs=(0.1 * rate) ** 5)


def test_benches_of_an_import_simulate_as_long_as_is_asked(tmp_path, dahlquist, dse_in):
    late = decay("1", "late").replace('stopTime="1"', 'startTime="1" stopTime="2"')
    pack(tmp_path / "late.ssp", {"SystemStructure.ssd": late, "resources/Dahlquist.fmu": dahlquist})
    refused = dse_in(tmp_path, "import", "ssp", "late.ssp", "work")
    assert refused.returncode == 1
    assert "starts at 1 s" in refused.stderr
    assert "--stop '10 s'" in refused.stderr
    done = dse_in(tmp_path, "import", "ssp", "late.ssp", "work", "--stop", "3 s", "--step", "0.5 s")
    assert done.returncode == 0, done.stderr
    bench = (tmp_path / "work" / "testbenches" / "late.yaml").read_text(encoding="utf-8")
    assert 'stop: "3.0 s"' in bench
    assert 'step: "0.5 s"' in bench


@pytest.mark.thorough
def test_variants_with_other_fmus_become_alternatives(dse_in, tmp_path, dahlquist, tmp_path_factory):
    other = rezipped(dahlquist, tmp_path_factory.mktemp("other") / "Other.fmu")
    files = {
        "SystemStructure.ssd": decay("1", "slow"),
        "Fast.ssd": decay("2", "fast", "resources/Other.fmu"),
        "resources/Dahlquist.fmu": dahlquist,
        "resources/Other.fmu": other,
    }
    pack(tmp_path / "two.ssp", files)
    done = dse_in(tmp_path, "import", "ssp", "two.ssp", "work")
    assert done.returncode == 0, done.stderr
    (command,) = [line for line in done.stdout.splitlines() if line.startswith("next: ") and "Fast.yaml" in line]
    assert "--configuration" in command
    assert "alternatives:" in (tmp_path / "work" / "designs" / "slow.yaml").read_text(encoding="utf-8")
    done = dse_in(tmp_path, "check", "work")
    assert done.returncode == 0, done.stderr
    done = dse_in(tmp_path, *command.removeprefix("next: dse ").split(), "--format", "json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["metrics"]["d_x_at_the_end"] == pytest.approx(np.exp(-2), abs=0.2**5)


def rezipped(archive: bytes, target: Path, more: str = "documentation/more.txt") -> bytes:
    """The same FMU with other bytes: a file more."""
    target.write_bytes(archive)
    with zipfile.ZipFile(target, "a") as opened:
        opened.writestr(more, "another one")
    return target.read_bytes()


@pytest.mark.thorough
def test_what_a_workspace_has_no_words_for_is_refused_at_its_line(dse_in, tmp_path, dahlquist, tmp_path_factory):
    through = build("Feedthrough", 2, "CoSimulation", tmp_path_factory.mktemp("through")).read_bytes()
    text = elements(
        component("d", "output x", source="resources/Dahlquist.fmu", more=bindings(binding(parameter_set("x Real 3")))),
        component(
            "f",
            "input Float64_continuous_input",
            "output String_output",
            "input String_input",
            source="resources/f.fmu",
        ),
    ) + connections(
        connection("d.x", "f.Float64_continuous_input", '<ssc:LinearTransformation factor="2"/>'),
        "\n",
        connection("f.String_output", "f.String_input"),
    )
    files = {"SystemStructure.ssd": description(text), "resources/Dahlquist.fmu": dahlquist, "resources/f.fmu": through}
    pack(tmp_path / "hard.ssp", files)
    done = dse_in(tmp_path, "import", "ssp", "hard.ssp", "work")
    assert done.returncode == 1
    what = "d.x -> f.Float64_continuous_input: its transformation is nothing a workspace has words for"
    assert what in done.stderr
    assert "hard.ssp/SystemStructure.ssd:4:" in done.stderr
    assert "String_output" not in done.stderr
    assert not (tmp_path / "work").exists()
    # The package itself can be simulated all the same, strings and transformation included.
    done = dse_in(tmp_path, "simulate", "hard.ssp", "--stop", "1", "--step", "0.1", "--format", "json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["signals"]["d.x"]["start"] == 3.0


def test_an_fmu_that_fails_is_named(dse_in, tmp_path, dahlquist):
    broken = pack(tmp_path / "broken.fmu", {"modelDescription.xml": "<fmiModelDescription fmiVersion='2.0'/>"})
    files = {
        "SystemStructure.ssd": description(elements(component("d", "output x", source="resources/d.fmu"))),
        "resources/d.fmu": broken.read_bytes(),
    }
    pack(tmp_path / "bad.ssp", files)
    done = dse_in(tmp_path, "simulate", "bad.ssp")
    assert done.returncode == 1
    assert "bad.ssp/SystemStructure.ssd:4:" in done.stderr
    assert "resources/d.fmu/modelDescription.xml:1:1: there is neither <CoSimulation> nor" in done.stderr


@pytest.mark.thorough
def test_an_fmu_keeps_the_interface_that_a_package_asks_for(dse_in, tmp_path, tmp_path_factory):
    both = build("VanDerPol", 3, None, tmp_path_factory.mktemp("both")).read_bytes()
    part = component("v", "output x0").replace("source=", 'implementation="ModelExchange" source=')
    pack(tmp_path / "me.ssp", {"SystemStructure.ssd": description(elements(part)), "resources/v.fmu": both})
    done = dse_in(tmp_path, "simulate", "me.ssp", "--stop", "1", "--step", "0.01", "--format", "json")
    assert done.returncode == 0, done.stderr
    end = json.loads(done.stdout)["signals"]["v.x0"]["end"]
    done = dse_in(tmp_path, "import", "ssp", "me.ssp", "work", "--stop", "1", "--step", "0.01")
    assert done.returncode == 0, done.stderr
    assert "interface: model_exchange" in (tmp_path / "work/components/v/component.yaml").read_text(encoding="utf-8")
    done = dse_in(tmp_path / "work", "simulate", "example", "--format", "json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["metrics"]["v_x0_at_the_end"] == end


@pytest.mark.thorough
def test_arrays_and_all_kinds_of_fmus_become_a_workspace(dse_in, tmp_path, tmp_path_factory):
    folder = tmp_path_factory.mktemp("kinds")
    wanted = (
        ("BouncingBall", 1, "CoSimulation"),
        ("VanDerPol", 2, "ModelExchange"),
        ("Feedthrough", 3, "CoSimulation"),
    )
    fmus = {f"resources/{name}.fmu": build(name, version, kind, folder).read_bytes() for name, version, kind in wanted}
    array = ("input Float64_array_input", "output Float64_array_output")
    system = elements(
        component("BouncingBall", "output h"),
        component("VanDerPol", "output x0"),
        component("Feedthrough", *array),
        component("other", *array, source="resources/Feedthrough.fmu"),
    ) + connections(connection("Feedthrough.Float64_array_output", "other.Float64_array_input"))
    text = description(system, '<ssd:DefaultExperiment stopTime="1"/>', version="2.0")
    pack(tmp_path / "kinds.ssp", {"SystemStructure.ssd": text, **fmus})
    done = dse_in(tmp_path, "import", "ssp", "kinds.ssp", "work")
    assert done.returncode == 0, done.stderr
    assert "left out" not in done.stdout
    done = dse_in(
        tmp_path / "work", "simulate", "example", "--format", "json", "--set", "Feedthrough.Float64_array_input[2,3]=8"
    )
    assert done.returncode == 0, done.stderr
    metrics = json.loads(done.stdout)["metrics"]
    assert metrics["other_Float64_array_output_2_3_at_the_end"] == 8.0
    for name in ("first", "second"):
        done = dse_in(tmp_path / "work", "export", "ssp", "example", "-o", f"../{name}.ssp")
        assert done.returncode == 0, done.stderr
        if name == "first":
            (tmp_path / "work").rename(tmp_path / "before")
            assert dse_in(tmp_path, "import", "ssp", "first.ssp", "work").returncode == 0
    assert (tmp_path / "first.ssp").read_bytes() == (tmp_path / "second.ssp").read_bytes()


@pytest.mark.thorough
def test_a_run_that_an_fmu_ends_is_shown_until_there(dse_in, tmp_path, tmp_path_factory):
    stair = build("Stair", 2, "CoSimulation", tmp_path_factory.mktemp("stair")).read_bytes()
    text = description(elements(component("s", "output counter")))
    pack(tmp_path / "stair.ssp", {"SystemStructure.ssd": text, "resources/s.fmu": stair})
    done = dse_in(tmp_path, "simulate", "stair.ssp", "--stop", "20", "--set", "s.last=3")
    assert done.returncode == 0, done.stderr
    assert "ended early: s: fmi2DoStep at t = 2 s asked to end the simulation" in done.stderr
    assert re.search(r"counter +1 +3 +1 +3", done.stdout)
