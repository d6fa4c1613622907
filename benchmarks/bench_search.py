"""Whether a search finds the best cars: optimisers on the part of ``electric_acc`` of which everything is known.

``python benchmarks/bench_search.py out/electric_acc_subset [--seeds 10] [--evaluations 2000]`` needs the folder that
``reference_electric_acc.py`` made. Nothing is simulated: what an optimiser asks for is looked up. The search is over
configurations and gains together, at four conditions; told is how many of the best five configurations it ran at their
best gains, and how many of its proposals were none of the space.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from reference_electric_acc import GAINS, STUDY, costs, ranking

import dse
from dse.domain.sampler import Brief, Candidate, Outcomes, Sampler
from dse.exploration.variables import conditions_of
from dse.loading import SAMPLERS
from dse.space import open_space
from dse.storage import StudyFolder

_BEST = 5


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("folder", type=Path)
    options.add_argument("--seeds", type=int, default=10)
    options.add_argument("--evaluations", type=int, default=2000)
    given = options.parse_args()
    study = dse.open(Path(__file__).parents[1]).studies[str(STUDY)].noun
    results = dse.results(given.folder)
    wanted = best_designs(ranking(results.to_pandas("si"), costs(results)))
    with StudyFolder.open(given.folder) as stored:
        known = Known(stored)
    for name, facts in (("nsga2", {"population": 32}), ("nsga2", {"population": 64}), ("tpe", {})):
        found = []
        for seed in range(given.seeds):
            sampler: Any = SAMPLERS.get(name).model_validate({**facts, "evaluations": given.evaluations})
            space = open_space(study.bench.design, where=study.selection.where).architectures()
            brief = Brief(
                study.variables, (), seed, known.outcomes([]), space, study.objectives, conditions_of(study.variables)
            )
            tried, wrong = search(sampler, brief, known)
            found.append((len(wanted & tried), wrong))
        all_five = sum(number == _BEST for number, _ in found)
        told = ", ".join(str(number) for number, _ in found)
        invalid = sum(number for _, number in found)
        print(f"{name} {facts}: all five in {all_five} of {given.seeds} seeds ({told}); {invalid} invalid")


def best_designs(table: pd.DataFrame) -> set[tuple[Any, ...]]:
    """The best five configurations with their best gains."""
    return {(name, *(round(row[gain], 9) for gain in GAINS)) for name, row in table.head(_BEST).iterrows()}


class Known:
    """Every run there is, by configuration and point."""

    def __init__(self, stored: StudyFolder) -> None:
        self._table = table = stored.table()
        names = table.header.variables
        columns = [np.asarray(table.points[name], dtype=np.float64) for name in names]
        self._rows = {
            (configuration, *(round(value, 9) for value in point)): row
            for row, (configuration, *point) in enumerate(zip(table.configurations, *columns, strict=True))
        }

    def __contains__(self, candidate: Candidate) -> bool:
        return self._key(candidate) in self._rows

    def outcomes(self, asked: Sequence[Candidate]) -> Outcomes:
        """What came of those *asked*."""
        rows = [self._rows[self._key(candidate)] for candidate in asked]
        return self._table.outcomes([int(self._table.numbers[row]) for row in rows])

    def _key(self, candidate: Candidate) -> tuple[Any, ...]:
        return candidate.configuration, *(round(value, 9) for value in candidate.point)


def search(sampler: Sampler, brief: Brief, known: Known) -> tuple[set[tuple[Any, ...]], int]:
    """The designs that *sampler* ran, by configuration and gains, and how many of its proposals were invalid."""
    at: Mapping[str, int] = {variable.name: place for place, variable in enumerate(brief.variables)}
    running = sampler.start(brief)
    tried: set[tuple[Any, ...]] = set()
    invalid = 0
    while asked := list(running.ask()):
        invalid += sum(candidate not in known for candidate in asked)
        tried |= {(c.configuration, *(round(c.point[at[gain]], 9) for gain in GAINS)) for c in asked}
        running.tell(known.outcomes(asked))
    return tried, invalid


if __name__ == "__main__":
    main()
