"""Whether a sampler that looks for the best designs finds them: on functions whose least value is known.

class TestMine(SearcherSuite):
    sampler = Mine
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import dse
from dse.loading import SamplerSection

SEEDS = range(10)

Choose = Callable[[str, Sequence[str]], str]
"""Chooses at a place of the design one of some alternatives."""

Place = Callable[[str], float]
"""Places a variable in its range, 0 … 1."""

Searched = Callable[["Problem", int, int], float]
"""The least value that another search finds of a problem, with a seed, in so many evaluations."""


@dataclass(frozen=True)
class Problem:
    """A function to be small where its margin is not negative; *least* is the least value it has there.

    *value* gives value and margin of what it chooses and places. *components* are the alternatives' bodies in C, which
    set ``f`` and ``g`` from x[0], x[1], …, by name, with the names of their variables.
    """

    name: str
    least: float
    value: Callable[[Choose, Place], tuple[float, float]]
    components: Mapping[str, tuple[Sequence[str], str]]
    root: str
    """The design's, as YAML; what implements ``fn`` gives the outputs f and g."""
    variables: Sequence[str]
    top: str = "fn"
    places: Mapping[str, Sequence[str]] = field(default_factory=dict)


def _branin(_: Choose, place: Place) -> tuple[float, float]:
    a, b = 15 * place("fn.x0") - 5, 15 * place("fn.x1")
    bowl = (b - 5.1 / (4 * math.pi**2) * a**2 + 5 / math.pi * a - 6) ** 2
    return bowl + 10 * (1 - 1 / (8 * math.pi)) * math.cos(a) + 10, 1.0


def _hartmann(_: Choose, place: Place) -> tuple[float, float]:
    x = np.array([place(f"fn.x{i}") for i in range(6)])
    return -float(np.array(_WEIGHTS) @ np.exp(-(np.array(_STEEP) * (x - np.array(_CENTRES)) ** 2).sum(axis=1))), 1.0


def _ackley(_: Choose, place: Place) -> tuple[float, float]:
    x = 65.536 * np.array([place(f"fn.x{i}") for i in range(5)]) - 32.768
    waves = math.exp(float(np.cos(2 * math.pi * x).mean()))
    return -20 * math.exp(-0.2 * math.sqrt(float((x**2).mean()))) - waves + 20 + math.e, 1.0


def _gomez(_: Choose, place: Place) -> tuple[float, float]:
    x, y = 2 * place("fn.x0") - 1, 2 * place("fn.x1") - 1
    value = (4 - 2.1 * x**2 + x**4 / 3) * x**2 + x * y + (4 * y**2 - 4) * y**2
    return value, math.sin(4 * math.pi * x) - 2 * math.sin(2 * math.pi * y) ** 2


def _toy(choose: Choose, place: Place) -> tuple[float, float]:
    x, pi, cos = place("fn.x0"), math.pi, math.cos
    curves: Mapping[str, Callable[[], float]] = {
        "toy0": lambda: cos(3.6 * pi * (x - 2)) + x - 1,
        "toy1": lambda: 2 * cos(1.1 * pi * math.exp(x)) - x / 2 + 2,
        "toy2": lambda: cos(2 * pi * x) + x / 2,
        "toy3": lambda: x * (cos(3.4 * pi * (x - 1)) - (x - 1) / 2),
        "toy4": lambda: -(x**2) / 2,
        "toy5": lambda: 2 * cos(pi / 4 * math.exp(-(x**4))) ** 2 - x / 2 + 1,
        "toy6": lambda: x * cos(3.4 * pi * x) - x / 2 + 1,
        "toy7": lambda: x * (-cos(3.5 * pi * x) - x / 2) + 2,
        "toy8": lambda: -(x**5) / 2 + 1,
        "toy9": lambda: -(cos(2.5 * pi * x) ** 2) * math.sqrt(x) - math.log(x + 0.5) / 2 - 1.3,
    }
    return curves[choose("fn", list(curves))](), 1.0


def _tree(choose: Choose, place: Place) -> tuple[float, float]:
    branch, least = {"left": ("low", 0.1), "right": ("high", 0.3)}[choose("fn", ["left", "right"])]
    leaves = {"low": ["leaf0", "leaf1"], "high": ["leaf2", "leaf3"]}[branch]
    leaf = choose(f"fn.{branch}", leaves)
    x = 2 * place(f"fn.{branch}.x{leaf[-1]}") - 1
    return x**2 + least + 0.1 * leaves.index(leaf) + place(f"fn.{branch}.r"), 1.0


