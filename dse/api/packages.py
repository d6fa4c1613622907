"""SSP packages and single FMUs: simulated once, and what came of it as the system's own connectors show it."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.studies.run import Waveforms
from dse.domain.run import Run
from dse.errors import Location, fail
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


def simulate(
    path: str | Path,
    *,
    stop: float | None = None,
    step: float | None = None,
    set: Mapping[str, str | float] | None = None,  # noqa: A002  # as Bench.simulate
    record: Sequence[str] = (),
    tolerance: float | None = None,
    timeout: float = 600.0,
    sandbox: bool = False,
) -> Waveforms:
    """The waveforms of an FMU or SSP package at *path*, simulated once in a process of its own.

    What *stop* and *step* (s) do not say is taken from the package, then from the FMU's default experiment. *set* gives
    parameters by name, a number in the parameter's unit or a text with a unit; in a package the name begins with its
    component. *record* names variables to record instead of the outputs. The run may take *timeout* seconds of wall
    time; a *sandbox* denies the FMU the network and files. Waveforms are in the units that the FMU declares.

    Raises DseError with what is wrong with the file or the names, or if the run failed.
    """
    from dse.interchange import prepare_ssp

    file = Path(path)
    settings = {name: value if isinstance(value, str) else str(value).lower() for name, value in (set or {}).items()}
    prepared = prepare_ssp(
        file, stop=stop, step=step, settings=settings, record=record, tolerance=tolerance, timeout=timeout
    )
    run = simulate_package(prepared, sandbox=sandbox)
    if run.waveforms is None:
        raise fail(f"it failed to run: {run.problem}", Location(str(file)))
    if run.problem:
        warnings.warn(run.problem, stacklevel=2)
    return Waveforms(run.waveforms, prepared.units)
