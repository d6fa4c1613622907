"""What every kind, sampler, executor, figure and metric function has to be."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from dse_example.bisection import Bisection
from dse_example.futures import Futures
from dse_example.peak_to_peak import PEAK_TO_PEAK
from dse_example.runs_per_configuration import FIGURE

from dse.testing.executors import ExecutorSuite
from dse.testing.figures import FigureSuite
from dse.testing.kinds import KindSuite
from dse.testing.metrics import MetricSuite
from dse.testing.samplers import SamplerSuite

COMPONENTS = Path(__file__).parents[1] / "workspace" / "components"


class TestTable(KindSuite):
    @pytest.fixture
    def example(self) -> Mapping[str, str]:
        names = ("interfaces.yaml", "linear_spring/component.yaml")
        return {name: (COMPONENTS / name).read_text(encoding="utf-8") for name in names}


class TestBisection(SamplerSuite):
    sampler = Bisection


class TestFutures(ExecutorSuite):
    executor = Futures


class TestRunsPerConfiguration(FigureSuite):
    figure = FIGURE


class TestPeakToPeak(MetricSuite):
    name, function = "peak_to_peak", PEAK_TO_PEAK
