"""Arrays, structures and arrays of structures as ports: what travels over a whole connection is every value of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from port_workspaces import TYPES, bench, c_part, columns, run, write

from dse.api.studies.single_run import write_package
from dse.domain.run import RunRequest
from dse.errors import DseError
from dse.fmu.component_build import build
from dse.interchange.importing.component import import_component
from dse.interchange.importing.ssp import import_ssp
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.check import check_workspace
from dse.testbench.runner import Runner
from dse.testbench.study import bench_study, prepare_study
from dse.testing.kinds import lay_out, the_component

INTERFACES = (
    TYPES
    + """\
interfaces:
  world:
    outputs: {objects: "object[4]", ranges: "m[3]", lead: object}
  sink:
    inputs: {objects: "object[4]", ranges: "m[3]", gap: m, lead: object}
    outputs: {echo: "object[4]", sums: "m[3]", first: vector, cars: int}
"""
)
WORLD = c_part(
    "world",
    "struct { object objects[4]; double ranges[3]; object lead; } out;"
    "struct { double gains[3]; double grid[2][2]; int32_t ids[4]; } par;",
    """
    for (int i = 0; i < 4; i++) {
        object *o = &s->out.objects[i];
        o->id = s->par.ids[i]; o->kind = (uint8_t)((i + s->k) % 3); o->seen = (i + s->k) & 1;
        o->at.x = i + 0.1 * s->k; o->at.y = 1.0 / (i + 1 + s->k); o->v = 0.1f * (float)i * (float)s->k;
        for (int j = 0; j < 4; j++) { o->corners[j / 2][j % 2] = 10.0 * i + j + 0.01 * s->k; }
    }
    for (int i = 0; i < 3; i++) { s->out.ranges[i] = s->par.gains[i] * s->k + s->par.grid[1][0]; }
    s->out.lead = s->out.objects[2];
    """,
    parameters="""\
parameters:
  gains: {start: [1, 2, 3], min: 0, max: 9, unit: m/s}
  grid: {start: [[1, 2], [3, 4]]}
  ids: {start: [7, 5, 3, 1], type: int}
