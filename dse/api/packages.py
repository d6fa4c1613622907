"""SSP packages: simulated once, and what came of it as the system's own connectors show it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dse.domain.run import Run
from dse.exploration import simulate_alone
from dse.storage import Measures
from dse.testbench import make_runner

if TYPE_CHECKING:
    from dse.interchange import PreparedPackage


def simulate_package(package: PreparedPackage, *, sandbox: bool = False) -> Run:
    """The run of the package at its own point; its waveforms are the package's signals by name; see `Study.explore`."""
    run = simulate_alone(package.bench, make_runner, "ssp", Measures(), sandboxed=sandbox)
    if run.waveforms is None:
        return run
    return replace(run, waveforms=package.signals(run.waveforms))
