"""What a component's C has to offer, and how it is told when it does not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dse.domain.component import Causality, Interface, Kind, Parameter, Port, Type
from dse.errors import DseError, Location
from dse.fmu.component_build import build
from dse.fmu.unpack import open_fmu

REAL = Type(Kind.REAL)
WHERE = Location("component.yaml", 1, 1)


@pytest.fixture
def refused(cache):
    """The problems of a component that cannot be built, as (location, what, hint)."""

    def problems(component):
        with pytest.raises(DseError) as caught:
            build(component, cache=cache)
        return [(str(problem.where), problem.what, problem.hint) for problem in caught.value.problems]

    return problems


def edit(component, old, new, suffix=".h"):
    path = component.source.header.with_suffix(suffix)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    return component


def test_a_syntax_error_is_shown_where_the_user_wrote_it(workshop, refused):
    component = edit(workshop.counter(), "c->out.hits++;", "c->out.hits++", suffix=".c")
    ((where, what, _),) = refused(component)
    code = (workshop.folder / "counter.c").read_text(encoding="utf-8")
    line = code[: code.index("hits++")].count("\n")
    assert where.startswith(f"{workshop.folder / 'counter.c'}:{line + 1}:")
    assert "expected" in what


def test_every_error_in_the_users_files_is_told(workshop, refused):
    component = edit(workshop.counter(), "c->out.hits++;", "c->out.hitz++; c->sun = 1;", suffix=".c")
    found = refused(component)
    assert len(found) == 2
    assert "hitz" in found[0][1]
    assert "sun" in found[1][1]


def test_an_error_in_the_header_is_shown_in_the_header(workshop, refused):
    component = edit(workshop.counter(), "double sum;", "dubble sum;")
    assert {where.split(":")[0] for where, _, _ in refused(component)} >= {str(workshop.folder / "counter.h")}


def test_missing_members_are_told_all_at_once_in_the_users_words(workshop, refused):
    component = workshop.counter()
    ports = (
        *component.interface.ports,
        Port("gap", Causality.INPUT, REAL),
        Port("target.far.gap", Causality.INPUT, REAL),
        Port("mode", Causality.OUTPUT, Type(Kind.ENUMERATION, items=("a", "b"))),
    )
    found = refused(
        replace(
            component,
            interface=Interface("more", ports),
            parameters=(*component.parameters, Parameter("lag", Type(Kind.INTEGER), 1)),
        )
    )
    header = str(workshop.folder / "counter.h")
    assert found == [
        (header, "struct counter has no member 'in.gap' for input 'gap'", "declare it in counter.h, as double"),
        (
            header,
            "struct counter has no member 'in.target.far.gap' for input 'target.far.gap'",
            "declare it in counter.h, as double",
        ),
        (header, "struct counter has no member 'out.mode' for output 'mode'", "declare it in counter.h, as int"),
        (header, "struct counter has no member 'par.lag' for parameter 'lag'", "declare it in counter.h, as int32_t"),
    ]


def test_a_member_that_the_struct_lacks_is_told_once_also_where_the_code_uses_it(workshop, refused):
    component = edit(workshop.counter(), "double u;", "double speed;")
    edit(component, "c->out.hits++;", "c->out.hitz++;", suffix=".c")
    (_, other, _), lacking = refused(component)
    what = "struct counter has no member 'in.u' for input 'u'"
    assert lacking == (str(workshop.folder / "counter.h"), what, "declare it in counter.h, as double")
    assert "hitz" in other


@pytest.mark.parametrize("declaration", ["int u;", "double u[3];", "struct { double v; } u;", "double *u;"])
def test_a_member_of_the_wrong_type_is_told(workshop, refused, declaration):
    component = edit(workshop.counter(), "double u;", declaration)
    edit(component, "c->in.u", "0", suffix=".c")
    assert refused(component) == [
        (
            str(workshop.folder / "counter.h"),
            "struct counter: 'in.u' is not double or float, as input 'u' (real) needs",
            "declare it as double",
        )
    ]


def test_a_member_too_narrow_for_its_values_is_told(workshop, refused):
    component = edit(workshop.counter(), "int bias;", "int8_t bias;")
    bias = Parameter("bias", Type(Kind.INTEGER), 0, -200, 100)
    ((_, what, hint),) = refused(replace(component, parameters=(component.parameters[0], bias)))
    assert what == "struct counter: 'par.bias' is too narrow for -200, a value of parameter 'bias'"
    assert hint == "declare it as a wider integer type"


def test_a_struct_of_another_name_is_told_once(workshop, refused):
    component = workshop.counter()
    ((_, what, hint),) = refused(replace(component, source=replace(component.source, struct="clock")))
    assert what == "there is no type 'clock'"
    assert "} clock;" in hint


def test_functions_that_are_missing_or_of_another_shape_are_told(workshop, refused):
    component = workshop.counter()
    source = replace(component.source, init="counter_start", step=None)
    init, step = refused(replace(component, source=source))
    assert init[1] == "'counter_start' is not declared as `void counter_start(counter *);`"
    assert step[1].startswith("'counter_step' is not declared as `void counter_step(counter *, double);`, because ")
    plant = workshop.integrator()
    ((_, what, _),) = refused(replace(plant, source=replace(plant.source, step=0.1)))
    assert what.endswith("because it runs every 0.1 s")


def test_a_function_that_is_declared_but_nowhere_defined_is_told(workshop, refused):
    component = replace(workshop.counter(), where=WHERE)
    edit(component, "void counter_init(counter *c) {", "static void other(counter *c) {", suffix=".c")
    ((where, what, _),) = refused(component)
    assert (where, what) == (str(WHERE), "component 'counter': 'counter_init' is called but not defined")


def test_the_clock_may_not_enter_a_library(workshop, refused):
    component = edit(workshop.counter(), "c->out.hits++;", "c->out.hits = __TIME__[0];", suffix=".c")
    ((where, what, _),) = refused(component)
    assert where.startswith(str(workshop.folder / "counter.c"))
    assert "reproducible" in what


def test_a_header_from_elsewhere_has_to_be_listed(workshop, refused, cache):
    component = edit(workshop.counter(), '#include "counter.h"', '#include "counter.h"\n#include "../far/gain.h"', ".c")
    far = workshop.folder.parent / "far"
    far.mkdir()
    (far / "gain.h").write_text("#define GAIN 2\n", encoding="utf-8")
    ((where, _, hint),) = refused(component)
    assert where.startswith(f"{workshop.folder / 'counter.c'}:2:")
    assert hint == "list the header under the component's 'files'"
    source = replace(component.source, files=(*component.source.files, far / "gain.h"))
    assert build(replace(component, source=source), cache=cache).is_file()


@pytest.mark.parametrize(
    ("include", "what"),
    [
        ('"/etc/passwd"', "the include of '/etc/passwd' is an absolute path"),
        ("</etc/passwd>", "the include of '/etc/passwd' is an absolute path"),
        ('"C:\\\\secret.h"', "the include of 'C://secret.h' is an absolute path"),
        ('"../../secret.h"', "the include of '../../secret.h' leads out of the component's files"),
        ('"sub/../../secret.h"', "the include of 'sub/../../secret.h' leads out of the component's files"),
    ],
)
def test_an_include_cannot_reach_what_is_not_in_the_build(workshop, refused, include, what):
    component = edit(workshop.counter(), '#include "counter.h"', f'#include "counter.h"\n #  include {include}', ".c")
    ((where, said, hint),) = refused(component)
    assert (where, said) == (f"{workshop.folder / 'counter.c'}:2:13", what)
    assert hint == "list the header under the component's 'files'"


def test_an_include_upwards_within_the_components_files_works(workshop, cache):
    component = edit(workshop.counter(), '#include "counter.h"', '#include "sub/deep.h"', ".c")
    sub = workshop.folder / "sub"
    sub.mkdir()
    (sub / "deep.h").write_text('#include "../counter.h"\n', encoding="utf-8")
    source = replace(component.source, files=(*component.source.files, sub / "deep.h"))
    assert build(replace(component, source=source), cache=cache).is_file()


def test_a_link_beside_the_header_brings_nothing_in(workshop, cache, tmp_path):
    outside = tmp_path.parent / "secret.txt"
    outside.write_text("/* secret words */", encoding="utf-8")
    component = workshop.counter()
    (workshop.folder / "words.h").symlink_to(outside)
    assert b"secret words" not in build(component, cache=cache).read_bytes()


def test_a_source_is_shown_as_a_person_here_would_type_it(workshop, refused, monkeypatch):
    component = edit(workshop.counter(), "c->out.hits++;", "c->out.hits++", suffix=".c")
    monkeypatch.chdir(workshop.folder)
    ((where, _, _),) = refused(component)
    assert where.startswith("counter.c:")


def test_only_regular_files_of_c_of_bounded_size_are_taken(workshop, refused):
    component = workshop.counter()
    folder = workshop.folder / "folder.c"
    folder.mkdir()
    large = workshop.folder / "large.c"
    large.write_bytes(b" " * 10_000_001)
    source = replace(component.source, files=(*component.source.files, folder, large))
    assert sorted(what for _, what, _ in refused(replace(component, source=source))) == [
        f"component 'counter': {folder} cannot be read: it is not a regular file",
        f"component 'counter': {large} cannot be read: it is larger than 10 million bytes",
    ]
    source = replace(component.source, files=(*component.source.files, workshop.folder / "notes.txt"))
    ((_, what, _),) = refused(replace(component, source=source))
    assert what.endswith("notes.txt is no .c or .h file")


def test_files_that_are_not_there_are_all_told_where_the_component_is(workshop, refused):
    component = replace(workshop.counter(), where=WHERE)
    gone = [workshop.folder / "gone.c", workshop.folder / "gone.h"]
    source = replace(component.source, files=(*component.source.files, gone[0]), header=gone[1])
    found = refused(replace(component, source=source))
    assert [(where, what) for where, what, _ in found] == [
        (str(WHERE), f"component 'counter': {path} cannot be read: there is no such file") for path in gone
    ]


def test_a_component_needs_a_c_file_and_names_that_c_knows(workshop, refused):
    component = workshop.counter()
    source = replace(component.source, files=(), struct="a b", init="1st", step=0.0)
    assert [what for _, what, _ in refused(replace(component, source=source))] == [
        "component 'counter' lists no C file",
        "component 'counter': the struct 'a b' is not a name in C",
        "component 'counter': the init '1st' is not a name in C",
        "component 'counter': the step of 0.0 s is not positive",
    ]


def test_port_names_that_c_cannot_say_or_that_clash_are_told(workshop, refused):
    component = workshop.counter()
    ports = (*component.interface.ports, Port("a-b", Causality.INPUT, REAL), Port("bias", Causality.INPUT, REAL))
    assert [what for _, what, _ in refused(replace(component, interface=Interface("more", ports)))] == [
        "component 'counter': input 'a-b' has no name in C",
        "component 'counter': input 'bias' and parameter 'bias' are both variable 'bias'",
    ]


@pytest.mark.parametrize(
    ("kind", "start"),
    [
        (Type(Kind.ENUMERATION, items=("a", "b")), "c"),
        (Type(Kind.INTEGER), 1.5),
        (Type(Kind.INTEGER), 2**31),
        (REAL, float("nan")),
        (Type(Kind.BOOLEAN), 2),
    ],
)
def test_a_start_that_is_no_value_of_the_type_is_told(workshop, refused, kind, start):
    component = workshop.counter()
    wrong = (component.parameters[0], Parameter("bias", kind, start))
    ((_, what, _),) = refused(replace(component, parameters=wrong))
    assert what.startswith("component 'counter': parameter 'bias' cannot start at a value that is not ")


def test_a_mapped_name_is_the_member_and_the_variable(workshop, cache):
    component = workshop.counter()
    edit(component, "double u;", "double RawInput;")
    edit(component, "c->in.u", "c->in.RawInput", suffix=".c")
    model = open_fmu(build(replace(component, names={"u": "RawInput"}), cache=cache), cache=cache)
    assert "RawInput" in model.variables
    assert "u" not in model.variables