_WEIGHTS = (1.0, 1.2, 3.0, 3.2)
_STEEP = ((10, 3, 17, 3.5, 1.7, 8), (0.05, 10, 17, 0.1, 8, 14), (3, 3.5, 1.7, 10, 17, 8), (17, 8, 0.05, 10, 0.1, 14))
_CENTRES = (
    (0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886),
    (0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991),
    (0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650),
    (0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381),
)
_ROW = "{{{}}}"
_TABLES = "; ".join(
    f"static const double {name}[4][6] = {{{', '.join(_ROW.format(', '.join(map(str, row))) for row in table)}}}"
    for name, table in (("s", _STEEP), ("c", _CENTRES))
)
_BRANIN = """double a = 15*x[0]-5, b = 15*x[1], q = b-5.1/(4*pi*pi)*a*a+5/pi*a-6;
  f = q*q+10*(1-1/(8*pi))*cos(a)+10;"""
_HARTMANN = f"""{_TABLES};
  static const double w[4] = {{{", ".join(map(str, _WEIGHTS))}}};
  for (int i = 0; i < 4; i++) {{
    double e = 0; for (int j = 0; j < 6; j++) e += s[i][j]*(x[j]-c[i][j])*(x[j]-c[i][j]);
    f -= w[i]*exp(-e);
  }}"""
_ACKLEY = """double q = 0, k = 0;
  for (int i = 0; i < 5; i++) { double a = 65.536*x[i]-32.768; q += a*a/5; k += cos(2*pi*a)/5; }
  f = -20*exp(-0.2*sqrt(q))-exp(k)+20+exp(1);"""
_GOMEZ = """double a = 2*x[0]-1, b = 2*x[1]-1, v = sin(2*pi*b);
  f = (4-2.1*a*a+a*a*a*a/3)*a*a+a*b+(4*b*b-4)*b*b; g = sin(4*pi*a)-2*v*v;"""
_CURVES = (
    "cos(3.6*pi*(t-2))+t-1",
    "2*cos(1.1*pi*exp(t))-t/2+2",
    "cos(2*pi*t)+t/2",
    "t*(cos(3.4*pi*(t-1))-(t-1)/2)",
    "-t*t/2",
    "2*pow(cos(pi/4*exp(-pow(t,4))),2)-t/2+1",
    "t*cos(3.4*pi*t)-t/2+1",
    "t*(-cos(3.5*pi*t)-t/2)+2",
    "-pow(t,5)/2+1",
    "-pow(cos(2.5*pi*t),2)*sqrt(t)-log(t+0.5)/2-1.3",
)
_LEAVES = {
    f"leaf{i}": ((f"x{i}", "r"), f"f = (2*x[0]-1)*(2*x[0]-1)+{number}+x[1];")
    for i, number in enumerate((0.1, 0.2, 0.3, 0.4))
}
_X = [f"x{i}" for i in range(6)]
_BRANCH = "{{implements: fn, compound: {{{0}: {{alternatives: [{1}, {2}]}}}}, connections: [{0}.f -> f, {0}.g -> g]}}"


def _plain(
    name: str, least: float, value: Callable[[Choose, Place], tuple[float, float]], count: int, c: str
) -> Problem:
    return Problem(name, least, value, {name: (_X[:count], c)}, f"fn: {name}", [f"fn.{x}" for x in _X[:count]])


PROBLEMS = (
    _plain("branin", 0.397887, _branin, 2, _BRANIN),
    _plain("hartmann6", -3.32237, _hartmann, 6, _HARTMANN),
    _plain("ackley5", 0.0, _ackley, 5, _ACKLEY),
    _plain("gomez", -0.971104, _gomez, 2, _GOMEZ),
    # Munoz Zuniga and Sinoquet 2020: ten curves.
    Problem(
        "toy",
        -2.329605,
        _toy,
        {f"toy{i}": (["x0"], f"double t = x[0]; f = {curve};") for i, curve in enumerate(_CURVES)},
        f"fn: {{alternatives: [{', '.join(f'toy{i}' for i in range(10))}]}}",
        ["fn.x0"],
        places={"fn": [f"toy{i}" for i in range(10)]},
    ),
    # Jenatton et al. 2017: which variables there are depends on two choices.
    Problem(
        "tree",
        0.1,
        _tree,
        _LEAVES,
        f"fn: {{alternatives: [{{left: {_BRANCH.format('low', 'leaf0', 'leaf1')}}}, "
        f"{{right: {_BRANCH.format('high', 'leaf2', 'leaf3')}}}]}}",
        ["fn.low.x0", "fn.low.x1", "fn.low.r", "fn.high.x2", "fn.high.x3", "fn.high.r"],
        places={"fn": ["left", "right"], "fn.low": ["leaf0", "leaf1"], "fn.high": ["leaf2", "leaf3"]},
    ),
)
"""Branin, Hartmann-6, Ackley-5 and Gomez (with its constraint) without choices, one of ten, and three in a tree."""


