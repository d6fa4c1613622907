"""A design space and the questions to it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Literal, TypedDict, overload

from dse.api.showing.html import table
from dse.api.spaces.question import Question, ask
from dse.api.spaces.ranking import Ranking

if TYPE_CHECKING:
    from typing import Unpack

    import pandas as pd

    from dse.api.spaces.explaining import Explanation
    from dse.domain.design import Configuration, Constraint, DesignSpace
    from dse.space.engine import Engine
    from dse.space.flat import Rows
    from dse.space.questions.difference import Difference
    from dse.space.questions.impact import Impact
    from dse.space.questions.occurrence import Occurrence
    from dse.space.tally import Tally


class Narrowing(TypedDict, total=False):
    """What every question takes: *choose* says what is chosen where (``absent``: left out), *where* is a condition.

    *on* and *off* name constraint sets to switch.
    """

    choose: Mapping[str, str]
    where: str
    on: Sequence[str]
    off: Sequence[str]


class Design:
    """A design space; *space* is the noun behind it. What a question has to compile is kept for the next.

    Iterating gives every valid configuration, one at a time, in the order of the file.
    """

    def __init__(self, space: DesignSpace) -> None:
        self.space = space
        self._engines: dict[tuple[tuple[str, ...], tuple[str, ...]], Engine] = {}

    @property
    def name(self) -> str:
        """Its name."""
        return self.space.name

    @property
    def total(self) -> int:
        """The number of combinations, constraints aside."""
        from dse.space.enumerate import total

        return total(self.space)

    @overload
    def count(self, *, exact: Literal[True], seed: int = 0, **narrowing: Unpack[Narrowing]) -> int: ...
    @overload
    def count(self, *, exact: bool = False, seed: int = 0, **narrowing: Unpack[Narrowing]) -> int | Tally: ...
    def count(self, *, exact: bool = False, seed: int = 0, **narrowing: Unpack[Narrowing]) -> int | Tally:
        """How many configurations are valid; where counting takes long an estimate (`Tally`), unless *exact*."""
        engine = self._ask(**narrowing).engine
        if exact:
            return engine.exactly()
        tally = engine.count(seed)
        return tally.value if tally.exact else tally

    def list(self, limit: int | None = None, **narrowing: Unpack[Narrowing]) -> Sequence[Configuration]:
        """The valid configurations, in the order of the file; the first *limit* of them."""
        question = self._ask(**narrowing)
        return [*_resolved(question, first_rows(question.engine.blocks(), limit))]

    def sample(self, number: int, seed: int = 0, **narrowing: Unpack[Narrowing]) -> Sequence[Configuration]:
        """*number* configurations drawn at random, independently, each valid one as likely as any other."""
        question = self._ask(**narrowing)
        return [*_resolved(question, [question.engine.sample(number, seed)])]

    def configuration(self, name: str) -> Configuration:
        """The valid configuration whose id is *name* or starts with it."""
        from dse.space.enumerate import find

        return find(self.space, name)

    def best(
        self, minimize: str | None = None, *, maximize: str | None = None, n: int = 10, **narrowing: Unpack[Narrowing]
    ) -> Ranking:
        """The *n* best valid configurations under one objective, as ``sum(cost)``. Exact: there is none better."""
        from dse.errors import fail
        from dse.space.questions.optimum import aims, best_configurations

        wanted = aims([minimize] if minimize else [], [maximize] if maximize else [])
        if len(wanted) != 1:
            raise fail("one objective is needed", None, "give minimize or maximize; for several ask for 'pareto'")
        question = self._ask(**narrowing)
        return Ranking(question, wanted, best_configurations(question.space, question.engine, wanted[0], n))

    def pareto(
        self, minimize: str | Sequence[str] = (), maximize: str | Sequence[str] = (), **narrowing: Unpack[Narrowing]
    ) -> Ranking:
        """The configurations that no other one beats in every objective, one for each point of the complete set."""
        from dse.errors import fail
        from dse.space.questions.optimum import aims, pareto_set

        wanted = aims(_several(minimize), _several(maximize))
        if len(wanted) < 2:
            raise fail("two objectives or more are needed", None, "for one ask for 'best'")
        question = self._ask(**narrowing)
        return Ranking(question, wanted, pareto_set(question.space, question.engine, wanted))

    def explain(
        self, choose: Mapping[str, str], *, where: str | None = None, on: Sequence[str] = (), off: Sequence[str] = ()
    ) -> Explanation:
        """Why the configuration with these choices is excluded, and which valid one is nearest.

        With some of the choices only: whether they can be completed, and if not, which constraints stand in the way.
        """
        from dse.api.spaces.explaining import explain

        among: Narrowing = {"on": on, "off": off}
        return explain(self._ask(**(among if where is None else among | {"where": where})), _texts(choose))

    def conflict(self, **narrowing: Unpack[Narrowing]) -> tuple[Constraint, ...]:
        """Why nothing is left: a smallest set of constraints that cannot be met together.

        Empty if there are valid configurations, or if the choices exclude each other whatever the constraints.
        """
        from dse.space.questions.conflict import conflict

        engine = self._ask(**narrowing).engine
        return conflict(engine) if engine.is_empty() else ()

    def constraints(self, *names: str, seed: int = 0, **narrowing: Unpack[Narrowing]) -> tuple[Impact, ...]:
        """What each constraint does, or those called *names*: how many configurations it costs, is it redundant."""
        from dse.space.questions.impact import impact

        return impact(self._ask(**narrowing).engine, seed, names)

    def choices(self, *, seed: int = 0, **narrowing: Unpack[Narrowing]) -> tuple[Occurrence, ...]:
        """How often each alternative occurs among the valid configurations; which are dead, and which forced."""
        from dse.space.questions.occurrence import occurrences

        return tuple(occurrences(self._ask(**narrowing).engine, seed))

    def compare(self, other: Design, *, seed: int = 0) -> Difference:
        """What came and went from here to *other*, and how many configurations both have."""
        from dse.space.questions.difference import difference

        return difference(self.space, other.space, seed)

    def refine(self, keep: Mapping[str, Iterable[str]]) -> Design:
        """The design with only these alternatives at these places (``absent``: left out); ids stay what they are."""
        from dse.space.choosing import kept_choices
        from dse.space.refine import refine

        texts = [f"{path}={','.join(names)}" for path, names in keep.items()]
        return Design(refine(self.space, kept_choices(self.space, texts, (), {})))

    def to_pandas(self, limit: int | None = None, **narrowing: Unpack[Narrowing]) -> pd.DataFrame:
        """A row for each valid configuration, the first *limit*: its choices and the sums the constraints speak of.

        ``frame.attrs["units"]`` has the units of the sums. What is left out is missing (None).
        """
        from dse.api.showing.frames import configurations_frame

        question = self._ask(**narrowing)
        return configurations_frame(question.space, first_rows(question.engine.blocks(), limit))

    def __iter__(self) -> Iterator[Configuration]:
        question = self._ask()
        return _resolved(question, question.engine.blocks())

    def __repr__(self) -> str:
        return f"<Design {self.name}: {self.total:,} combinations, {len(self.space.constraints)} constraints>"

    def _repr_html_(self) -> str:
        from dse.space.decisions import decisions, flat

        alternatives: dict[str, dict[str, None]] = {}
        for decision in flat(decisions(self.space)):
            names = {branch.choice or "absent": None for branch in decision.branches}
            alternatives[decision.path] = alternatives.get(decision.path, {}) | names
        rows = [(path, ", ".join(names)) for path, names in alternatives.items()]
        return table(f"{self.name}: {self.total:,} combinations", ("place", "alternatives"), rows)

    def _ask(self, **narrowing: Unpack[Narrowing]) -> Question:
        on, off = tuple(narrowing.get("on", ())), tuple(narrowing.get("off", ()))
        if (on, off) not in self._engines:
            self._engines[on, off] = ask(self.space, on=on, off=off).engine
        texts = _texts(narrowing.get("choose", {}))
        return ask(self.space, texts, narrowing.get("where"), on, off, self._engines[on, off])


def _texts(choose: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(f"{path}={name}" for path, name in choose.items())


def _several(texts: str | Sequence[str]) -> Sequence[str]:
    return (texts,) if isinstance(texts, str) else texts


def _resolved(question: Question, blocks: Iterable[Rows]) -> Iterator[Configuration]:
    from dse.space.enumerate import of_blocks

    return of_blocks(question.space, blocks)


def first_rows(blocks: Iterator[Rows], limit: int | None) -> Iterator[Rows]:
    """The first *limit* rows of *blocks*."""
    missing = limit
    for rows in blocks:
        yield rows if missing is None else rows[:missing]
        if missing is not None:
            missing -= len(rows)
            if missing <= 0:
                return
