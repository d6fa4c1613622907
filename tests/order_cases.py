"""Designs with verdicts of three severities, their order, and sentences on the first one.

The report's page is tested with the same file.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from definitions import metrics, stored_definition
from pair_cases import defined_configurations

from dse.domain.bench import Judgement, Verdict
from dse.domain.definition import (
    DefinedDesign,
    DefinedObjective,
    DefinedReplicates,
    DefinedRequirement,
    DefinedVariable,
    StudyDefinition,
)
from dse.domain.noise import DRAW, draw_of
from dse.domain.run import Outcome, Run, RunRequest
from dse.storage import Measures, RunTable, StudyFolder, block_of

ORDER_CASES: dict[str, Any] = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))


def order_study(case: dict[str, Any]) -> StudyDefinition:
    """The designs of a *case* under its objectives; with other choices, requirements or runs if it has some."""
    configurations = defined_configurations(row for row in ORDER_CASES["configurations"] if row[0] in case["designs"])
    choices = case.get("choices", {})
    configurations = tuple(replace(each, choices=choices.get(each.id, each.choices)) for each in configurations)
    places = dict.fromkeys(place for each in configurations for place in each.choices)
    requirements = (
        DefinedRequirement(name, title, metric, "", met_in=ORDER_CASES["met_in"], severity=severity, **bounds)
        for name, title, metric, bounds, severity in case.get("requirements", ORDER_CASES["requirements"])
    )
    return stored_definition(
        configurations,
        design=DefinedDesign("design", places=tuple(places)),
        variables=(
            DefinedVariable("world.speed", "speed", "m/s", 10.0, 20.0, 2, 10.0, values=(10.0, 20.0), role="condition"),
            DefinedVariable(DRAW, "", "", 0.0, 1e13, 0, 0.0, role="replicate"),
        ),
        metrics=metrics("gap", "peak"),
        requirements=tuple(requirements),
        objectives=tuple(
            DefinedObjective(name, maximize=maximize, is_total=name == "cost") for name, maximize in case["objectives"]
        ),
        replicates=DefinedReplicates(5, 5, 0.95),
    )


def order_table(folder: Path, case: dict[str, Any]) -> RunTable:
    """The runs of the designs of a *case*, made in a new study *folder*."""
    study, runs = order_study(case), []
    rows = [row for row in case.get("runs", ORDER_CASES["runs"]) if row[0] in case["designs"]]
    for number, (name, speed, draw, gap, peak) in enumerate(rows):
        values = {"gap": gap, "peak": math.nan if peak is None else peak}
        judged = []
        for requirement in study.requirements:
            low, high = requirement.at_least, requirement.at_most
            value = values[requirement.metric]
            margin = value - low if low is not None else (high or 0.0) - value
            verdict = Verdict.NOT_EXERCISED if math.isnan(value) else Verdict.PASS if margin >= 0 else Verdict.FAIL
            judged.append(Judgement(requirement.name, verdict, margin))
        point = {"world.speed": speed, DRAW: draw_of(1, [speed], draw - 1) if draw else 0.0}
        runs.append(Run(RunRequest(number, name, point), Outcome.DONE, values, tuple(judged)))
    with StudyFolder.create(folder, study) as store:
        names = tuple(each.name for each in study.requirements)
        store.ask(0, [run.request for run in runs], len(rows))
        for run in runs:
            block = block_of([run], Measures(("gap", "peak"), names))
            store.add(run.request.configuration, [[*run.request.point.values()]], block)
        return store.table()
