"""Benches whose runs are to have error bars: what is compared for them follows from how exact the FMUs are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from dse.domain.component import Component
from dse.domain.facts import Lever
from dse.testbench.numerics import Say, exchange_of, numerics_of
from dse.testbench.prepared_bench import PreparedBench
from dse.testbench.variations import checks_of


def with_error_bars(
    prepared: PreparedBench,
    parts: Mapping[str, Component],
    *,
    cache: Path | None = None,
    say: Say = lambda _: None,
    sandboxed: bool = False,
) -> PreparedBench:
    """*prepared* with what its error bars are made of, if it is to have some; *parts* are the components by element.

    FMUs of which it is not known how exact they are are tried, *sandboxed* or not; *say* is told of each.
    """
    if not prepared.simulation.check_step:
        return prepared
    system, simulation = prepared.system, prepared.simulation
    numerics = numerics_of(system, simulation, parts, cache=cache, say=say, sandboxed=sandboxed)
    asked = [e for e in system.elements if Lever.EXCHANGE in numerics[e.name].changes]
    exchanges = {e.name: other for e in asked if (other := exchange_of(e.model, cache=cache)) is not None}
    sources = dict(zip(prepared.recording.columns, prepared.recording.variables, strict=True))
    checks = checks_of(system, simulation, numerics, exchanges, prepared.facts, prepared.program, sources)
    return replace(prepared, checks=checks)
