"""Strings and binaries as ports: of components in C, of FMUs of both versions, and where a stranger stands between."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from port_workspaces import bench, c_part, columns, run, write

from dse.domain.component import Kind
from dse.domain.run import Outcome
from dse.errors import DseError
from dse.fmu.component_build import build
from dse.fmu.unpack import open_fmu
from dse.interchange.importing.component import import_component
from dse.loading.workspace import Workspace
from dse.testbench.check import check_workspace

HEAD = """\
#pragma once
#include <stddef.h>
#include <stdint.h>
typedef struct { size_t size; uint8_t data[CAPACITY]; } bytes;
"""
MEDIA = "binary[application/x-open-simulation-interface; type=SensorView]"
INTERFACES = f"""\
interfaces:
  source: {{outputs: {{view: "{MEDIA}", name: string}}}}
  model: {{inputs: {{view: "{MEDIA}"}}, outputs: {{data: binary}}}}
  sink: {{inputs: {{view: binary, name: string}}, outputs: {{size: int, sum: int, letters: int}}}}
"""


def head(capacity: int) -> str:
    return HEAD.replace("CAPACITY", str(capacity))


SOURCE = c_part(
    "source",
    "struct { bytes view; char name[32]; } out;",
    """
    s->out.view.size = (size_t)(s->k * 37 % 300);
    for (size_t i = 0; i < s->out.view.size; i++) { s->out.view.data[i] = (uint8_t)(i * 7 + (size_t)s->k); }
    memset(s->out.name, 0, sizeof s->out.name);
    memset(s->out.name, 'a', (size_t)(s->k % 31));
    """,
    head=head(300),
)
MODEL = c_part(
    "model", "struct { bytes view; } in; struct { bytes data; } out;", "s->out.data = s->in.view;", head=head(512)
)
SINK = c_part(
    "sink",
    "struct { bytes view; char name[40]; } in; struct { int32_t size, sum, letters; } out;",
    """
    s->out.size = (int32_t)s->in.view.size; s->out.sum = 0; s->out.letters = (int32_t)strlen(s->in.name);
    for (size_t i = 0; i < s->in.view.size; i++) { s->out.sum += s->in.view.data[i]; }
    """,
    head=head(300),
)
PARTS = "source: {component: source}, model: {component: model}"
CONNECTIONS = "source.view -> model.view, model.data -> sink.view, source.name -> sink.name"
RECORD = "sink.size, sink.sum, sink.letters"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    files = {"components/interfaces.yaml": INTERFACES, **SOURCE, **MODEL, **SINK}
    return write(tmp_path / "w", {**files, **bench(CONNECTIONS, RECORD, parts=PARTS)})


def expected(delay: int) -> tuple[list[int], list[int]]:
    ks = [max(0, k - delay) for k in range(21)]
    sizes = [k * 37 % 300 for k in ks]
    return sizes, [sum((i * 7 + k) % 256 for i in range(size)) for k, size in zip(ks, sizes, strict=True)]


@pytest.mark.parametrize("version", [2, 3])
def test_every_byte_arrives_through_a_part_between(root: Path, version: int) -> None:
    found = columns(root, version=version)
    sizes, sums = expected(2)
    assert found["sink.size"].tolist() == sizes
    assert found["sink.sum"].tolist() == sums
    assert found["sink.letters"].tolist() == [max(0, k - 1) % 31 for k in range(21)]


@pytest.mark.parametrize(("built", "bench_version"), [(2, 2), (2, 3), (3, 2), (3, 3)])
def test_a_sensor_model_of_others_takes_the_place_of_ours_by_one_line(
    root: Path, built: int, bench_version: int
) -> None:
    before = columns(root)
    archive = build(Workspace(root).component("model"), version=built)
    shutil.rmtree(root / "components/model")
    theirs = root / "components/theirs"
    theirs.mkdir()
    shutil.copy(archive, theirs / "theirs.fmu")
    interface = Workspace(root).interfaces["model"]
    write(
        root,
        {
            "components/theirs/component.yaml": "component: theirs\nimplements: model\n"
            "source: {kind: fmu, file: theirs.fmu}\n",
            **bench(CONNECTIONS, RECORD, parts=PARTS.replace("component: model", "component: theirs")),
        },
    )
    assert [port.type.kind for port in interface.ports] == [Kind.BINARY, Kind.BINARY]
    after = columns(root, version=bench_version)
    assert all(np.array_equal(after[name], values) for name, values in before.items())


def test_a_binary_of_fmi_2_is_described_by_the_annotations_of_osmp(root: Path) -> None:
    model = open_fmu(build(Workspace(root).component("source"), version=2))
    view = model.variables["view"]
    assert (view.fmi_type, view.causality, view.media) == ("Binary", "output", MEDIA[7:-1])
    assert [name for name, _ in view.integers] == ["view.base.lo", "view.base.hi", "view.size"]
    assert model.depends["view"] == ()


@pytest.mark.parametrize("version", [2, 3])
def test_a_binary_that_is_too_large_for_its_part_ends_the_run_by_name(root: Path, version: int) -> None:
    header = root / "components/sink/sink.h"
    header.write_text(header.read_text(encoding="utf-8").replace("data[300]", "data[100]"), encoding="utf-8")
    made = run(root, version=version)
    assert made.outcome is Outcome.FAILED
    assert "sink" in made.problem
    assert "'view' has room for 100 bytes, not for 111" in made.problem


@pytest.mark.parametrize("version", [2, 3])
def test_what_a_part_says_it_has_beyond_its_room_is_not_read(root: Path, version: int) -> None:
    code = root / "components/source/source.c"
    text = code.read_text(encoding="utf-8").replace(
        "s->k * 37 % 300);", "s->k * 37 % 300); if (s->k == 3) s->out.view.size = 301;"
    )
    code.write_text(text.replace("i < s->out.view.size", "i < s->out.view.size && i < 300"), encoding="utf-8")
    made = run(root, version=version)
    assert made.outcome is Outcome.FAILED
    assert "'view'" in made.problem
    assert "301" in made.problem


def test_a_string_that_is_too_long_for_its_part_ends_the_run_by_name(root: Path) -> None:
    header = root / "components/sink/sink.h"
    header.write_text(header.read_text(encoding="utf-8").replace("name[40]", "name[10]"), encoding="utf-8")
    made = run(root)
    assert "'name' has room for 10 bytes, not for 11" in made.problem


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("size_t size; uint8_t data[512]", "int size; uint8_t data[512]", "'out.data' is not a struct of 'size'"),
        ("size_t size; uint8_t data[512]", "size_t size; uint8_t *data", "'out.data' is not a struct of 'size'"),
        ("bytes data;", "double data;", "'out.data' is not a struct of 'size'"),
    ],
)
def test_c_that_holds_no_binary_is_told_so(root: Path, old: str, new: str, what: str) -> None:
    header = root / "components/model/model.h"
    header.write_text(header.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    code = root / "components/model/model.c"
    code.write_text(code.read_text(encoding="utf-8").replace("s->out.data = s->in.view;", "(void)s;"), encoding="utf-8")
    with pytest.raises(DseError) as caught:
        run(root)
    assert any(what in problem.what for problem in caught.value.problems)


def told(root: Path) -> str:
    problems, _ = check_workspace(Workspace(root))
    return "\n".join(f"{problem.where}: {problem.what} ({problem.hint})" for problem in problems)


def test_binaries_that_hold_different_things_are_not_connected(root: Path) -> None:
    text = INTERFACES.replace(
        'inputs: {view: "binary[application/x-open-simulation-interface; type=SensorView]"}',
        'inputs: {view: "binary[application/x-open-simulation-interface; type=GroundTruth]"}',
    )
    assert text != INTERFACES
    write(root, {"components/interfaces.yaml": text})
    assert "source.view -> model.view: the binaries differ in what they hold" in told(root)


def test_a_media_type_without_parameters_fits_one_with_them(root: Path) -> None:
    text = INTERFACES.replace(
        "outputs: {data: binary}", 'outputs: {data: "binary[application/x-open-simulation-interface]"}'
    )
    text = text.replace("sink: {inputs: {view: binary", f'sink: {{inputs: {{view: "{MEDIA}"')
    write(root, {"components/interfaces.yaml": text})
    assert told(root) == ""


@pytest.mark.parametrize(
    ("connections", "record", "what"),
    [
        (CONNECTIONS, "source.view", "cannot record 'source.view': waveforms are numbers, it is a binary"),
        (CONNECTIONS, "source.name", "cannot record 'source.name': waveforms are numbers, it is a string"),
        (CONNECTIONS.replace("source.name -> sink.name", "source.view -> sink.name"), RECORD, "types differ: binary"),
        (CONNECTIONS.replace(", source.name -> sink.name", ""), RECORD, "input sink.name (sink) is neither connected"),
    ],
)
def test_what_texts_cannot_be_used_for_is_refused_by_name(root: Path, connections: str, record: str, what: str) -> None:
    write(root, bench(connections, record, parts=PARTS))
    assert what in told(root)


def test_metrics_know_no_binaries(root: Path) -> None:
    write(root, bench(CONNECTIONS, RECORD, parts=PARTS, more="metrics: {x: final(source.view)}\n"))
    assert "source.view" in told(root)


def test_inputs_may_be_given_texts_and_bytes(root: Path) -> None:
    more = "parameters: {sink.name: hello, sink.view: 0A0b0c}\n"
    write(root, bench("source.view -> model.view", RECORD, parts=PARTS, more=more))
    found = columns(root)
    assert [values[-1] for values in found.values()] == [3, 33, 5]
    write(root, bench("source.view -> model.view", RECORD, parts=PARTS, more=more.replace("0A0b0c", "0A0b0")))
    assert "expected bytes, found '0A0b0'" in told(root)


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_with_binaries_and_strings_is_imported_with_them(root: Path, tmp_path: Path, version: int) -> None:
    archive = build(Workspace(root).component("source"), version=version)
    imported = import_component(archive, tmp_path / "other", "theirs")
    assert imported.left_out == ()
    read = Workspace(tmp_path / "other").component("theirs")
    assert {port.name: str(port.type) for port in read.interface.ports} == {"view": MEDIA, "name": "string"}
    problems, _ = check_workspace(Workspace(tmp_path / "other"))
    assert problems == []


def test_the_integers_behind_a_binary_are_no_ports(root: Path, tmp_path: Path) -> None:
    archive = build(Workspace(root).component("source"), version=2)
    write(
        tmp_path / "other",
        {
            "components/interfaces.yaml": "interfaces: {size: {outputs: {size: int}}}\n",
            "components/theirs/component.yaml": "component: theirs\nimplements: size\n"
            "source: {kind: fmu, file: theirs.fmu}\nmap: {size: view.size}\n",
        },
    )
    shutil.copy(archive, tmp_path / "other/components/theirs/theirs.fmu")
    assert "'view.size' in the FMU of theirs is a part of the binary 'view'" in told(tmp_path / "other")


def test_a_fused_loop_refuses_binaries_by_name(root: Path) -> None:
    from dse.testbench.study import bench_study, prepare_study

    study = bench_study(Workspace(root).bench("see"))
    with pytest.raises(DseError, match=r"source\.view: variables of type Binary cannot be fused"):
        prepare_study(study, fuse=True)