""",
)
SINK = c_part(
    "sink",
    "struct { object objects[4]; double ranges[3], gap; object lead; } in;"
    "struct { object echo[4]; double sums[3]; struct { double x, y; } first; int32_t cars; } out;",
    """
    memcpy(s->out.echo, s->in.objects, sizeof s->out.echo);
    for (int i = 0; i < 3; i++) { s->out.sums[i] = s->in.ranges[i] + s->in.gap; }
    s->out.first.x = s->in.objects[0].at.x; s->out.first.y = s->in.lead.at.y;
    s->out.cars = 0;
    for (int i = 0; i < 4; i++) { s->out.cars += s->in.objects[i].kind == 0; }
    """,
)
PARTS = "world: {component: world}"
ALL = "world.objects -> sink.objects, world.ranges -> sink.ranges, world.lead -> sink.lead, '%s -> sink.gap'"
MEMBERS = ("id", "kind", "seen", "at.x", "at.y", "v", "corners[1,1]", "corners[1,2]", "corners[2,1]", "corners[2,2]")
VALUES = {
    "objects": [f"[{i}].{member}" for i in range(1, 5) for member in MEMBERS],
    "ranges": [f"[{i}]" for i in range(1, 4)],
    "lead": [f".{member}" for member in MEMBERS],
}
RECORD = "sink.echo, sink.sums, sink.first, sink.cars"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return write(
        tmp_path,
        {
            "components/interfaces.yaml": INTERFACES,
            **WORLD,
            **SINK,
            **bench(ALL % "world.ranges[2]", RECORD, parts=PARTS),
        },
    )


def again(root: Path, connections: str, record: str = RECORD, parts: str = PARTS, more: str = "") -> Path:
    return write(root, bench(connections, record, parts=parts, more=more))


@pytest.mark.parametrize("version", [2, 3])
def test_every_value_of_an_array_of_structures_arrives_a_step_later(root: Path, version: int) -> None:
    found = columns(root, version=version)
    k = np.maximum(np.arange(21) - 1, 0)
    for i in range(4):
        assert np.array_equal(found[f"sink.echo[{i + 1}].at.x"], i + 0.1 * k)
        assert np.array_equal(found[f"sink.echo[{i + 1}].corners[2,1]"], 10.0 * i + 2 + 0.01 * k)
        assert np.array_equal(found[f"sink.echo[{i + 1}].v"], np.float32(0.1) * np.float32(i) * k.astype(np.float32))
        assert np.array_equal(found[f"sink.echo[{i + 1}].kind"], (i + k) % 3)
        assert np.array_equal(found[f"sink.echo[{i + 1}].seen"], (i + k) % 2)
        assert (found[f"sink.echo[{i + 1}].id"] == [7, 5, 3, 1][i]).all()
    for i in range(3):
        assert np.array_equal(found[f"sink.sums[{i + 1}]"], ((i + 1) * k + 3.0) + (2.0 * k + 3.0))
    assert np.array_equal(found["sink.first.y"], 1.0 / (3 + k))


@pytest.mark.thorough
@given(
    whole=st.fixed_dictionaries(dict.fromkeys(VALUES, st.booleans())),
    order=st.randoms(use_true_random=False),
    version=st.sampled_from([2, 3]),
)
@settings(max_examples=12, deadline=None)
def test_a_connection_of_arrays_is_bit_for_bit_those_of_their_values(
    tmp_path_factory: pytest.TempPathFactory, whole: dict[str, bool], order, version: int
) -> None:
    root = tmp_path_factory.mktemp("values")
    files = {"components/interfaces.yaml": INTERFACES, **WORLD, **SINK}
    write(root, {**files, **bench(ALL % "world.ranges[2]", RECORD, parts=PARTS)})
    expected = columns(root, version=version)
    single = [
        f"'world.{name}{value} -> sink.{name}{value}'"
        for name, values in VALUES.items()
        for value in ([""] if whole[name] else values)
    ]
    order.shuffle(single)
    again(root, ", ".join(["'world.ranges[ 2 ] -> sink.gap'", *single]))
    found = columns(root, version=version)
    assert {name: values.tobytes() for name, values in found.items()} == {
        name: values.tobytes() for name, values in expected.items()
    }


def test_a_fused_loop_takes_arrays_and_gives_the_same_bits(root: Path) -> None:
    study = prepare_study(bench_study(Workspace(root).bench("see")), fuse=True)
    ((identity, prepared),) = study.benches.items()
    assert prepared.fused is not None
    with Runner(prepared) as runner:
        fused = runner.run(RunRequest(0, identity, {}), keep=True)
    assert fused.waveforms is not None
    plain = columns(root)
    assert all(np.array_equal(fused.waveforms.values[name], values) for name, values in plain.items())


def test_values_of_arrays_are_measured_given_and_recorded_by_their_names(root: Path) -> None:
    parts = "world: {component: world, parameters: {gains: [4, 5, 6], 'ids[2]': 9}}"
    more = (
        "parameters: {'world.grid[2, 1]': 8}\nmetrics:\n  far: final(sink.sums[ 3 ])\n"
        "  cars: duration(sink.echo[2].kind == car)\n  id: maximum(sink.echo[2].id)\n  gain: world.gains[2]\n"
        "figures: {x: {current: 'sink.echo[1].at.x'}}\n"
    )
    again(root, ALL % "world.ranges[1]", "'sink.echo[2].kind'", parts, more)
    found = run(root)
    assert found.metrics == {"far": 6 * 19 + 8 + 4 * 19 + 8, "cars": pytest.approx(0.06), "id": 9.0, "gain": 5.0}
    assert found.waveforms is not None
    assert list(found.waveforms.values) == ["sink.echo[2].kind", "sink.echo[1].at.x"]


def test_inputs_that_are_arrays_are_given_values_in_one_line_or_one_for_all(root: Path) -> None:
    more = "parameters: {'sink.ranges': [1, 2 m, 3], sink.gap: 0.5}\n"
    connections = "world.objects -> sink.objects, world.lead -> sink.lead"
    again(root, connections, "sink.sums", PARTS, more)
    assert [values[5] for values in columns(root).values()] == [1.5, 2.5, 3.5]
    again(root, connections, "sink.sums", PARTS, more.replace("[1, 2 m, 3]", "4 m"))
    assert [values[5] for values in columns(root).values()] == [4.5, 4.5, 4.5]


def told(root: Path) -> str:
    problems, _ = check_workspace(Workspace(root))
    return "\n".join(f"{problem.where}: {problem.what}" for problem in problems)


@pytest.mark.parametrize(
    ("connections", "what"),
    [
        ("world.ranges -> sink.objects", "shapes differ: world.ranges is an array of 3, sink.objects is an array of 4"),
        ("world.ranges -> sink.gap", "shapes differ: world.ranges is an array of 3, sink.gap is a single value"),
        ("world.lead -> sink.objects", "shapes differ: world.lead is a single value, sink.objects is an array of 4"),
        ("'world.ranges[4] -> sink.gap'", "no port 'ranges[4]'"),
        ("'world.ranges[1,2] -> sink.gap'", "no port 'ranges[1,2]'"),
        ("'world.ranges[0] -> sink.gap'", "no port 'ranges[0]'"),
        ("'world.ranges[x] -> sink.gap'", "is not a connection"),
        ("world.ranges -> sink.ranges, 'world.ranges[1] -> sink.ranges[2]'", "sink.ranges[2] has a source already"),
    ],
)
def test_connections_of_other_shapes_are_refused_with_both_ends(root: Path, connections: str, what: str) -> None:
    again(root, connections)
    assert what in told(root)


@pytest.mark.parametrize(
    ("parameter", "what"),
    [
        ("world.gains: [1, 2]", "'world.gains' is given an array of 2, but is an array of 3"),
        ("world.gains: [1, 2, [3]]", "rows of the list differ"),
        ("world.gains: [1, 2, 10]", "gains[3] = 10 is outside its range"),
        ("world.gains: []", "the list is empty"),
        ("'world.gains[4]': 1", "has no port or parameter 'gains[4]'"),
        ("sink.gap: [1]", "is not an array"),
        ("world.gains: [1, 2, 3], 'world.gains[2]': 1", "is given a value twice"),
        ("world.gains: [1, {a: 1}, 3]", "expected a value"),
    ],
)
def test_values_that_do_not_fit_an_array_are_refused(root: Path, parameter: str, what: str) -> None:
    again(root, ALL % "world.ranges[2]", more=f"parameters: {{{parameter}}}\n")
    assert what in told(root)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("at: vector", "at: vektor", "'vektor' is neither a unit nor a type"),
        ("at: vector", "at: object", "the type 'object' contains itself"),
        ("vector: {", "m: {", "'m' is a unit or a type already"),
        ("x: m, y: m", "x: km, y: m", "port 'x' must be in a coherent SI unit"),
        ('"m[3]", lead', '"m[0]", lead', "'m[0]' has no values"),
        ('"m[3]", lead', '"m[200, 200]", lead', "has 40,000 values"),
        ('"m[2, 2]"', '"m[2, 2][3]"', "m[2, 2]"),
        ("vector: {x: m, y: m}", 'vector: "m[2]"\n  vectors: "vector[3]"', "is an array of arrays"),
    ],
)
def test_types_that_cannot_be_are_refused_where_they_stand(root: Path, old: str, new: str, what: str) -> None:
    assert old in INTERFACES
    write(root, {"components/interfaces.yaml": INTERFACES.replace(old, new, 1)})
    found = told(root)
    assert what in found
    assert found.startswith("components/interfaces.yaml:") or "/components/interfaces.yaml:" in found.splitlines()[0]


def test_a_type_of_another_file_is_known_and_cannot_be_defined_twice(root: Path) -> None:
    types, interfaces = INTERFACES.split("interfaces:")
    write(root, {"components/interfaces.yaml": f"interfaces:{interfaces}", "components/more/interfaces.yaml": types})
    assert told(root) == ""
    write(root, {"components/other/interfaces.yaml": types})
    assert "type 'object' is defined twice" in told(root)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("double ranges[3]; object lead", "double ranges[2]; object lead", "has no array 'out.ranges' of 3"),
        ("double ranges[3]; object lead", "double *ranges; object lead", "has no array 'out.ranges' of 3"),
        ("object objects[4]", "object objects[5]", "has no array 'out.objects' of 4"),
        ("double ranges[3]; object lead", "int ranges[3]; object lead", "'out.ranges[0]' is not double or float"),
        ("int32_t ids[4]", "int8_t ids[4]", "too narrow for 300"),
    ],
)
def test_c_without_the_array_is_told_in_the_words_of_the_user(root: Path, old: str, new: str, what: str) -> None:
    header = root / "components/world/world.h"
    header.write_text(header.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    yaml = root / "components/world/component.yaml"
    yaml.write_text(yaml.read_text(encoding="utf-8").replace("[7, 5, 3, 1]", "[7, 5, 3, 300]"), encoding="utf-8")
    with pytest.raises(DseError) as caught:
        run(root)
    assert [problem.what for problem in caught.value.problems if what in problem.what]
    assert len(caught.value.problems) == 1


MODEL = """\
model Mixer
  parameter Real gains[3] = {1, 2, 3};
  input Real ranges[3](each unit = "m");
  output Real sums[3](each unit = "m");
  output Real total(unit = "m", start = 0, fixed = true);
