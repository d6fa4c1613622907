"""The tree of Modelica text: what is declared and modified, with its place; and all models of the tests are read."""

from __future__ import annotations

from pathlib import Path

import pytest

from dse.errors import DseError
from dse.modelica.frontend.source_text import SourceText, code
from dse.modelica.frontend.syntax import Element, Forest

HERE = Path(__file__).parent
TEXT = """within Lib;
encapsulated partial package P "with 'quotes' and (brackets"
  import A.B.{c, d}; import SI = A.Units; import A.*;
  type Kind = enumeration(one "1", two);
  replaceable model M = Q.Base(redeclare replaceable Lib.Fast engine[2](k(min = 1) = 3) "x", each x[1].y = 2)
    constrainedby Q.Limit(z = 1) annotation(choices(choice(redeclare model M = Other)));
  function extends f
    input Real x[:, 3] = [1, 2; 3, 4], y(start = if true then 1 else 2) if n > 1;
  algorithm
    for i in 1:3 loop if x[end] > 1 then return; end if; end for;
  protected
    Integer n;
    external "C" y = g(x) annotation(Include = "}");
  end f;
  operator record 'r s' end 'r s';
  operator '+' function plus output Real z; end plus; end '+';
  inner outer parameter .Lib.T t "last";
end P;
"""


def told(element: Element) -> tuple[object, ...]:
    around = element.parent.name or element.parent.type if element.parent else ""
    return (element.kind, element.name, element.type, around, element.where.line)


def test_declarations_and_modifications_are_found() -> None:
    (tree,) = Forest([SourceText("p.mo", code(TEXT))]).trees
    assert [told(element) for element in tree.elements] == [
        ("package", "P", "", "", 2),
        ("import", "A", "", "P", 3),
        ("import", "SI", "", "P", 3),
        ("import", "A", "", "P", 3),
        ("type", "Kind", "", "P", 4),
        ("model", "M", "Q.Base", "P", 5),
        ("component", "engine", "Lib.Fast", "M", 5),
        ("modifier", "k", "", "engine", 5),
        ("modifier", "min", "", "k", 5),
        ("modifier", "x.y", "", "M", 5),
        ("constrainedby", "", "Q.Limit", "P", 6),
        ("modifier", "z", "", "Q.Limit", 6),
        ("function", "f", "f", "P", 7),
        ("component", "x", "Real", "f", 8),
        ("component", "y", "Real", "f", 8),
        ("modifier", "start", "", "y", 8),
        ("component", "n", "Integer", "f", 12),
        ("record", "'r s'", "", "P", 15),
        ("operator", "'+'", "", "P", 16),
        ("function", "plus", "", "'+'", 16),
        ("component", "z", "Real", "plus", 16),
        ("component", "t", ".Lib.T", "P", 17),
    ]
    engine, t = tree.elements[6], tree.elements[-1]
    assert engine.prefixes == {"redeclare", "replaceable"}
    assert engine.is_argument
    assert engine.written == "k(min=1)=3"
    assert t.prefixes == {"inner", "outer", "parameter"}
    assert t.full == "Lib.P.t"
    assert tree.elements[5].constraint is tree.elements[10]


@pytest.mark.parametrize(
    "text", ["model M Real x end M;", "model M end N;", "model M Real x(y = 1; end M;", "model M end M; end M;", "M)"]
)
def test_what_is_not_modelica_is_refused(text: str) -> None:
    with pytest.raises(DseError, match=r"m\.mo:1:1: text that cannot be read"):
        Forest([SourceText("m.mo", text)])


def test_all_models_of_the_tests_and_components_are_read() -> None:
    files = [*HERE.rglob("*.mo"), *(HERE.parents[1] / "components").rglob("*.mo")]
    texts = [SourceText(str(file), code(file.read_text(encoding="utf-8-sig"))) for file in files]
    forest = Forest(text for text in texts if not text.path.endswith("SyntaxError.mo"))
    assert len(forest.trees) > 200
