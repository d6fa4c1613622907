"""How the time of each pass over Modelica text grows with the text: processor time of 2 n and 4 n over that of n.

`python benchmarks/bench_modelica_text.py`: a pass that is linear has ratios near 2 and 4; from 3 and 7 on it is told.
"""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from dse.errors import DseError
from dse.modelica.frontend.buses import with_members
from dse.modelica.frontend.library_functions import with_tables
from dse.modelica.frontend.library_names import distinct
from dse.modelica.frontend.misreadings import misread_modifications, mixed_up_constants
from dse.modelica.frontend.other_words import with_equations, with_variables
from dse.modelica.frontend.redeclarations import with_redeclarations
from dse.modelica.frontend.source_text import SourceText, code, declarations
from dse.modelica.frontend.structural.shape import made_of, places
from dse.modelica.frontend.syntax import Forest
from dse.modelica.frontend.used_classes import reached, used

MOST = (3.0, 7.0)
"""Ratios of 2 n and 4 n to n that are too many."""
BODY = "  parameter Real k = 1; Real x(start = 0); replaceable model R = L.A; C c(k = 2, x(start = 3));\n"


def texts(n: int) -> Mapping[str, list[SourceText]]:
    """Texts of about 40 n characters each, of one sort."""
    classes = "".join(f"model M{i}\n{BODY}  function f\n  end f;\nend M{i};\n" for i in range(n // 4))
    whole = {
        "blanks": f"model T\n  Real x{' ' * 40 * n}= 1;\n  Real y =\n{' ' * 40 * n}x;\nend T;",
        "lines": "model T\n" + BODY * (n // 2) + "end T;",
        "empty lines": "model T\n  Real x\n" + "\n" * 40 * n + "= 1;\nend T;",
        "classes": f"package P\n{classes}model T extends M0; M1 a; end T;\nend P;",
        "words": "model T\n  parameter Real k = " + " + ".join(f"a{i}.b[{i}]" for i in range(3 * n)) + ";\nend T;",
        "brackets": "model T\n  Real x" + "(a" * 4 * n + ")" * 4 * n + ";\nend T;",
        "connections": "model T\nequation\n" + "".join(f"  connect(a.y, b.u[{i}]);\n" for i in range(2 * n)) + "end T;",
        "buses": "package P\n  connector R = output Real;\n  expandable connector B\n  end B;\n  model W\n"
        "    Real g[2];\n  end W;\n  model T\n    outer W w; B b;"
        + "".join(f" R r{i};" for i in range(n))
        + "\n  equation\n"
        + "".join(f"    connect(b.r{i}, r{i}); der(r{i} - 1) = w.g[1];\n" for i in range(n))
        + "  end T;\nend P;",
        "redeclarations": "package P\n  model A Real x = 1; end A;\n  model B Real x = 2; end B;\n  model W\n"
        + "".join(f"    replaceable A a{i};\n" for i in range(n))
        + "  end W;\n  model V extends W; end V;\n  model T\n    extends V("
        + ", ".join(f"redeclare B a{i}" for i in range(n))
        + ");\n  end T;\nend P;",
        "constants": "package P\n"
        + "".join(f"  constant Real c{i} = {i};\n" for i in range(n))
        + "model T end T; end P;",
        "comments": "model T\n"
        + "  // a 'comment' (of \"one\" line)\n" * n
        + "  /* and more "
        + "* " * 10 * n
        + "*/\nend T;",
    }
    return {name: [SourceText("P.mo", text)] for name, text in whole.items()}


def run(made: Iterable[Any] | Any) -> None:
    """Let a generator do its work."""
    if not isinstance(made, str):
        list(made)


def passes() -> Mapping[str, Callable[[list[SourceText]], None]]:
    """All passes over sources, by name."""
    return {
        "code": lambda given: run(code(given[0].text)),
        "declarations": lambda given: run(declarations(given, "P.T")),
        "used": lambda given: run(used(given, _model(given))),
        "reached": lambda given: run(reached(given, _model(given))),
        "tables": lambda given: run(with_tables(given[0].text + "// ExternalCombiTable1D")),
        "names": lambda given: run(distinct(given, [])),
        "members": _with_members,
        "derivatives": lambda given: run(with_variables({"P.mo": given[0].text.encode()})),
        "connections": lambda given: run(with_equations({"P.mo": given[0].text.encode()}, 2)),
        "redeclarations": _with_redeclarations,
        "modifications": lambda given: run(misread_modifications(_forest(given), ())),
        "constants": lambda given: run(mixed_up_constants(_forest(given), _model(given), ["f"])),
        "shape": lambda given: run(places(_forest(given).trees)),
        "made of": lambda given: run(made_of(_forest(given).trees, {"k"}, {"k", "x"})),
    }


def _with_members(given: list[SourceText]) -> None:
    with contextlib.suppress(DseError):  # brackets too deep
        with_members({"P.mo": given[0].text.encode()})


def _with_redeclarations(given: list[SourceText]) -> None:
    with contextlib.suppress(DseError):  # brackets too deep
        with_redeclarations(_model(given), {"P.mo": given[0].text.encode()})


def _forest(given: list[SourceText]) -> Forest:
    try:
        return Forest(used(given, _model(given)))
    except DseError:  # brackets too deep
        return Forest([])


def _model(given: list[SourceText]) -> str:
    return "P.T" if given[0].text.startswith("package") else "T"


def seconds(work: Callable[[list[SourceText]], None], given: list[SourceText]) -> float:
    """The shortest of three runs, of the processor."""
    found = []
    for number in range(3):
        new = [replace(text, text=text.text + " " * number) for text in given]  # what was read once may be kept
        begun = time.process_time()
        work(new)
        found.append(time.process_time() - begun)
    return min(found)


def main() -> int:
    """Print one line for each pass and sort of text; the exit status is 1 if one grows too fast."""
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    sizes = [texts(n * factor) for factor in (1, 2, 4)]
    bad = 0
    print(f"{'pass':15}{'text':15}{'ms':>8}{'2 n':>7}{'4 n':>7}")
    for name, work in passes().items():
        for sort in sizes[0]:
            spent = [seconds(work, each[sort]) for each in sizes]
            ratios = [each / max(spent[0], 1e-4) for each in spent[1:]]  # below 0.1 ms the clock counts
            is_bad = any(ratio > most for ratio, most in zip(ratios, MOST, strict=True))
            bad += is_bad
            mark = "  grows too fast" if is_bad else ""
            print(f"{name:15}{sort:15}{spent[0] * 1e3:8.2f}{ratios[0]:7.1f}{ratios[1]:7.1f}{mark}", flush=True)
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