equation
  for i in 1:3 loop
    sums[i] = gains[i] * ranges[i];
  end for;
  der(total) = sum(sums);
end Mixer;
"""
MIXER = """\
component: mixer
implements: mixer
source: {kind: modelica, model: Mixer, files: [Mixer.mo]}
parameters: {gains: {start: [2, 4, 8], max: 9}}
"""


@pytest.mark.parametrize("version", [2, 3])
def test_arrays_of_a_modelica_model_are_connected_to_those_of_c(root: Path, version: int) -> None:
    files = {
        "components/mixer/interfaces.yaml": "interfaces:\n  mixer:\n    inputs: {ranges: 'm[3]'}\n"
        "    outputs: {sums: 'm[3]', total: m}\n",
        "components/mixer/component.yaml": MIXER,
        "components/mixer/Mixer.mo": MODEL,
    }
    write(root, files)
    connections = ALL.replace("world.ranges -> sink.ranges", "world.ranges -> mixer.ranges, mixer.sums -> sink.ranges")
    again(root, connections % "world.ranges[2]", "mixer.sums", f"{PARTS}, mixer: {{component: mixer}}")
    found = columns(root, version=version)
    # the initialization knows what the world shows at 0 s; then a step behind
    ranges = [np.array([(i + 1) * max(k - 1, 0) + 3.0 for k in range(21)]) for i in range(3)]
    for i, gain in enumerate((2, 4, 8)):
        assert np.array_equal(found[f"mixer.sums[{i + 1}]"], gain * ranges[i])


@pytest.mark.parametrize("version", [2, 3])
def test_a_package_of_arrays_becomes_a_workspace_with_arrays_that_writes_it_again(
    root: Path, tmp_path: Path, version: int
) -> None:
    again(root, ALL % "world.ranges[2]", "sink.sums")
    tested = Workspace(root).bench("see")
    (configuration,) = open_space(tested.design).configurations()
    write_package(tested, configuration.id, {}, tmp_path / "x.ssp", fmi=version)
    other = tmp_path / "other"
    import_ssp(tmp_path / "x.ssp", other)
    interfaces = (other / "components/interfaces.yaml").read_text(encoding="utf-8")
    assert 'ranges: "m[3]"' in interfaces
    assert 'objects: "world_objects[4]"' in interfaces
    design = (other / "designs/see.yaml").read_text(encoding="utf-8")
    assert "- world.objects -> sink.objects" in design
    assert "- world.ranges -> sink.ranges" in design
    read = Workspace(other).bench("see")
    (configuration,) = open_space(read.design).configurations()
    write_package(read, configuration.id, {}, tmp_path / "y.ssp", fmi=version)
    assert (tmp_path / "x.ssp").read_bytes() == (tmp_path / "y.ssp").read_bytes()


@pytest.mark.parametrize("version", [2, 3])
def test_an_imported_fmu_keeps_arrays_and_arrays_of_structures(root: Path, tmp_path: Path, version: int) -> None:
    own = Workspace(root).component("world")
    imported = import_component(build(own, version=version), tmp_path / "other", "theirs")
    read = Workspace(tmp_path / "other").component("theirs")
    assert {(p.name, str(p.type)) for p in read.interface.ports} == {(p.name, str(p.type)) for p in own.interface.ports}
    assert {p.name: p.start for p in read.parameters} == {p.name: p.start for p in own.parameters}
    assert read.names == {}
    assert "gains: {start: [1.0, 2.0, 3.0]" in imported.path.read_text(encoding="utf-8")


def test_an_array_of_an_fmu_is_mapped_by_its_name(root: Path, tmp_path: Path) -> None:
    archive = build(Workspace(root).component("world"), version=3)
    files = {
        "components/interfaces.yaml": TYPES + "interfaces: {lidar: {outputs: {distances: 'm[3]', first: object}}}\n",
        "components/lidar/component.yaml": "component: lidar\nimplements: lidar\nsource: {kind: fmu, file: world.fmu}\n"
        "map: {distances: ranges, first: 'objects[1]'}\n",
    }
    other = write(tmp_path / "other", files)
    (other / "components/lidar/world.fmu").write_bytes(archive.read_bytes())
    assert told(other) == ""
    text = files["components/interfaces.yaml"].replace("'m[3]'", "'m[4]'")
    write(other, {"components/interfaces.yaml": text})
    assert "the FMU of lidar has no 'ranges[4]': 'ranges' has 3 values" in told(other)


def test_arrays_whose_names_differ_in_a_digit_have_sizes_of_their_own(tmp_path: Path) -> None:
    header = "typedef struct { struct { double a1[2], a2[3]; } in; struct { double y; } out; } two; "
    files = {
        "interfaces.yaml": 'interfaces:\n  two: {inputs: {a1: "1[2]", a2: "1[3]"}, outputs: {y: "1"}}\n',
        "two/component.yaml": "component: two\nimplements: two\nsource: {kind: c, files: [two.c], header: two.h}\n",
        "two/two.h": f"{header}void two_init(two *s); void two_step(two *s, double h);\n",
        "two/two.c": '#include "two.h"\nvoid two_init(two *s) { s->out.y = 0; }\n'
        "void two_step(two *s, double h) { s->out.y = s->in.a1[1] + s->in.a2[2] + h; }\n",
    }
    assert build(the_component(lay_out(files, tmp_path)), cache=tmp_path / "cache").exists()
