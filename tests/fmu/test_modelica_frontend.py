"""The Modelica front-end: what is read, what is told when it fails, and which parameters it uses itself."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from workspaces import written

from dse.errors import DseError, Location
from dse.modelica.frontend import process
from dse.modelica.frontend.compile import compile_model
from dse.modelica.frontend.literal import literal, wrapper
from dse.modelica.frontend.misreadings import misread_modifications, mixed_up_constants
from dse.modelica.frontend.process import FrontEnd, FrontEndDied
from dse.modelica.frontend.source_text import SourceText, place
from dse.modelica.frontend.sources import read_sources
from dse.modelica.frontend.structural.probe import compile_probed
from dse.modelica.frontend.structural.shape import made_of, places
from dse.modelica.frontend.syntax import Forest
from dse.modelica.frontend.used_classes import reached, used

LIBRARY = {
    "Lib/package.mo": 'package Lib "Größe"\nend Lib;\n',
    "Lib/package.order": "A\n",
    "Lib/A.mo": 'within Lib;\nmodel A "ä – test"\n  parameter Real a = 2 "ö"; parameter Integer n = 3;\n'
    "  input Real u;\n  output Real y;\n  Real z[n];\nequation\n  for i in 1:n loop z[i] = i*u; end for;\n"
    "  y = Part.f(z[n])*a;\nend A;\n",
    "Lib/Part/package.mo": "within Lib;\npackage Part\n"
    "  function f input Real x; output Real y; algorithm y := x*x; end f;\nend Part;\n",
}


def refusal(folder: Path, text: str, model: str = "M") -> str:
    path = written(folder, {"m.mo": text}) / "m.mo"
    with pytest.raises(DseError) as caught:
        compile_probed(read_sources("part", model, [path], where=Location("component.yaml", 3, 1)))
    return str(caught.value)


def structural(folder: Path, text: str, model: str = "M") -> list[str]:
    path = written(folder, {"m.mo": text}) / "m.mo"
    return sorted(compile_probed(read_sources("part", model, [path])).structural)


def test_a_package_folder_is_read_and_every_variable_has_its_line(tmp_path: Path) -> None:
    folder = written(tmp_path, LIBRARY) / "Lib"
    result = compile_model(read_sources("part", "Lib.A", [folder]))
    places = {
        variable["name"]: result.location(*(variable["declaration"]["span"][key] for key in ("source", "start")))
        for variable in result.dae["storage"]["variables"]
    }
    assert places["n"] == Location(str(folder / "A.mo"), 3, 39)
    assert places["u"] == Location(str(folder / "A.mo"), 4, 9)
    assert result.description == "ä – test"


def test_a_package_is_found_by_its_package_file_and_below_a_library_folder(tmp_path: Path) -> None:
    written(tmp_path, LIBRARY)
    by_file = compile_model(read_sources("part", "Lib.A", [tmp_path / "Lib" / "package.mo"]))
    by_root = compile_model(read_sources("part", "Lib.A", [], [tmp_path]))
    names = [[v["name"] for v in result.dae["storage"]["variables"]] for result in (by_file, by_root)]
    assert names[0] == names[1] == ["a", "n", "u", "y", "z"]


def test_a_model_of_ones_own_uses_a_package_beside_it(tmp_path: Path) -> None:
    own = "package Own\n  model X Lib.A a; output Real y = a.y; equation a.u = time; end X;\nend Own;\n"
    written(tmp_path, {**LIBRARY, "Own.mo": own})
    result = compile_model(read_sources("part", "Own.X", [tmp_path / "Own.mo", tmp_path / "Lib"]))
    assert "a.z" in {variable["name"] for variable in result.dae["storage"]["variables"]}


def test_the_same_files_elsewhere_give_the_same_system(tmp_path: Path) -> None:
    one, other = (compile_model(read_sources("p", "Lib.A", [written(tmp_path / n, LIBRARY) / "Lib"])) for n in "ab")
    assert one.dae == other.dae


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("model M\n  Real x\n  Real y;\nend M;\n", ("m.mo:2:8: ", "unexpected `x`", "expected one of")),
        (
            "model M\n  Real x;\nequation\n  x = zz;\nend M;\n",
            ("m.mo:4:7: ", "M: unresolved component reference: 'zz'"),
        ),
        ("model M\n  Real x[2];\nequation\n  x = {1, 2, 3};\nend M;\n", ("m.mo:4:3: ", "array dimension mismatch")),
        ("model M\n  Real x;\nend M;\n", ("m.mo:1:7: ", "unbalanced model: 0 equations, 1 unknowns")),
        (
            "model M\n  Tiny.Blocks.Step step;\n  Real y;\nequation\n  connect(step.y, y);\nend M;\n",
            ("m.mo:2:3: ", "unresolved type reference: 'Tiny.Blocks.Step'", "if 'Tiny' is a library", "modelica_path"),
        ),
        ("package M\nend M;\n", ("m.mo:1:9: ", "it is a package, not a model", "name a model")),
        ("within P.Q;\nmodel M\n  Real x = 1;\nend M;\n", ("m.mo:2:7: ", "no file", "its full name is P.Q.M")),
        ("\ufeffmodel M\n  Real x\n  Real y;\nend M;\n", ("m.mo:2:8: ", "expected one of")),
        ("partial model M\n  Real x = 1;\nend M;\n", ("m.mo:1:15: ", "M is partial", "name a model that is complete")),
        ("model Other\n  Real x = 1;\nend Other;\n", ("component.yaml:3:1: ", "no file or library holds", "full name")),
        ("model M\n  output Real y = " + "+".join(["1"] * 20_000) + ";\nend M;\n", ("component.yaml:3:1: ", "crashed")),
    ],
)
def test_what_the_front_end_refuses_is_told_at_its_place(tmp_path: Path, text: str, expected: tuple[str, ...]) -> None:
    message = refusal(tmp_path, text)
    assert "Traceback" not in message
    for part in expected:
        assert part in message


def test_files_that_cannot_be_used_are_all_told(tmp_path: Path) -> None:
    (tmp_path / "latin.mo").write_bytes("model M \xe4 end M;".encode("latin-1"))
    (tmp_path / "empty").mkdir()
    files = [tmp_path / name for name in ("latin.mo", "empty", "gone.mo")]
    with pytest.raises(DseError) as caught:
        read_sources("part", "M", files, [tmp_path / "nowhere"])
    said = str(caught.value)
    for part in ("not UTF-8", "holds no Modelica", "there is no such file", "no folder"):
        assert part in said


REDECLARED = """package P
  block Gain "k times u" parameter Real k = 1; input Real u; output Real y = k*u; end Gain;
  model Base replaceable block B = Gain; B b; output Real y = b.y; equation b.u = 1; end Base;
  model M extends Base(redeclare block B = Gain(k = 0.5)); end M;
