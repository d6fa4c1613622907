"""Where good designs are dense, and bad ones are not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Brief
from dse.exploration.configuration_sampler import space_of
from dse.exploration.optimization.designs import Cases, Design
from dse.exploration.optimization.fitness import Worth
from dse.exploration.optimization.offspring import Breeding
from dse.exploration.optimization.optimizing_sampler import OptimizingSampler, Proposer

if TYPE_CHECKING:
    from optuna import Trial
    from optuna.distributions import BaseDistribution

_DIGITS = 9
"""Decimals of a place in a range: the last bits of another machine do not matter."""

_TRIES = 50
"""Proposals in a row that were made before, after which one is bred, and then as many after which there are no more."""

_GROWTH, _MOST = 32, 8
"""Without a *batch*, one design is asked for at a time for every 32 that are known, up to 8: what a few more tell then
changes little. On Hartmann's function, batches of 4 from the first on leave a quarter more regret after 60 runs."""

_ABSENT = ""


class Tpe(OptimizingSampler):
    """Tree-structured Parzen estimators (Bergstra et al. 2011; several objectives: Ozaki et al. 2022) over
    configurations and variables together: *first* designs fill the space, then come *batch* at a time; without that
    one at a time, and more once there are many.
    """

    name: ClassVar[str] = "tpe"
    package: ClassVar[str] = "optuna"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"evaluations": 30},
        {"evaluations": 20, "first": 4, "batch": 1, "draws": 2},
    )

    first: int = Field(default=10, ge=1)
    batch: int | None = Field(default=None, ge=1)

    def proposer(self, brief: Brief, cases: Cases) -> Proposer:
        """Optuna's."""
        return _Estimators(self, brief, cases)


class _Estimators:
    def __init__(self, sampler: Tpe, brief: Brief, cases: Cases) -> None:
        import numpy as np
        import optuna

        optuna.logging.set_verbosity(optuna.logging.WARNING)
        self._space, self._cases = space_of(brief), cases
        self._breeding = Breeding(self._space, len(cases.variables))
        self._first, self._batch, self._seed = sampler.first, sampler.batch, brief.seed
        self._known = 0
        self._random = np.random.default_rng(brief.seed)
        estimators = optuna.samplers.TPESampler(n_startup_trials=1, seed=brief.seed % (1 << 32), multivariate=True)
        self._study = optuna.create_study(directions=["minimize"] * len(brief.objectives), sampler=estimators)
        self._distributions = self._all()
        self._varied = {name: each for name, each in self._distributions.items() if not each.single()}
        self._asked: list[Design] = []
        self._trials: list[Trial] = []
        """What Optuna was asked for since it was told; it keeps away from what it is still to be told of."""

    def next(self) -> list[Design]:
        """The first designs; then what the estimators draw."""
        if not self._asked:
            self._asked = self._breeding.begin(self._first, self._seed, self._cases)
        else:
            drawn = (self._fresh() for _ in range(self._batch or min(max(1, self._known // _GROWTH), _MOST)))
            self._asked = [design for design in drawn if design is not None]
        return self._asked

    def tell(self, worth: Worth) -> None:
        """Add them to what the estimators know, in place of what these asked for, which was granted as far as it could
        be. The objectives of a design that is none to take are not looked at."""
        import numpy as np
        from optuna.trial import TrialState, create_trial

        for trial in self._trials:
            self._study.tell(trial, state=TrialState.FAIL)
        self._trials = []
        self._known += len(self._asked)
        sound = np.where(worth.violations[:, None] > 0, 0.0, worth.objectives).tolist()
        for design, values, violation in zip(self._asked, sound, worth.violations.tolist(), strict=True):
            params = self._parameters(design)
            distributions = {name: self._distributions[name] for name in params}
            constraints = {"requirements": violation}
            told = create_trial(values=values, params=params, distributions=distributions, constraints=constraints)
            self._study.add_trial(told)

    def _all(self) -> dict[str, BaseDistribution]:
        from optuna.distributions import CategoricalDistribution, FloatDistribution

        choices = {
            place: CategoricalDistribution([choice or _ABSENT for choice in known])
            for place, known in self._space.alternatives.items()
        }
        units = {str(number): FloatDistribution(0.0, 1.0) for number in range(len(self._cases.variables))}
        return {**choices, **units}

    def _parameters(self, design: Design) -> dict[str, Any]:
        """What it chooses or leaves out, and the variables it has; of what its architecture does not have, nothing."""
        made = design.architecture.choices
        known = self._space.alternatives.items()
        choices = {place: made.get(place, _ABSENT) for place, choices in known if place in made or None in choices}
        has = self._cases.has(design)
        return {**choices, **{str(number): share for number, share in enumerate(design.unit) if has[number]}}

    def _fresh(self) -> Design | None:
        """A design that was not asked for before; where the estimators have none any more, one that is drawn."""
        for _ in range(_TRIES):
            design = self._drawn()
            if self._cases.take(design):
                return design
        return next(iter(self._breeding.fresh(1, int(self._random.integers(1 << 31)), self._cases)), None)

    def _drawn(self) -> Design:
        self._trials.append(self._study.ask(self._varied))
        drawn = self._trials[-1].params
        unit = tuple(round(drawn[str(number)], _DIGITS) for number in range(len(self._cases.variables)))
        wishes = [
            (place, drawn.get(place) or None)
            for place, choices in self._space.alternatives.items()
            if drawn.get(place) or None in choices
        ]
        wishes = [wishes[index] for index in self._random.permutation(len(wishes)).tolist()]
        return Design(self._space.completed(wishes, int(self._random.integers(1 << 31))), unit)


SAMPLER = Tpe
