"""Parameters that decide about the shape of a model behind a threshold that no other value happens to cross."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from dse.modelica.frontend.process import FrontEnd
from dse.modelica.frontend.sources import read_sources
from dse.modelica.frontend.structural.probe import compile_probed

LAMP = "model Lamp parameter Real q = 1; output Real y = q; end Lamp;"
CASES = {
    "the condition of a component": (
        f"{LAMP} model M parameter Real k = 1; Lamp a if k > 0; output Real y = k; end M;",
        {"k"},
    ),
    "a condition further down, through a modification": (
        (
            f"{LAMP} model S parameter Integer n = 3; Lamp a if n > 5; output Real y = n; end S;"
            " model M parameter Integer m = 3; S s(n = m); output Real y = s.y; end M;"
        ),
        {"m", "s.n"},
    ),
    "an item of an enumeration": (
        (
            f"type E = enumeration(one, two, three); {LAMP}"
            " model M parameter E m = E.one; Lamp a if m <> E.three; output Real y = 1; end M;"
        ),
        {"m"},
    ),
    "a range": (
        "model M parameter Integer n = 3; output Real y; equation y = sum(i for i in 1:max(n, 5)); end M;",
        {"n"},
    ),
    "a size": (
        (
            "model M parameter Integer n = 3; Real z[max(n, 5)]; output Real y;"
            " equation z = linspace(0, 1, max(n, 5)); y = sum(z); end M;"
        ),
        {"n"},
    ),
    "the size of what is given to an array": (
        (
            "model A parameter Real v[:]; output Real y = sum(v); end A;"
            " model M parameter Integer n = 3; A a(v = ones(max(n, 5))); output Real y = a.y; end M;"
        ),
        {"n"},
    ),
    "what a size is computed from": (
        (
            "model A parameter Integer n = 2; parameter Real w = 1; Real z[n] = fill(w, n);"
            " output Real y = sum(z); end A;"
            " model M parameter Real k = 1; A a(n = if k > 0 then 2 else 3); output Real y = a.y; end M;"
        ),
        {"a.n", "k"},
    ),
    "a period": (
        (
            "model M parameter Real k = 1; discrete output Real y(start = 0, fixed = true);"
            " equation when sample(0.1, if k > 0 then 0.2 else 0.4) then y = pre(y) + 1; end when; end M;"
        ),
        {"k"},
    ),
    "nothing but numbers": (
        (
            "model M parameter Real k = 1; parameter Real A[2, 2] = [0, 1; -k, -2];"
            " Real x[2](start = {1, 0}, each fixed = true); output Real y = x[1]; equation der(x) = A*x; end M;"
        ),
        set(),
    ),
}


@pytest.mark.parametrize("place", CASES)
def test_a_parameter_is_structural_where_the_shape_depends_on_it(place: str, tmp_path: Path) -> None:
    text, expected = CASES[place]
    file = tmp_path / "T.mo"
    file.write_text(f"package T {text} end T;", encoding="utf-8")
    assert compile_probed(read_sources("m", "T.M", [file])).structural == expected


def test_three_requests_tell_a_library_models_structural_parameters(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The base, the base with all values named, and one with other values of all: each tells whose it is."""
    (tmp_path / "L").mkdir()
    parts = (
        "package L model Source parameter Real start_time = 0; output Real y = if time < start_time then 0 else 1;"
        " end Source; model Gain parameter Real k = 1; parameter Real unused = 5; output Real y = k*time; end Gain;"
        " model Held parameter Real k = 2; Gain gain(final k = k); end Held;"
        " model M Source a; Source b(start_time = 0.5); Held h; Gain g(k = 3); end M; end L;"
    )
    (tmp_path / "L" / "package.mo").write_text(parts, encoding="utf-8")
    asked = []
    ask = FrontEnd.ask

    def counted(self: FrontEnd, request: Mapping[str, object]) -> dict[str, Any]:
        asked.append(request)
        return ask(self, request)

    monkeypatch.setattr(FrontEnd, "ask", counted)
    assert compile_probed(read_sources("m", "L.M", [], [tmp_path])).structural == {"h.k"}
    assert len(asked) == 3