end P;
"""
TWO_FUNCTIONS = """package P
  model A function f input Real x; output Real y; algorithm y := x; end f; output Real y = f(1); end A;
  model B function f input Real x; output Real y; algorithm y := 10*x; end f; output Real y = f(1); end B;
  model M A a; B b; output Real y = a.y + b.y; end M;
end P;
"""
CHANGED_CONSTANT = """package P
  package Q constant Real k = 1; function f output Real y; algorithm y := k; end f; end Q;
  package R extends Q(k = 3); end R;
  model M output Real y = Q.f() + R.f(); end M;
end P;
"""


@pytest.mark.parametrize(
    ("text", "where", "what"),
    [
        (REDECLARED, "m.mo:4:40: ", "redeclaration of class 'B'"),
        (TWO_FUNCTIONS, "m.mo:2:20: ", "the function 'f' may be one of 2"),
        (CHANGED_CONSTANT, "m.mo:3:23: ", "constant 'k' is changed here and read by a function"),
    ],
)
def test_what_the_front_end_would_misread_is_refused(tmp_path: Path, text: str, where: str, what: str) -> None:
    message = refusal(tmp_path, text, "P.M")
    assert where in message
    assert what in message


def test_the_words_of_a_comment_are_no_redeclaration(tmp_path: Path) -> None:
    text = 'model M "redeclare model X = Y(k = 1)"\n  // redeclare model X = Y(k = 1)\n  output Real y = 1;\nend M;\n'
    assert structural(tmp_path, text) == []


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("parameter Integer n = 3; Real z[n]; output Real y = z[n]; equation z = ones(n);", ["n"]),
        ("parameter Real T = 1; output Real y(start = 0); equation when sample(0, T) then y = time; end when;", ["T"]),
        ("parameter Real a = 2; Real z, y; equation if a > 5 then y = 1; z = y; else y = z; z = 3; end if;", ["a"]),
        ("parameter Real a = 2 annotation(Evaluate = true); output Real y = a;", ["a"]),
        ("parameter Real a = 2; parameter Real b = 2*a; output Real y = a*b;", []),
        ("parameter Real a = -2; parameter Real b(start = 3); parameter Real c; output Real y = a*b*c;", []),
        ("parameter Boolean k = true; parameter Real q[3] = {1, 2, 3}; output Real y = if k then q[2] else time;", []),
        ("parameter Integer i = 2; parameter Real q[3] = {1, 2, 3}; output Real y = q[i];", []),
    ],
)  # fmt: skip
def test_a_parameter_the_front_end_uses_is_structural(tmp_path: Path, text: str, expected: list[str]) -> None:
    declarations, _, equations = text.partition("equation")
    model = f"model M {declarations}" + (f"equation {equations}" if equations else "") + " end M;"
    assert structural(tmp_path, model) == expected


def test_instances_of_one_class_keep_their_parameters(tmp_path: Path) -> None:
    text = """package P
  model L parameter Real k = 2; output Real y = k; end L;
  model M L a; L b; L c[2](each k = 3); output Real y = a.y + b.y + c[1].y; end M;
