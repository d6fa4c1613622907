"""Classes of libraries that the front-end mixes up by their names."""

from __future__ import annotations

from pathlib import Path

import pytest
from modelica_components import MakeModel
from slaves import run_cs

from dse.modelica.frontend.library_names import distinct
from dse.modelica.frontend.source_text import SourceText

MOTION = Path(__file__).parent / "motion"


def test_bases_in_a_class_and_functions_of_one_name_are_told_apart(made: MakeModel) -> None:
    model = made(MOTION / "Ride.mo", (MOTION,))
    rows = run_cs(model, ["s", "is_behind", "straight", "curved"], 10, 0.07, {}, {}, 1e-9)
    for k, row in enumerate(rows):
        t = k * 0.07
        expected = {
            "s": 2 * t,
            "is_behind": float(2 * t > 0.5),
            "straight": 1 + 2 * t,
            "curved": -1 - 2 * t - 3 * t * t,
        }
        assert row == pytest.approx(expected, abs=1e-9), t


def library(**texts: str) -> list[SourceText]:
    return [SourceText(f"L/{name}.mo", f"within L;\n{text}") for name, text in texts.items()]


ONE = "model One\n  function f\n  end f;\n  Real y = f(1);\nend One;"
TWO = ONE.replace("One", "Two")


def names(found: list[SourceText], own: str = "") -> dict[str, str]:
    return {text.path: text.text for text, _ in distinct(found, [SourceText("own.mo", own)] if own else [])}


def test_a_function_gets_the_name_of_its_model() -> None:
    found = names(library(One=ONE, Two=TWO))
    assert "function f_of_One\n  end f_of_One;\n  Real y = f_of_One(1);" in found["L/One.mo"]
    assert "function f_of_Two" in found["L/Two.mo"]


@pytest.mark.parametrize(
    ("second", "own"),
    [
        (TWO, "model Own extends L.One; end Own;"),
        (TWO, "model Own Real x = L.One.f(2); end Own;"),
        (TWO, "model Own L.Three t(redeclare model M = L.One); end Own;"),
        (TWO.replace("function f", "function g").replace("end f", "end g"), ""),
        (TWO.replace("function f", "redeclare function f"), ""),
    ],
    ids=["extended", "named", "redeclared", "alone", "of another"],
)
def test_a_function_that_others_may_name_keeps_its_name(second: str, own: str) -> None:
    assert "function f\n" in names(library(One=ONE, Two=second), own)["L/One.mo"]


def test_a_model_that_uses_the_name_otherwise_keeps_it() -> None:
    variable = ONE.replace("Real y", "Real f = 2; Real y")
    assert names(library(One=variable, Two=TWO))["L/One.mo"].endswith(variable)


BASE = "model Outer\n  extends Base;\n  {}partial model Base\n    Real x;\n  end Base;\nend Outer;"


def test_an_encapsulated_base_gets_a_file_in_which_its_lines_stay() -> None:
    found = names(library(Outer=BASE.format("encapsulated ")))
    apart = found["L/Outer_Base.mo"].split("\n")
    assert apart[0] == "within L;"
    assert apart[3:6] == ["encapsulated partial model Outer_Base", "    Real x;", "  end Outer_Base;"]
    assert found["L/Outer.mo"].split("\n")[2:] == ["  extends Outer_Base;", "  ", "", "", "end Outer;"]


def test_a_base_that_may_need_what_is_around_it_stays() -> None:
    assert list(names(library(Outer=BASE.format("")))) == ["L/Outer.mo"]
