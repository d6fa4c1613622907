"""The best cars of a part of ``electric_acc``, by trying everything: what an optimiser's answer is compared with.

``python benchmarks/reference_electric_acc.py out/electric_acc_subset [--workers 2] [--best 5]`` explores
``electric_acc_subset.pet.yaml`` into that folder, if it is not explored yet, and ranks its configurations.

A configuration with its gains is feasible if no requirement fails under any condition, and each was exercised under
one. A configuration is worth its cost and the energy of 200,000 km with the best of its feasible gains: the statically
cheapest use too much or fail, the thriftiest cost too much.
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
DISTANCE = 200_000e3  # m
PRICE = 0.30 / 3.6e6  # EUR/J


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("folder", type=Path)
    options.add_argument("--workers", type=int, default=2)
    options.add_argument("--best", type=int, default=5)
    given = options.parse_args()
    study = dse.open(Path(__file__).parents[1]).studies[str(STUDY)]
    results = study.explore(given.folder, workers=given.workers, progress=True)
    show(ranking(results.to_pandas(), costs(results)), given.best)


def costs(results: dse.Results) -> pd.Series:
    """What the parts of each configuration cost, EUR."""
    import pandas as pd

    entries = results.definition.configurations
    return pd.Series({entry.id: entry.totals["cost"].value for entry in entries}, name="cost")


def ranking(runs: pd.DataFrame, cost: pd.Series) -> pd.DataFrame:
    """A row for each configuration, the best first, infeasible ones last: `cost`, `consumption`, `worth`, gains."""
    verdicts = runs[[name for name in runs if name.endswith(".verdict")]]
    runs = runs.assign(failed=(verdicts == "fail").any(axis=1) | (runs["outcome"] != "done"))
    design = ["configuration", *GAINS]
    passed = verdicts.eq("pass").groupby([runs[name] for name in design]).any().all(axis=1)
    tried = runs.groupby(design).agg(failed=("failed", "any"), consumption=("consumption", "mean"))
    tried["feasible"] = passed & ~tried["failed"]
    tried["worth"] = tried.index.get_level_values("configuration").map(cost) + PRICE * DISTANCE * tried["consumption"]
    best = tried[tried["feasible"]].reset_index().sort_values(["worth", *design]).groupby("configuration").first()
    table = best.reindex(cost.index).assign(cost=cost)
    table["feasible gains"] = tried["feasible"].groupby("configuration").sum()
    return table.sort_values(["worth", "cost"])


def show(table: pd.DataFrame, best: int) -> None:
    feasible = table.dropna(subset=["worth"])
    print(f"{len(table)} configurations, {len(feasible)} feasible with some gains")
    print(f"worth of the feasible: {feasible['worth'].min():.0f} … {feasible['worth'].max():.0f} EUR")
    ranks = table["cost"].rank(method="min").astype(int)
    for number, (name, row) in enumerate(feasible.head(best + 1).iterrows(), 1):
        gains = ", ".join(f"{gain.split('.')[1]} {row[gain]:.3g}" for gain in GAINS)
        facts = f"cost {row['cost']:.0f}, rank {ranks[name]} by cost; {row['consumption'] / 36:.1f} kWh/100 km; {gains}"
        print(f"{number}. {name}: {row['worth']:.0f} EUR ({facts})")


if __name__ == "__main__":
    main()