end P;"""
    assert structural(tmp_path, text, "P.M") == []


def test_a_value_put_in_place_of_a_name_is_another_parameters(tmp_path: Path) -> None:
    text = """package P
  record Point Real x; Real y; end Point;
  record Line Point from; Point to; end Line;
  function length input Line l; output Real s; algorithm s := l.to.x - l.from.x; end length;
  model M parameter Real k = 3; parameter Point a(x = k, y = 0); parameter Line l(from = a, to(x = 0, y = 4));
    output Real y = length(l); end M;
end P;"""
    assert {"k", "l.from.x"} <= set(structural(tmp_path, text, "P.M"))


def test_structural_values_are_given_and_must_take_effect(tmp_path: Path) -> None:
    folder = written(tmp_path, LIBRARY) / "Lib"
    result = compile_probed(read_sources("part", "Lib.A", [folder]), {"n": 5})
    types = result.dae["storage"]["value_types"]
    sizes = {v["name"]: types[v["value_type"]]["dimensions"] for v in result.dae["storage"]["variables"]}
    assert sizes["z"] == [5]
    assert result.structural == {"n"}
    with pytest.raises(DseError, match=r"'m' of Lib\.A cannot be given the value 5"):
        compile_probed(read_sources("part", "Lib.A", [folder]), {"m": 5})


@pytest.mark.parametrize(
    ("value", "text"),
    [(True, "true"), (3, "3"), (1e-300, "1e-300"), (-0.1, "-0.1"), ((1.0, 2.5), "{1.0, 2.5}"), ("A.b", "A.b")],
)  # fmt: skip
def test_values_are_written_as_modelica_reads_them(value: object, text: str) -> None:
    assert literal(value) == text  # type: ignore[arg-type]  # one test for all types


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "1); end M; model X", ""])
def test_what_is_no_value_is_not_written(value: object) -> None:
    with pytest.raises(ValueError, match="Modelica"):
        literal(value)  # type: ignore[arg-type]  # same


def test_dotted_names_become_nested_modifications() -> None:
    text = wrapper("P.M", {"a.b.c": "1", "a.d": "2", "e": "true"}, ["Q"])
    assert text == "// Q\nmodel DseWrapper\n  extends P.M(a(b(c=1), d=2), e=true);\nend DseWrapper;\n"


@pytest.mark.parametrize(("offset", "line", "column"), [(0, 1, 1), (2, 1, 2), (5, 2, 1), (9, 2, 3)])
def test_offsets_count_bytes_and_columns_count_characters(offset: int, line: int, column: int) -> None:
    assert SourceText("x.mo", "öab\näöü\n").location(offset) == Location("x.mo", line, column)


def child(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> FrontEnd:
    script = folder / "child.py"
    script.write_text(text, encoding="utf-8")
    monkeypatch.setattr(process, "_CHILD", script)
    return FrontEnd(folder, (), folder, seconds=2.0 if "sleep" in text else 60.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import time\ntime.sleep(60)\n", "took longer than 2 s"),
        ("raise SystemExit(3)\n", "crashed"),
        ("import sys\nsys.stdin.readline()\nprint('hello')\n", "answered what cannot be read"),
        ("import sys\nsys.stdin.readline()\nprint('[1]')\n", "answered what cannot be read"),
        ("input()\nprint('{\"version\": \"0.9.0\"}')\n", "is rumoca 0.9.0, but only 0.10.2 is known"),
        ("input()\nprint('{\"error\": {\"kind\": \"ImportError\", \"message\": \"\"}}')\n", "not installed"),
    ],
)  # fmt: skip
@pytest.mark.thorough
def test_a_front_end_that_misbehaves_is_told_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, message: str
) -> None:
    with child(tmp_path, text, monkeypatch) as front_end, pytest.raises(FrontEndDied, match=message):
        front_end.ask({"wrapper": "", "model": ""})


def test_after_a_crash_the_next_request_is_answered(tmp_path: Path) -> None:
    crash = "model M output Real y = " + "+".join(["1"] * 20_000) + "; end M;"
    (tmp_path / "files").mkdir()
    with FrontEnd(tmp_path, ("files",), tmp_path) as front_end:
        request = {"model": "M", "filename": "w.mo", "folder": str(tmp_path)}
        with pytest.raises(FrontEndDied):
            front_end.ask({**request, "wrapper": crash})
        assert front_end.ask({**request, "wrapper": "model M output Real y = 1; end M;"})["dae"]["schema_version"] == 43


def test_another_layout_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from dse.modelica.frontend import compile as compiling

    monkeypatch.setattr(compiling, "SCHEMA", 44)
    assert "writes layout 43, not 44" in refusal(tmp_path, "model M output Real y = 1; end M;")


ODD = """within Lib.Odd;
model Case
  replaceable block B = Gain constrainedby Gain(k = 3);
  extends Base(redeclare block B = Gain(k = 0.5));
  function f input Real x; output Real y; algorithm y := -x; end f;
