"""The best cars of a part of ``electric_acc``, by trying everything: what an optimiser's answer is compared with.

``python benchmarks/reference_electric_acc.py out/electric_acc_subset [--workers 2] [--best 5]`` explores
``electric_acc_subset.pet.yaml`` into that folder, if it is not explored yet, and ranks its configurations.

A design (a configuration with gains) is feasible if no requirement fails at any condition and each is exercised at
one; it is worth its consumption at the condition where that is worst. A configuration is ranked by the best of its
feasible designs. Gains are values of a grid, so that an optimiser can be given the very same designs.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import dse

if TYPE_CHECKING:
    import pandas as pd

STUDY = Path(__file__).with_name("electric_acc_subset.pet.yaml")
GAINS = ("controller.kp_gap", "controller.kd_gap")


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("folder", type=Path)
    options.add_argument("--workers", type=int, default=2)
    options.add_argument("--best", type=int, default=5)
    given = options.parse_args()
    study = dse.open(Path(__file__).parents[1]).studies[str(STUDY)]
    results = study.explore(given.folder, workers=given.workers, progress=True)
    show(ranking(results.to_pandas("si"), costs(results)), given.best)


def costs(results: dse.Results) -> pd.Series:
    """What the parts of each configuration cost, EUR."""
    import pandas as pd

    entries = results.definition.configurations
    return pd.Series({entry.id: entry.totals["cost"].value for entry in entries}, name="cost")


def ranking(runs: pd.DataFrame, cost: pd.Series) -> pd.DataFrame:
    """A row for each configuration, the best first: `consumption` (J/m, NaN if infeasible), gains, `cost`, `feasible`.

    The last is the number of feasible designs.
    """
    verdicts = runs[[name for name in runs if name.endswith(".verdict")]]
    runs = runs.assign(failed=(verdicts == "fail").any(axis=1) | (runs["outcome"] != "done"))
    design = ["configuration", *GAINS]
    exercised = verdicts.eq("pass").groupby([runs[name] for name in design]).any().all(axis=1)
    tried = runs.groupby(design).agg(failed=("failed", "any"), consumption=("consumption", "max"))
    feasible = tried[exercised & ~tried["failed"]].reset_index().sort_values(["consumption", *design])
    best = feasible.groupby("configuration").first()
    table = best.reindex(cost.index)[["consumption", *GAINS]].assign(cost=cost)
    table["feasible"] = feasible.groupby("configuration").size().reindex(cost.index, fill_value=0)
    return table.sort_values(["consumption", "cost"])


def show(table: pd.DataFrame, best: int) -> None:
    feasible = table.dropna(subset=["consumption"])
    energy = feasible["consumption"] / 3600  # kWh/km
    print(f"{len(table)} configurations, {len(feasible)} feasible, {table['feasible'].sum()} feasible designs")
    print(f"consumption of the feasible: {energy.min():.4f} … {energy.max():.4f} kWh/km")
    ranks = table["cost"].rank(method="min").astype(int)
    for number, (name, row) in enumerate(feasible.head(best + 1).iterrows(), 1):
        gains = ", ".join(f"{gain.split('.')[1]} {row[gain]:.3g}" for gain in GAINS)
        facts = f"{gains}; {row['feasible']:.0f} feasible; cost {row['cost']:.0f} EUR, rank {ranks[name]}"
        print(f"{number}. {name}: {energy[name]:.4f} kWh/km ({facts})")


if __name__ == "__main__":
    main()
