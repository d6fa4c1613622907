"""One configuration on its bench, with other parameter values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.described import si_unit
from dse.domain.study import Selection
from dse.testbench.plan import bench_study, with_settings
from dse.testbench.select import one

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.design import Configuration
    from dse.domain.study import Study
    from dse.loading.values import Raw
    from dse.testbench.plan import Plan


def single(
    bench: TestBench, configuration: str | None, settings: Mapping[str, Raw], *, check_step: bool = False
) -> Study:
    """The study of one run: of the configuration whose id starts so, or the first, with values as users write them.

    Raises DseError if there is no such configuration or parameter, or a value does not fit it.
    """
    chosen = one(bench.design, configuration)
    changed = with_settings(bench, settings, chosen)
    if check_step:
        changed = replace(changed, simulation=replace(changed.simulation, check_step=True))
    return bench_study(changed, Selection((chosen.id,)))


def selected(bench: TestBench, configuration: str | None) -> Study:
    """The study of the bench on the configuration whose id starts so, or on every valid one."""
    return bench_study(bench, None if configuration is None else Selection((one(bench.design, configuration).id,)))


def fused_libraries(planned: Plan) -> dict[str, Path]:
    """The fused library of each configuration, by its id."""
    return {name: bench.fused.path for name, bench in planned.prepared.items() if bench.fused is not None}


def write_package(study: Study, target: Path, *, version: int = 2) -> tuple[Configuration, int]:
    """Write the configuration of `single` as an SSP package; returns it and the number of its elements."""
    from dse.interchange.structure import ExperimentSettings
    from dse.interchange.writing.write import write_ssp
    from dse.testbench.prepare import prepare

    chosen = one(study.bench.design, *study.selection.ids)
    prepared = prepare(study.bench, [chosen], version=version)[chosen.id]
    simulation = prepared.simulation
    times = ExperimentSettings(0.0, simulation.stop, simulation.step, simulation.record_every)
    write_ssp(target, study.bench.name, prepared.system, times)
    return chosen, len(prepared.system.elements)


def recorded_units(planned: Plan) -> dict[str, str]:
    """The SI unit of each waveform that is kept of the study's runs."""
    from dse.domain.component import Kind
    from dse.domain.method import BONDS
    from dse.space.configurations.wiring import architecture_outputs
    from dse.testbench.prepare import parts_and_wiring

    bench = planned.study.bench
    kept: dict[str, str] = {}
    for prepared in planned.prepared.values():
        found = {f"{BONDS}.{bond.name}": "J" for bond in bench.simulation.method.bonds}
        parts, _ = parts_and_wiring(bench, prepared.configuration)
        for path, component in parts.items():
            for port in component.interface.ports:
                is_number = port.type.kind is Kind.REAL
                found[f"{path}.{port.name}"] = si_unit(port.type.unit.symbol) if is_number else ""
        behind = architecture_outputs(bench.design, prepared.configuration.choices)
        found |= {face: found[source] for face, source in behind.items()}
        kept |= {name: found[name] for name in prepared.kept}
    return kept
