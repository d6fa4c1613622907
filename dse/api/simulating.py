"""One configuration on its bench, with other parameter values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.described import si_unit
from dse.domain.study import Selection
from dse.testbench.select import one_configuration
from dse.testbench.study import bench_study, with_settings

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.design import Configuration
    from dse.domain.study import Study
    from dse.loading.values import Raw
    from dse.testbench.study import PreparedStudy


def single(
    bench: TestBench, configuration: str | None, settings: Mapping[str, Raw], *, check_step: bool = False
) -> Study:
    """The study of one run: of the configuration whose id starts so, or the first, with values as users write them.

    Raises DseError if there is no such configuration or parameter, or a value does not fit it.
    """
    chosen = one_configuration(bench.design, configuration)
    changed = with_settings(bench, settings, chosen)
    if check_step:
        changed = replace(changed, simulation=replace(changed.simulation, check_step=True))
    return bench_study(changed, Selection((chosen.id,)))


def selected(bench: TestBench, configuration: str | None) -> Study:
    """The study of the bench on the configuration whose id starts so, or on every valid one."""
    if configuration is None:
        return bench_study(bench)
    return bench_study(bench, Selection((one_configuration(bench.design, configuration).id,)))


def fused_libraries(planned: PreparedStudy) -> dict[str, Path]:
    """The fused library of each configuration, by its id."""
    return {name: bench.fused.path for name, bench in planned.benches.items() if bench.fused is not None}


def write_package(study: Study, target: Path, *, version: int = 2) -> tuple[Configuration, int]:
    """Write the configuration of `single` as an SSP package; returns it and the number of its elements."""
    from dse.interchange.structure import ExperimentSettings
    from dse.interchange.writing.write import write_ssp
    from dse.testbench.prepare import prepare_bench

    chosen = one_configuration(study.bench.design, *study.selection.ids)
    prepared = prepare_bench(study.bench, [chosen], version=version)[chosen.id]
    simulation = prepared.simulation
    times = ExperimentSettings(0.0, simulation.stop, simulation.step, simulation.record_every)
    write_ssp(target, study.bench.name, prepared.system, times)
    return chosen, len(prepared.system.elements)


def recorded_units(planned: PreparedStudy) -> dict[str, str]:
    """The SI unit of each waveform that is kept of the study's runs."""
    from dse.domain.component import Kind
    from dse.domain.method import BONDS
    from dse.testbench.wired import wire_bench

    kept: dict[str, str] = {}
    for prepared in planned.benches.values():
        wired = wire_bench(planned.study.bench, prepared.configuration)
        units = {name: si_unit(t.unit.symbol) if t.kind is Kind.REAL else "" for name, t in wired.signals.items()}
        units |= {f"{BONDS}.{bond.name}": "J" for bond in prepared.simulation.method.bonds}
        kept |= {name: units[name] for name in prepared.recording.kept}
    return kept