end Case;
"""


def with_a_use(text: str) -> dict[str, str]:
    """The library with an odd class in it, and a class beside that has *text*."""
    odd = {"Lib/Odd/package.mo": "within Lib;\npackage Odd\nend Odd;\n", "Lib/Odd/Case.mo": ODD}
    odd["Lib/Odd/Gain.mo"] = "within Lib.Odd;\nblock Gain\n  parameter Real k = 1;\nend Gain;\n"
    odd["Lib/Odd/Base.mo"] = "within Lib.Odd;\nmodel Base\n  replaceable block B = Gain;\nend Base;\n"
    return {**LIBRARY, **odd, "Lib/B.mo": f"within Lib;\nmodel B\n  extends A;\n{text}end B;\n"}


def test_what_would_be_misread_in_classes_that_the_model_does_not_use_does_no_harm(tmp_path: Path) -> None:
    written(tmp_path, with_a_use("  // Odd.Case\n"))
    for sources in (read_sources("part", "Lib.B", [tmp_path / "Lib"]), read_sources("p", "Lib.B", [], [tmp_path])):
        assert "y" in compile_model(sources).flat["variables"]


def test_a_variable_of_a_function_is_not_the_constant_of_its_name(tmp_path: Path) -> None:
    function = "function f input Real x; output Real y; protected Real k = 2*x; algorithm y := k; end f;"
    model = "model M B b(k = 3); output Real y = f(b.y)*C.k; end M;"
    text = (
        f"package P package C constant Real k = 2; end C; {function} model B parameter Real k = 1; Real y = k; end B;"
    )
    assert structural(tmp_path, f"{text} {model} end P;", "P.M") == []
    reads = text.replace("Real k = 2*x; algorithm y := k", "Real j; algorithm y := C.k")
    assert structural(tmp_path, f"{reads} {model} end P;", "P.M") == []  # the parameter of B is changed
    for has in ("constant Real k = 1;", "extends C;"):
        based = reads.replace("parameter Real k = 1;", has).replace("package C", "model C")
        message = refusal(tmp_path, f"{based} {model} end P;", "P.M")
        assert "constant 'k' is changed here" in message


def test_an_expression_in_brackets_after_else_is_no_modification(tmp_path: Path) -> None:
    """Nor is the argument of a function whose name has dots."""
    function = "function any input Boolean b[:]; output Boolean y; algorithm y := b[1]; end any;"
    text = (
        f"package P package Q {function} end Q;\n"
        "model M Boolean a[2] = {time > 1, true}; Boolean b = if a[1] then a[2] else (P.Q.any(a) or a[2]\n"
        " and not P.Q.any(a)) and a[1]; output Real y = if b then 1 else 2; end M; end P;"
    )
    assert structural(tmp_path, text, "P.M") == []


@pytest.mark.parametrize(
    "use", ["  Odd.Case c;\n", "  import Lib.Odd.Case;\n  Case c;\n", "  model X = Odd.Case;\n  X c;\n"]
)
def test_what_would_be_misread_in_a_class_that_the_model_names_is_refused(tmp_path: Path, use: str) -> None:
    written(tmp_path, with_a_use(use))
    with pytest.raises(DseError) as caught:
        compile_model(read_sources("part", "Lib.B", [tmp_path / "Lib"]))
    said = [(problem.what, problem.where and Path(problem.where.file).name) for problem in caught.value.problems]
    assert all(file == "Case.mo" for _, file in said)
    for word in ("redeclaration of class 'B'", "'constrainedby' with modifications"):
        assert any(word in what for what, _ in said)


CHAIN = {
    "a.mo": "within P;\npackage Q constant Real k = R.k; model Unused Real x = S.k; end Unused; end Q;",
    "b.mo": "within P;\npackage R import P.T; constant Real k = 1; constant Real j = T.k; end R;",
    "c.mo": "within P;\npackage S constant Real k = 1; end S;",
    "d.mo": "within P;\nrecord T Real k; operator '+' function plus input U u; end plus; end '+'; end T;",
    "e.mo": 'within P;\nrecord U Real /*S*/ k = V.k "S"; end U;\npackage V\nconstant Real k = 1; model W end W; end V;',
    "M.mo": "within P;\nmodel M output Real y = Q.k; end M;",
    "package.mo": "package P constant Real q = 1; model Odd end Odd; end P;",
}


def test_a_class_is_used_if_anything_that_is_used_names_it() -> None:
    read = used([SourceText(name, text) for name, text in CHAIN.items()], "P.M")
    kept = {source.path: source.text for source in read}
    for source in read:
        for match in re.finditer(r"\w+", source.text):
            where = place(source, match.start())
            assert CHAIN[where.file].split("\n")[where.line - 1][where.column - 1 :].startswith(match[0])
    assert "c.mo" not in kept
    assert "Unused" not in kept["a.mo"]
    assert "Odd" not in kept["package.mo"]
    assert "W" not in kept["e.mo"]
    assert all(word in kept[name] for name, word in [("a.mo", "Q"), ("b.mo", "R"), ("d.mo", "plus"), ("e.mo", "V.k")])


def test_the_front_end_reads_only_the_classes_that_are_used_each_at_its_place() -> None:
    kept = {source.path: source.text for source in reached([SourceText(*item) for item in CHAIN.items()], "P.M")}
    assert "c.mo" not in kept
    assert kept["e.mo"] == CHAIN["e.mo"].replace("model W end W;", "              ")
    assert " ".join(kept["a.mo"].split()) == "within P; package Q constant Real k = R.k; end Q;"
    assert kept["a.mo"].index("end Q") == CHAIN["a.mo"].index("end Q")


def test_the_parts_of_libraries_are_made_again_only_if_a_file_has_changed(tmp_path: Path) -> None:
    kept: dict[tuple[tuple[str, bytes], ...], bytes] = {}
    made: list[bytes] = []

    def keep(asked: Sequence[tuple[str, bytes]], make: Callable[[], bytes]) -> bytes:
        if tuple(asked) not in kept:
            kept[tuple(asked)] = make()
            made.append(kept[tuple(asked)])
        return kept[tuple(asked)]

    more = {"Other/package.mo": "package Lib model A Real x = 1; end A; end Lib;"}
    no_package = {"Lib/Loose/A.mo": "within Lib.Loose; model A Real x = 1; end A;"}
    written(tmp_path, {**LIBRARY, **more, **no_package})
    first, again = (read_sources("part", "Lib.A", [], [tmp_path], keep=keep) for _ in range(2))
    assert first == again
    assert sorted(first.parts) == ["Lib/A.mo", "Lib/Part/package.mo", "Lib/package.mo", "Other/package.mo"]
    (tmp_path / "Lib" / "A.mo").write_text("within Lib; model A Real x = 2; end A;", encoding="utf-8")
    assert read_sources("part", "Lib.A", [], [tmp_path], keep=keep).parts != first.parts
    assert len(made) == 2


def test_prefixes_and_what_constrains_a_class_go_with_it() -> None:
    text = (
        'package P model M Real x; end M; replaceable partial model A end A constrainedby B(k = 1) "a;"; '
        "model B end B; type T = Real; end P;"
    )
    kept = reached([SourceText("p.mo", text)], "P.M")
    assert " ".join(kept[0].text.split()) == "package P model M Real x; end M; type T = Real; end P;"


def test_a_type_that_is_a_file_of_its_own_is_found_by_its_name() -> None:
    texts = [SourceText("p.mo", "package P model M T x; end M; end P;"), SourceText("t.mo", "within P; type T = Real;")]
    assert reached(texts, "P.M") == texts


def work(text: str) -> int:
    """How much the passes over a model of this *text* do: calls, and characters."""
    count = 0

    def called(*_: object) -> None:
        nonlocal count
        count += 1

    read = used([SourceText("m.mo", text)], "M")
    before = sys.getprofile()
    sys.setprofile(called)
    try:
        forest = Forest(read)
        found = list(misread_modifications(forest, ["f"])) + list(mixed_up_constants(forest, "M", ["f"]))
        places(forest.trees)
        made_of(forest.trees, {"x"}, {"x", "b"})
    finally:
        sys.setprofile(before)
    assert not found
    return count + sum(len(source.text) for source in read)


GROWING = {
    "blanks": lambda n: f"model M Real x{' ' * n}(start{' ' * n}={' ' * n}1){' ' * n}; end M;",
    "comments": lambda n: "model M " + "/* a word */ // another\n" * n + " Real x = 1; end M;",
    "lines": lambda n: "model M " + "Real x[3](each start = 1, y(z = f(2)));\n" * n + " end M;",
    "classes": lambda n: "model M " + "A a(b = 1); replaceable model A parameter Real b = 1; end A;\n" * n + " end M;",
    "brackets": lambda n: "model M Real x" + "(a" * n + " = 1" + ")" * n + "; end M;",
    "a long statement": lambda n: "model M Real x = " + "f(g(1), {2}) + " * n + "1; end M;",
}


@pytest.mark.parametrize("kind", GROWING)
def test_the_work_of_the_text_passes_grows_with_the_text(kind: str) -> None:
    _, small, middle, large = (work(GROWING[kind](n)) for n in (50, 50, 100, 200))  # the first also fills caches
    assert large - middle <= 2.1 * (middle - small)


def test_a_text_whose_classes_do_not_end_is_kept_whole() -> None:
    texts = [SourceText("a.mo", "model M Real x = N.k; end M;"), SourceText("b.mo", "model N model O end O; end X;")]
    assert [source.text for source in used(texts, "M")] == [source.text for source in texts]
    assert [source.text for source in used(texts, "Nowhere")] == [source.text for source in texts]


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path: Path) -> None:
    assert structural(tmp_path, "\ufeffmodel M output Real y = 1; end M;") == []


def test_a_file_within_another_package_than_its_folder_is_told(tmp_path: Path) -> None:
    written(tmp_path, {**LIBRARY, "Lib/C.mo": "within Other;\nmodel C\nend C;\n"})
    with pytest.raises(DseError, match=r"C\.mo:1:1: .*has 'within Other', but is in the folder of 'Lib'"):
        compile_model(read_sources("part", "Lib.C", [tmp_path / "Lib"]))
