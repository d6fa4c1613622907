"""Prepared benches whose systems are simulated by one library each, with the connections compiled in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from dse.domain.bench import Simulation
from dse.domain.method import PLAIN
from dse.domain.study import Study
from dse.errors import Problem, raise_if_any
from dse.fmu import Tell, Wanted, fuse_all
from dse.testbench.multi_bench import Prepared, singly, together


def fuse_benches(
    study: Study, benches: Mapping[str, Prepared], *, cache: Path | None = None, tell: Tell | None = None
) -> dict[str, Prepared]:
    """*benches* of *study*, by configuration, with a fused library each: the same results, faster.

    *tell* is told how many libraries are made.

    Raises one DseError naming all that cannot be fused, located in the bench and the components.
    """
    raise_if_any([*(p for bench in study.benches for p in _of_method(bench.simulation)), *_of_parts(study, benches)])
    names = [bench.name for bench in study.benches]
    each = {f"{n} on {on}": b for n, all_ in benches.items() for on, b in zip(names, singly(all_), strict=True)}
    wanted = {n: Wanted(b.system, b.recording.variables, b.simulation.method) for n, b in each.items()}
    libraries = fuse_all(wanted, cache=cache, tell=tell)
    fused = {name: replace(bench, fused=libraries[name]) for name, bench in each.items()}
    return {n: together([fused[f"{n} on {on}"] for on in names], names) for n in benches}


def _of_method(simulation: Simulation) -> Iterator[Problem]:
    method = simulation.method
    asked = {
        "coupling": method.coupling != PLAIN.coupling,
        "extrapolation": method.extrapolation != PLAIN.extrapolation or bool(method.extrapolations),
        "steps": bool(method.steps),
        "adaptive": method.adaptive is not None,
        "bonds": bool(method.bonds),
    }
    keys = [f"'{key}'" for key, is_asked in asked.items() if is_asked]
    if keys:
        what = f"{' and '.join(keys)} cannot be fused: a fused loop takes one fixed step, inputs held"
        yield Problem(what, simulation.where, "leave out --fuse, or these keys")


def _of_parts(study: Study, benches: Mapping[str, Prepared]) -> Iterator[Problem]:
    standing = [c for bench in benches.values() for c in bench.configuration.parts.values()]
    standing += [part.component for bench in study.benches for part in bench.test_components]
    for component in {component.name: component for component in standing}.values():
        if component.source is not None and component.source.is_finished:
            what = f"{component.name} is an existing FMU, which cannot be fused"
            yield Problem(what, component.where, "leave out --fuse, or choose configurations without it")
