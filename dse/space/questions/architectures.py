"""The valid configurations of a space for whoever explores it: counted, drawn and completed, without a list of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.random import Generator

from dse.domain.design import Configuration, DesignSpace
from dse.domain.sampler import Architecture
from dse.space.configurations.ids import Identifier
from dse.space.configurations.resolve import Resolver
from dse.space.decisions import alternatives
from dse.space.flat import Rows
from dse.space.methods.completion.completion import Completion, completion
from dse.space.methods.completion.preferences import Preference, PreferenceReader
from dse.space.methods.engine import Engine
from dse.space.methods.sampling.uniform import generator
from dse.space.methods.tally import Tally
from dse.space.questions.id_search import find


class SpaceArchitectures:
    """The configurations of *space* that *engine* knows. What has been given out is remembered, by its id."""

    def __init__(self, space: DesignSpace, engine: Engine) -> None:
        self._space = space
        self._engine = engine
        self._preferences = PreferenceReader(engine.flat)
        self._identifier = Identifier(engine.flat.variables)
        self._given: dict[str, Rows] = {}

    @cached_property
    def alternatives(self) -> Mapping[str, tuple[str | None, ...]]:
        """What can be chosen at each place, None for leaving it out, in the order of the file."""
        return alternatives(self._space)

    @cached_property
    def tally(self) -> Tally:
        """How many there are, and whether that is exact."""
        return self._engine.count()

    def count(self) -> int:
        """How many there are: exact, or an estimate where counting takes long; `tally` says which."""
        return self.tally.value

    def draw(self, number: int, seed: int) -> Sequence[Architecture]:
        """*number* of them, independently, each as likely as any other; nearly so where only populations are left.

        Raises DseError if there is none.
        """
        return self._made(self._engine.sample(number, seed))

    def stratified(self, number: int, seed: int) -> Sequence[Architecture]:
        """*number* of them in equal shares to the architectures. Raises DseError if there is none.

        The number is divided equally among the branches of the first decision that brings other decisions along, each
        share among those of the next such decision that there is then, and so on, in the order of the file; only
        branches that still have a valid configuration count, and what cannot be divided goes to branches at random.
        Within that, each configuration is as likely as any other.
        """
        random = generator(seed)
        rows = [self._completion.row(preferences, random) for preferences in self._shared({}, number, 0, random)]
        return self._made(np.array(rows, np.int16).reshape(number, len(self._engine.flat.variables)))

    def completed(self, preferences: Sequence[tuple[str, str | None]], seed: int) -> Architecture:
        """One that meets *preferences*, ``(place, choice)``, in their order, each if it can with those before it.

        None is for leaving the part out. What is left open is drawn, each possibility as likely as any other. A
        preference for what is no alternative cannot be met. Raises DseError if nothing is valid.
        """
        row = self._completion.row(self._preferences.read(preferences), generator(seed))
        return self._made(row[None, :])[0]

    def configuration(self, name: str) -> Configuration:
        """The one whose id is *name*: given out, or else looked for in the list. Raises DseError if there is none."""
        row = self._given.get(name)
        return find(self._space, self._engine, name) if row is None else next(self._resolver.configurations(row[None]))

    @cached_property
    def _resolver(self) -> Resolver:
        return Resolver(self._space)

    @cached_property
    def _completion(self) -> Completion:
        return completion(self._engine)

    @cached_property
    def _structural(self) -> tuple[int, ...]:
        """The decisions that bring others along, in the order of the file."""
        return tuple(sorted({variable.parent[0] for variable in self._engine.flat.variables if variable.parent}))

    def _shared(
        self, taken: Mapping[int, int], number: int, place: int, random: Generator
    ) -> Iterator[list[Preference]]:
        """What each of *number* configurations has to have that have *taken* values; decided up to *place*."""
        if place == len(self._structural):
            yield from [self._taking(taken)] * number
            return
        variable = self._structural[place]
        parent = self._engine.flat.variables[variable].parent
        if not number or (parent is not None and taken.get(parent[0]) != parent[1]):
            yield from self._shared(taken, number, place + 1, random) if number else ()
            return
        branches = [{**taken, variable: value} for value in range(len(self._engine.flat.variables[variable].values))]
        possible = [branch for branch in branches if self._is_possible(branch, variable, random)]
        shares = np.full(len(possible), number // len(possible))
        shares[random.permutation(len(possible))[: number % len(possible)]] += 1
        for branch, share in zip(possible, shares.tolist(), strict=True):
            yield from self._shared(branch, share, place + 1, random)

    def _is_possible(self, taken: Mapping[int, int], last: int, random: Generator) -> bool:
        return int(self._completion.row(self._taking(taken), random)[last]) == taken[last]

    def _taking(self, taken: Mapping[int, int]) -> list[Preference]:
        variables = self._engine.flat.variables
        return [
            Preference({number: np.eye(len(variables[number].values) + 1, dtype=np.int64)[value]}, 1)
            for number, value in taken.items()
        ]

    def _made(self, rows: Rows) -> list[Architecture]:
        ids = self._identifier.ids(rows)
        self._given.update(zip(ids, rows, strict=True))
        return [Architecture(name, self._engine.flat.choices(row)) for name, row in zip(ids, rows, strict=True)]
