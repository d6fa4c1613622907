"""A design space opened for questions: what others call. Each answer imports what it needs when it is asked for."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, BinaryIO

from dse.domain.design import Configuration, Constraint, DesignSpace
from dse.domain.expression import Expression
from dse.errors import DseError, fail
from dse.space.decisions import Choices, combinations
from dse.space.flat import Rows
from dse.space.lowering import selecting
from dse.space.methods.engine import Engine
from dse.space.methods.tally import Tally
from dse.space.restriction.choices import ABSENT_NAME, choosing, completed, read_choices
from dse.space.restriction.constraint_sets import switched

if TYPE_CHECKING:
    from pathlib import Path

    from dse.space.output.sheet import Sheet
    from dse.space.questions.architectures import SpaceArchitectures
    from dse.space.questions.dealership import Dealership
    from dse.space.questions.difference import Difference
    from dse.space.questions.explain import Broken, Explanation
    from dse.space.questions.impact import Impact
    from dse.space.questions.occurrence import Occurrence
    from dse.space.questions.optimum import Aim, Ranked
    from dse.space.questions.picking import Picking
    from dse.units import Unit


def open_space(
    space: DesignSpace,
    choose: Iterable[str] = (),
    where: Expression | None = None,
    on: Collection[str] = (),
    off: Collection[str] = (),
) -> OpenedSpace:
    """*space* with sets of constraints switched, narrowed to texts ``place=choice`` and to *where*.

    Raises DseError with all problems in the choices, or if a constraint cannot be understood.
    """
    space = switched(space, on, off)
    switches = (*(("--on", name) for name in on), *(("--off", name) for name in off))
    engine = Engine.of(space)
    whole = OpenedSpace(space, engine, engine, {}, None, tuple(word for pair in switches for word in pair))
    return whole.part(choose, where)


@dataclass(frozen=True, slots=True, eq=False)
class OpenedSpace:
    """The configurations of *space* that have what is *chosen* and meet *where*.

    What is compiled for an answer is kept for the next; answers do not depend on what was asked before.
    """

    space: DesignSpace
    engine: Engine
    whole: Engine
    """Answers about all of *space*."""
    chosen: Choices
    where: Expression | None
    options: tuple[str, ...] = ()
    """What is typed to ask about the same, for a hint that asks another question."""

    def part(self, choose: Iterable[str] = (), where: Expression | None = None) -> OpenedSpace:
        """The part of all of *space* that has texts ``place=choice`` and meets *where*. Raises DseError."""
        texts = tuple(choose)
        chosen = read_choices(self.space, texts)
        rules = (*choosing(self.whole.flat, chosen), *(selecting(self.space, where) if where else ()))
        typed = [("--choose", text) for text in texts] + ([("--where", where.text)] if where else [])
        return replace(
            self,
            engine=self.whole.having(*rules) if rules else self.whole,
            chosen=chosen,
            where=where,
            options=(*(word for pair in typed for word in pair), *self.options),
        )

    def title(self) -> str:
        """What is asked about, for a person: ``acc_vehicle with sensor=radar where cost <= 9000 EUR``."""
        given = f" with {', '.join(f'{path}={choice}' for path, choice in self.chosen.items())}" if self.chosen else ""
        return f"{self.space.name}{given}{f' where {self.where.text}' if self.where else ''}"

    def data(self) -> dict[str, object]:
        """The same for a program."""
        where = self.where.text if self.where else None
        return {"design": self.space.name, "chosen": dict(self.chosen), "where": where}

    def nothing(self) -> DseError:
        """The problem that no configuration is left."""
        asked = self.title().removeprefix(self.space.name)
        what = f"'{self.space.name}' has no valid configuration{asked}"
        command = shlex.join(["dse", "space", "conflict", self.space.name, *self.options])
        return fail(what, None, f"ask which constraints conflict: {command}")

    @property
    def total(self) -> int:
        """The number of combinations of all of *space*, constraints aside; nothing is enumerated."""
        return combinations(self.space)

    def count(self, seed: int = 0, *, exact: bool = False) -> Tally:
        """How many are valid; where counting takes long an estimate, unless *exact*. Raises DseError without either."""
        return Tally(self.engine.exactly()) if exact else self.engine.count(seed)

    def count_unconstrained(self, seed: int = 0) -> Tally:
        """How many there are without the constraints."""
        return self.engine.only(()).count(seed)

    def is_empty(self) -> bool:
        """Whether nothing is valid. Raises DseError if that takes too long to find out."""
        return self.engine.is_empty()

    def rows(self, limit: int | None = None) -> Rows:
        """The first *limit* valid ones as rows, in the order of `configurations`."""
        return self.engine.rows(limit)

    def blocks(self, limit: int | None = None) -> Iterator[Rows]:
        """The same in blocks."""
        return self.engine.blocks(limit)

    def draw(self, number: int, seed: int = 0) -> Rows:
        """*number* valid ones as rows, drawn at random, each as likely as any other. Raises DseError.

        Nearly so, and not quite independently, unless `draws_uniformly`.
        """
        return self.engine.sample(number, seed)

    @property
    def draws_uniformly(self) -> bool:
        """Whether each valid one is exactly as likely as any other to be drawn."""
        return self.engine.diagram is not None or self.engine.clausal.is_exact

    def resolved(self, blocks: Iterable[Rows]) -> Iterator[Configuration]:
        """The configurations of blocks of rows. Raises DseError if connections cannot be resolved."""
        from dse.space.configurations.resolve import Resolver

        resolver = Resolver(self.space)
        for rows in blocks:
            yield from resolver.configurations(rows)

    def configurations(self, limit: int | None = None) -> Iterator[Configuration]:
        """The first *limit* valid configurations, one at a time, in the order of the file.

        That is: parts are nested loops, the last part is the fastest, and an optional part is there before it is left
        out. Each was checked against every constraint in exact arithmetic. A space whose decisions are too connected
        to be compiled in that order is listed in another, always the same. Raises DseError if connections cannot be
        resolved.
        """
        return self.resolved(self.blocks(limit))

    def configuration(self, name: str) -> Configuration:
        """The valid configuration whose id is *name* or starts with it. Raises DseError if that is not one."""
        from dse.space.questions.id_search import find

        return find(self.space, self.engine, name)

    def described(self, choose: Iterable[str]) -> Configuration:
        """The configuration of all of *space* that texts ``place=choice`` decide, whether it is valid or not.

        Raises DseError if they leave a decision open.
        """
        from dse.space.configurations.resolve import resolve

        chosen = read_choices(self.space, choose)
        return resolve(self.space, {path: name for path, name in chosen.items() if name != ABSENT_NAME})

    def of_choices(self, choices: Choices) -> Configuration | None:
        """The configuration of all of *space* with exactly these choices, valid or not; None if they are none of it."""
        from dse.space.configurations.resolve import resolve
        from dse.space.decisions import alternatives

        known = alternatives(self.space)
        fits = all(choice in known.get(path, ()) for path, choice in choices.items())
        return resolve(self.space, choices) if fits else None

    def best(self, aim: Aim, number: int, tell: Callable[[str], None] | None = None) -> tuple[Ranked, ...]:
        """The *number* best under *aim*, see `dse.space.questions.optimum`."""
        from dse.space.questions.optimum import best_configurations

        return best_configurations(self.space, self.engine, aim, number, tell)

    def pareto(self, aims: Sequence[Aim]) -> tuple[Ranked, ...]:
        """One for each point of the complete Pareto set of *aims*, see `dse.space.questions.optimum`."""
        from dse.space.questions.optimum import pareto_set

        return pareto_set(self.space, self.engine, aims)

    def unit_of(self, aim: Aim) -> Unit:
        """The unit to show the values of *aim* in."""
        from dse.space.questions.optimum import display_unit

        return display_unit(self.space, aim)

    def broken(self, choices: Choices) -> tuple[Broken, ...]:
        """The constraints that complete *choices* break, in the order of the file, and what they look at."""
        from dse.space.questions.explain import broken_by

        return broken_by(self.space, choices)

    def explain(self, choose: Iterable[str]) -> Explanation:
        """Why the configuration with texts ``place=choice`` is excluded, and which valid one is nearest.

        With some of the choices only: whether they can be completed, and if not, which constraints stand in the way.
        """
        from dse.space.questions.explain import Explanation
        from dse.space.questions.nearest import nearest

        texts = tuple(choose)
        chosen = read_choices(self.space, texts)
        choices = completed(self.space, chosen)
        if choices is not None:
            broken = self.broken(choices)
            # A configuration is compared with all others.
            near = nearest(self.engine, choices) if broken and not self.is_empty() else None
            return Explanation(chosen, True, choices, broken, near)
        part = self.part(texts, self.where)
        row = part.engine.first()
        if row is None:
            return Explanation(chosen, False, None, conflict=part.conflict())
        return Explanation(chosen, False, part.engine.flat.choices(row))

    def conflict(self) -> tuple[Constraint, ...]:
        """Why nothing is left: a smallest set of constraints that cannot be met together.

        None of them if the choices exclude each other whatever the constraints. Raises DseError if something is left.
        """
        from dse.space.questions.conflict import conflict

        return conflict(self.engine)

    def impact(self, names: Iterable[str] = (), seed: int = 0) -> tuple[Impact, ...]:
        """What each constraint does, or those called *names*. Raises DseError for an unknown name."""
        from dse.space.questions.impact import impact

        return impact(self.engine, seed, names)

    def funnel(self, seed: int = 0) -> tuple[Tally, ...]:
        """What each constraint and those before it leave, in the order of the file. DseError where that takes long."""
        from dse.space.questions.impact import funnel

        return funnel(self.engine, seed)

    def occurrences(self, seed: int = 0) -> tuple[Occurrence, ...]:
        """How often each alternative occurs among the valid ones. Raises DseError if there is none."""
        from dse.space.questions.occurrence import occurrences

        return occurrences(self.engine, seed)

    def difference(self, other: OpenedSpace, seed: int = 0) -> Difference:
        """What came and went from here to *other*, and how many configurations both have."""
        from dse.space.questions.difference import difference

        return difference(self.whole, other.whole, seed)

    def refined(self, keep: Iterable[str], drop: Iterable[str] = (), ids: Iterable[str] | None = None) -> DesignSpace:
        """*space* with fewer choices: only those of texts ``place=a,b`` to keep, without those to drop.

        With *ids* only what occurs in these configurations. Ids stay what they are. Raises DseError if nothing is left.
        """
        from dse.space.restriction.choices import kept_choices
        from dse.space.restriction.refine import refine, spanned

        within = {} if ids is None else spanned(self.space, [self.configuration(name).choices for name in ids])
        return refine(self.space, kept_choices(self.space, keep, drop, within))

    def picking(self) -> Picking:
        """To choose one configuration step by step."""
        from dse.space.output.sums import property_sums
        from dse.space.questions.picking import Picking

        return Picking(self.engine, property_sums(self.space))

    def dealership(self) -> Dealership:
        """To choose with all that follows told at each step. Raises DseError where *space* is too large for that."""
        from dse.space.questions.dealership import Dealership

        return Dealership(self.space, self.engine)

    def architectures(self) -> SpaceArchitectures:
        """The valid configurations for a sampler that chooses them itself."""
        from dse.space.questions.architectures import SpaceArchitectures

        return SpaceArchitectures(self.space, self.engine)

    def sheet(self) -> Sheet:
        """To show blocks of rows as a table."""
        from dse.space.output.sheet import Sheet

        return Sheet(self.space)

    def save(self, blocks: Iterable[Rows], target: Path) -> int:
        """Write blocks of rows to a file in the format of its suffix; returns how many there were. Raises DseError."""
        from dse.space.output.export import save

        return save(self.sheet(), blocks, target)

    def write(self, form: str, blocks: Iterable[Rows], stream: BinaryIO) -> None:
        """Write blocks of rows in a format: csv, json, jsonl or parquet."""
        from dse.space.output.export import WRITERS

        WRITERS[form](self.sheet(), blocks, stream)

    def picture(self, configuration: Configuration | None, note: str, below: str | None = None) -> str:
        """All of *space*, or what stands at and *below* a place, as SVG, with a configuration marked in it."""
        from dse.pictures import draw_tree
        from dse.space.output.tree import part_below, tree_of
        from dse.space.questions.occurrence import dead_branches

        tree = tree_of(self.space, configuration.choices if configuration else None, dead_branches(self.whole))
        return draw_tree(part_below(tree, below) if below else tree, self.space.title or self.space.name, note)