def lay_out(problem: Problem, root: Path) -> None:
    """A workspace with design and bench of *problem*, which the component kind c builds."""
    texts = {
        "components/interfaces.yaml": 'interfaces:\n  fn: {outputs: {f: "1", g: "1"}}\n',
        "designs/design.yaml": f"design: design\nroot:\n  compound:\n    {problem.root}\n",
        "testbenches/bench.yaml": _BENCH,
    }
    for name, (variables, body) in problem.components.items():
        texts[f"components/{name}/component.yaml"] = (
            f"component: {name}\nimplements: fn\nsource: {{kind: c, files: [{name}.c]}}\nparameters:\n"
            + "".join(f"  {variable}: {{start: 0.3, min: 0, max: 1}}\n" for variable in variables)
        )
        texts[f"components/{name}/{name}.h"] = (
            "#pragma once\ntypedef struct { struct { double f, g; } out; "
            f"struct {{ double {', '.join(variables)}; }} par; }} {name};\n"
            f"void {name}_init({name} *self);\nvoid {name}_step({name} *self, double h);\n"
        )
        given = ", ".join(f"self->par.{variable}" for variable in variables)
        texts[f"components/{name}/{name}.c"] = (
            f'#include "{name}.h"\n#include <math.h>\nvoid {name}_init({name} *self) {{\n'
            f"  const double x[] = {{{given}}}, pi = 3.14159265358979323846; double f = 0, g = 1; (void)pi;\n"
            f"  {body}\n  self->out.f = f; self->out.g = g;\n}}\n"
            f"void {name}_step({name} *self, double h) {{ (void)self; (void)h; }}\n"
        )
    for name, text in texts.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")


_BENCH = """testbench: bench
design: design
simulation: {stop: 10 ms, step: 10 ms}
metrics: {f: final(fn.f), g: final(fn.g)}
requirements:
  R: {metric: g, at_least: 0}
"""


def found(problem: Problem, root: Path, sampler: str, seed: int) -> float:
    """The least value that a study in the workspace *root* finds. Its runs are compared with the function's definition.

    *sampler* is what stands in the study's file.
    """
    ranges = ", ".join(f"{variable}: {{range: [0, 1]}}" for variable in problem.variables)
    text = f"study: s\ntestbench: bench\nconfigurations: all\ndesign_variables: {{{ranges}}}\n"
    text += f"objectives: [minimize f]\nseed: {seed}\nsampler: {sampler}\n"
    (root / "testbenches/s.pet.yaml").write_text(text, encoding="utf-8")
    results = dse.open(root).studies["s"].explore(root / f"out/{seed}", workers=1, fresh=True)
    best = math.inf
    for record in results.to_pandas().to_dict("records"):
        row = {str(name): value for name, value in record.items()}
        value, margin = problem.value(partial(_made, row), row.__getitem__)
        assert (row["f"], row["g"]) == pytest.approx((value, margin), rel=1e-9, abs=1e-12)
        best = min(best, value if margin >= 0 else math.inf)
    return best


def _made(row: Mapping[str, Any], place: str, _: Sequence[str]) -> str:
    return str(row[place])


def by_chance(problem: Problem, seed: int, evaluations: int) -> float:
    """The least value of so many designs that are drawn."""
    random = np.random.default_rng(seed)

    def choose(_: str, options: Sequence[str]) -> str:
        return options[int(random.integers(len(options)))]

    runs = [problem.value(choose, lambda _: float(random.random())) for _ in range(evaluations)]
    return min((value for value, margin in runs if margin >= 0), default=math.inf)


class SearcherSuite:
    """The sampler searches all `PROBLEMS` through files and API, with so many *evaluations* and ten seeds.

    *options* are those that stand beside them. Compared are medians of the regret, which is how much the best that was
    found is above the least value. It is less than by chance, and with a *library*, which searches itself, exceeds the
    library's by at most a quarter of what chance leaves, or is at most so many times the library's as *bands* says.
    *unfit* tells of problems why the kind of search is not better than chance. It takes minutes: mark it ``nightly``.
    """

    sampler: type[SamplerSection]
    evaluations = 60
    options: ClassVar[Mapping[str, Any]] = {}
    library: Searched | None = None
    bands: ClassVar[Mapping[str, float]] = {}
    unfit: ClassVar[Mapping[str, str]] = {}

    @pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.name)
    def test_it_is_better_than_chance_and_as_good_as_its_library(self, problem: Problem, tmp_path: Path) -> None:
        """Every run is compared with the function, too (`found`)."""
        lay_out(problem, tmp_path)
        options = {"evaluations": self.evaluations, **self.options}
        written = f"{{{self.sampler.name}: {{{', '.join(f'{key}: {value}' for key, value in options.items())}}}}}"

        def regret(values: Sequence[float]) -> float:
            return float(np.median(values)) - problem.least

        own = regret([found(problem, tmp_path, written, seed) for seed in SEEDS])
        chance = regret([by_chance(problem, seed, self.evaluations) for seed in range(200)])
        assert own < chance or problem.name in self.unfit
        if library := type(self).library:
            theirs = regret([library(problem, seed, self.evaluations) for seed in SEEDS])
            band = self.bands.get(problem.name)
            assert own <= (theirs + chance / 4 if band is None else band * theirs)
