"""The code of CONTRIBUTING's recipes, put through the suites it tells authors to run."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

from dse.testing.figures import STUDIES, FigureSuite, study
from dse.testing.metrics import MetricSuite

TEXT = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text(encoding="utf-8")


@pytest.fixture
def recipe(tmp_path, monkeypatch):
    """The module that the recipe tells to write."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def module(name):
        (code,) = re.findall(rf'```python\n("""{name}\.py""".*?)```', TEXT, re.DOTALL)
        (tmp_path / f"{name}.py").write_text(code, encoding="utf-8")
        return importlib.import_module(name)

    return module


@pytest.mark.thorough
def test_the_figure_of_the_recipe_conforms(recipe):
    suite = FigureSuite()
    suite.figure = recipe("runs_per_configuration").FIGURE
    for kind in STUDIES:
        suite.test_it_draws_every_study(kind)
        suite.test_axes_carry_their_unit(kind)
    suite.test_it_can_be_printed()
    (chart,) = suite.figure.charts(study("of three configurations"))
    assert chart.drawn[0].heights.tolist() == [14, 13, 13]


def test_the_metric_function_of_the_recipe_conforms(recipe):
    suite = MetricSuite()
    suite.name, suite.function = "peak_to_peak", recipe("peaks").PEAK_TO_PEAK
    for name in (
        name for name in dir(MetricSuite) if name.startswith("test_") and name != "test_a_few_rows_are_enough"
    ):
        getattr(suite, name)()
    suite.test_a_few_rows_are_enough(1)
