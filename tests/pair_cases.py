"""Two designs with their draws, and what must follow; the report's page is tested with the same file."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from definitions import metrics, stored_definition

from dse.domain.bench import Judgement, Verdict
from dse.domain.definition import (
    DefinedConfiguration,
    DefinedObjective,
    DefinedReplicates,
    DefinedRequirement,
    DefinedTotal,
    DefinedVariable,
    StudyDefinition,
)
from dse.domain.noise import DRAW, draw_of
from dse.domain.run import Outcome, Run, RunRequest
from dse.storage import Measures, RunTable, StudyFolder, block_of

PAIR_CASES: dict[str, Any] = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))


def defined_configurations(rows: Iterable[tuple[str, float, bool]]) -> tuple[DefinedConfiguration, ...]:
    """A configuration for each name, with its cost, and whether it is random."""
    return tuple(
        DefinedConfiguration(
            name,
            {"part": name},
            {"part": f"part_{name}"},
            {"cost": DefinedTotal(cost, "EUR")},
            {DRAW: 0.0} if random else {},
            streams=("part.seed",) if random else (),
        )
        for name, cost, random in rows
    )


def pair_study() -> StudyDefinition:
    """A gap of at least 2 m in 80 % of the draws; a gain is decided, a speed is imposed."""
    configurations = defined_configurations(PAIR_CASES["configurations"])
    return stored_definition(
        configurations,
        variables=(
            DefinedVariable("part.gain", "gain", "", 0.0, 1.0, 2, 0.0, values=(0.0, 1.0)),
            DefinedVariable(
                "world.speed", "speed", "m/s", 10.0, 30.0, 3, 10.0, values=(10.0, 20.0, 30.0), role="condition"
            ),
            DefinedVariable(DRAW, "", "", 0.0, 1e13, 0, 0.0, role="replicate"),
        ),
        metrics=metrics("gap"),
        requirements=(
            DefinedRequirement("R", "R", "gap", "", at_least=PAIR_CASES["at_least"], met_in=PAIR_CASES["met_in"]),
        ),
        objectives=(DefinedObjective("cost", is_total=True),),
        replicates=DefinedReplicates(5, 5, 0.95),
    )


def pair_table(folder: Path, rows: Iterable[list[Any]] = PAIR_CASES["runs"]) -> RunTable:
    """The runs *rows*, each [configuration, gain, speed, draw, gap], made in a new study *folder*."""
    study = pair_study()
    runs = []
    for number, (name, gain, speed, draw, gap) in enumerate(rows):
        point = {"part.gain": gain, "world.speed": speed, DRAW: draw_of(1, [speed], draw - 1) if draw else 0.0}
        margin = gap - PAIR_CASES["at_least"]
        judged = (Judgement("R", Verdict.PASS if margin >= 0 else Verdict.FAIL, margin),)
        runs.append(Run(RunRequest(number, name, point), Outcome.DONE, {"gap": gap}, judged))
    with StudyFolder.create(folder, study) as store:
        store.ask(0, [run.request for run in runs], len(runs))
        for run in runs:
            point = [[*run.request.point.values()]]
            store.add(run.request.configuration, point, block_of([run], Measures(("gap",), ("R",))))
        return store.table()
