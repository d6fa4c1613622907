"""A figure: how many runs each configuration had."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dse.plugins import Axis, Bars, Chart, ReportContent


class RunsPerConfiguration:
    """A sampler that looks at results may need more runs of some than of others."""

    title = "Runs per configuration"

    def charts(self, content: ReportContent) -> Sequence[Chart]:
        """One bar for each configuration."""
        names = tuple(entry.id for entry in content.configurations)
        heights = np.array([len(content.rows_of(name)) for name in names], dtype=np.float64)
        bars = Bars(np.arange(len(names) + 1) - 0.5, heights, "runs")
        return [Chart("all", "Runs", Axis("configuration", names=names), Axis("runs"), (bars,))]


FIGURE = RunsPerConfiguration()
