"""The figures: every module here holds one under its own name (`dse.report.figure` says what a figure is)."""

from __future__ import annotations

from dse.report.figures.constraints import constraint_plot_data, default_axes, planes
from dse.report.figures.waveforms import default_run, waveform_data

__all__ = ["constraint_plot_data", "default_axes", "default_run", "planes", "waveform_data"]
