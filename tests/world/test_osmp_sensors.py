"""A sensor model of others by OSMP in the place of one of our sensors, by its name alone."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from port_workspaces import c_part, write

from dse.domain.run import Outcome, RunRequest
from dse.errors import DseError
from dse.fmu.component_build import build
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.check import check_workspace
from dse.testbench.prepare import prepare_bench
from dse.testbench.runner import Runner

ROOT = Path(__file__).parents[2]
WORLD = """\
interfaces:
  world: {outputs: {motion: motion, actors: "actor[8]"}}
"""
HEAD = """\
#pragma once
#include "../sensors/objects/objects.h"
#include <stddef.h>
typedef struct { size_t size; uint8_t data[9000]; } bytes;
"""
DRIVING = c_part(
    "driving",
    "struct { struct { double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration; } "
    "motion; objects_actor actors[8]; } out;",
    """
    memset(&s->out, 0, sizeof s->out);
    s->out.motion.x = 0.1 * s->k;
    s->out.motion.speed = 10;
    s->out.actors[3] = (objects_actor){.id = 5, .class = 1, .length = 4, .width = 2, .x = 50 + 0.3 * s->k, .speed = 30};
    """,
    head=HEAD,
)
# A supplier's model: it copies the view, and tells where the middle of the second vehicle is from the first's.
THEIRS = c_part(
    "theirs",
    "struct { bytes view; } in; struct { struct { size_t size; uint8_t data[20000]; } data; } out;",
    """
    double places[2][3] = {{0, 0, 0}, {0, 0, 0}};
    int found = 0;
    bool broken = false;
    proto_in view = {s->in.view.data, s->in.view.data + s->in.view.size, &broken};
    proto_field field, object, part, base;
    while (proto_next(&view, &field)) {
        while (proto_is(&field, 7, PROTO_BYTES) && proto_next(&field.bytes, &object)) {
            while (proto_is(&object, 5, PROTO_BYTES) && proto_next(&object.bytes, &part)) {
                while (proto_is(&part, 2, PROTO_BYTES) && proto_next(&part.bytes, &base)) {
                    if (proto_is(&base, 2, PROTO_BYTES) && found < 2) proto_reals(base.bytes, places[found++], 3);
                }
            }
        }
    }
    proto_out out = {s->out.data.data, sizeof s->out.data.data, 0};
    if (found < 2 || broken) { s->out.data.size = 0; return; }
    for (int i = 0; i < 3; ++i) places[1][i] -= places[0][i];
    proto_put_bytes(&out, 8, s->in.view.data, s->in.view.size);
    size_t opened = proto_open(&out, 13), inner = proto_open(&out, 2);
    proto_put_reals(&out, 2, places[1], 3);
    proto_close(&out, inner);
    proto_close(&out, opened);
    s->out.data.size = out.size;
    """,
    head=HEAD + '#include "../osi/protobuf/protobuf.h"\n',
)
FILES = ", ../sensors/objects/objects.h"
DESIGN = """\
design: one
root: {compound: {eye: {alternatives: [object_perfect, theirs]}}}
"""
BENCH = """\
testbench: see
design: one
test_components: {driving: {component: driving}}
connections: [driving.motion -> eye.motion, driving.actors -> eye.actors]
simulation: {stop: 0.3 s, step: 10 ms, algorithm: gauss_seidel, record: [eye.scan]}
"""


@pytest.fixture
def root(tmp_path: Path) -> Path:
    components = tmp_path / "w/components"
    for part in ("osi", "sensors/objects", "sensors/object_perfect", "sensors/sensing", "road_users"):
        shutil.copytree(ROOT / "components" / part, components / part)
    shutil.copy(ROOT / "components/interfaces.yaml", components)
    files = {**DRIVING, **THEIRS, "components/driving/interfaces.yaml": WORLD}
    files |= {"designs/one.yaml": DESIGN, "testbenches/see.yaml": BENCH}
    for name, more in (("driving", ""), ("theirs", ", ../osi/protobuf/protobuf.c, ../osi/protobuf/protobuf.h")):
        key = f"components/{name}/component.yaml"
        files[key] = files[key].replace(f"[{name}.c]", f"[{name}.c{FILES}{more}]")
    files["components/driving/component.yaml"] = files["components/driving/component.yaml"].replace(
        "implements: driving", "implements: world"
    )
    files["components/theirs/component.yaml"] = files["components/theirs/component.yaml"].replace(
        "implements: theirs", "implements: osmp_sensor"
    )
    return write(tmp_path / "w", files)


def as_fmu(root: Path, version: int) -> None:
    """Their model as they hand it out."""
    archive = build(Workspace(root).component("theirs"), version=version)
    shutil.rmtree(root / "components/theirs")
    text = "component: theirs\nimplements: osmp_sensor\nsource: {kind: fmu, file: theirs.fmu}\n"
    write(root, {"components/theirs/component.yaml": f"{text}properties: {{cost: 90 EUR}}\n"})
    shutil.copy(archive, root / "components/theirs/theirs.fmu")


def waveforms(root: Path, version: int) -> dict[str, dict[str, NDArray[np.float64]]]:
    """The first return and how many scans there were, with each sensor."""
    bench = Workspace(root).bench("see")
    found = {}
    for prepared in prepare_bench(bench, open_space(bench.design).configurations(), version=version).values():
        with Runner(prepared) as runner:
            run = runner.run(RunRequest(0, prepared.configuration.id, {}), keep=True)
        assert run.outcome is Outcome.DONE, run.problem
        assert run.waveforms is not None
        found[prepared.configuration.choices["eye"]] = dict(run.waveforms.values)
    return found


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(("theirs", "version"), [(2, 2), (2, 3), (3, 3), (3, 2)])
def test_an_fmu_by_osmp_is_a_sensor_of_ours_by_its_name(
    root: Path, monkeypatch: pytest.MonkeyPatch, built_before: Callable[[Path], Path], theirs: int, version: int
) -> None:
    monkeypatch.setenv("DSE_CACHE", str(built_before(root.parent / "cache")))
    as_fmu(root, theirs)
    problems, _ = check_workspace(Workspace(root))
    assert problems == []
    found = waveforms(root, version)
    assert found.keys() == {"object_perfect", "theirs"}
    perfect, told = found["object_perfect"], found["theirs"]
    ours, seen = (each["eye.scan.returns[1].range"] for each in (perfect, told))
    # From box to box, not from the sensor, 2.3 m ahead, to the rear; in the same step.
    assert seen == pytest.approx(ours + 2.3 + 2 - 0.05, abs=1e-9)
    assert seen[-1] - seen[0] == pytest.approx(6)
    assert told["eye.scan.number"].tolist() == [1, *range(1, 31)]
    assert told["eye.scan.mount"][-1] == 2.3


@pytest.mark.thorough
def test_what_stands_in_for_a_sensor_has_parameters_and_outputs_of_its_own(root: Path) -> None:
    more = "parameters: {eye.writer.mount: 1.5 m, eye.reader.least_existence: 0.2}\n"
    record = "record: [eye.scan, eye.reader.malformed, eye.reader.messages]"
    write(root, {"testbenches/see.yaml": BENCH.replace("record: [eye.scan]", record) + more})
    found = waveforms(root, 2)["theirs"]
    assert found["eye.scan.mount"][-1] == 1.5
    assert found["eye.reader.malformed"].max() == 0
    assert found["eye.reader.messages"][-1] > 25


@pytest.mark.thorough
def test_the_cost_of_such_a_sensor_counts_and_rules_know_its_name(root: Path) -> None:
    as_fmu(root, 2)
    rules = "constraints:\n  dear: {require: sum(cost) <= 80 EUR, because: it is}\n"
    write(root, {"designs/one.yaml": DESIGN + rules})
    design = Workspace(root).design("one")
    assert [c.choices["eye"] for c in open_space(design).configurations()] == ["object_perfect"]
    write(root, {"designs/one.yaml": DESIGN + "constraints:\n  it: {require: eye is theirs, because: it is}\n"})
    (only,) = open_space(Workspace(root).design("one")).configurations()
    assert set(only.parts) == {"eye.writer", "eye.model", "eye.reader"}


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("implements: object_sensor\n      compound", "implements: object_censor\n      compound", "unknown interface"),
        ("reader: osi_detections", "reader: osi_detection", "unknown component 'osi_detection'"),
        ("- writer.view -> model.view", "- writer.view - model.view", "is not a connection"),
        ("      connections:\n        - motion", "      wires:\n        - motion", "unknown key 'wires'"),
    ],
)
def test_what_is_wrong_with_what_stands_in_is_told_where_it_stands(root: Path, old: str, new: str, what: str) -> None:
    path = root / "components/interfaces.yaml"
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")
    with pytest.raises(DseError) as caught:
        Workspace(root).design("one")
    assert any(what in found.what and "interfaces.yaml" in str(found.where) for found in caught.value.problems)
