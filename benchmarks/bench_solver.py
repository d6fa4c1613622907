"""Three E/E architectures that are too large for a decision diagram, beside CP-SAT models written by hand.

``python benchmarks/bench_solver.py``: seconds of processor time for each question, of `dse` with lowering and the tries
of its other engines, and of the plain model, both on one worker. Both import OR-tools, which the ratio includes, unless
`dse` answers without it. The answers must be equal. A fourth architecture shows where the diagram is faster.
"""

from __future__ import annotations

import random
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ortools.sat.python import cp_model

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Part
from dse.expression.parse import parse_expression
from dse.space import open_space, read_aims
from dse.space.methods.solver.model import cp_sat
from dse.units import parse_quantity

ANY = Interface("any", ())

Option = dict[str, int]
Rule = tuple[int, frozenset[int], int, frozenset[int]]
"""Where the first place takes one of the first values, the second must take one of the second."""


@dataclass(frozen=True)
class Architecture:
    """Places of *options* with whole properties, *rules* between two of them, and greatest sums of properties."""

    name: str
    options: Sequence[Sequence[Option]]
    rules: Sequence[Rule]
    most: dict[str, int]

    def space(self) -> DesignSpace:
        """The same as a design space."""

        def named(place: int, values: frozenset[int]) -> str:
            return f"p{place} in [{', '.join(f'p{place}_{value}' for value in sorted(values))}]"

        def part(place: int, value: int) -> Part:
            stated = {name: parse_quantity(f"{size} kg") for name, size in self.options[place][value].items()}
            return Part(Component(f"p{place}_{value}", ANY, properties=stated))

        places = {
            f"p{place}": Alternative(tuple(part(place, value) for value in range(len(options))))
            for place, options in enumerate(self.options)
        }
        rules = [f"{named(one, given)} implies {named(other, needed)}" for one, given, other, needed in self.rules]
        rules += [f"sum({name}) <= {most} kg" for name, most in self.most.items()]
        constraints = tuple(Constraint(f"c{n}", parse_expression(rule)) for n, rule in enumerate(rules))
        return DesignSpace(self.name, Compound(self.name, places), constraints)


def zones(places: int = 60, rules: int = 150) -> Architecture:
    """60 slots of zone controllers, each with 6 parts, and rules across all zones."""
    draw = random.Random(1)  # noqa: S311  # reproducible, not secret
    options = [[{"cost": draw.randint(1, 20), "mass": draw.randint(1, 12)} for _ in range(6)] for _ in range(places)]
    crossed = []
    for _ in range(rules):
        one, other = draw.sample(range(places), 2)
        crossed.append((one, frozenset(draw.sample(range(6), 2)), other, frozenset(draw.sample(range(6), 3))))
    return Architecture("zones", options, crossed, {"mass": 11 * places // 2})


def allocation(functions: int = 24, ecus: int = 6) -> Architecture:
    """24 functions on 6 ECUs of limited memory, redundant ones apart; each ECU that is used costs and weighs."""
    draw = random.Random(1)  # noqa: S311  # reproducible, not secret
    options: list[list[Option]] = []
    for _ in range(functions):
        load = draw.randint(5, 30)
        sizes = [(draw.randint(1, 20), draw.randint(1, 5)) for _ in range(ecus)]
        options.append([{f"load{e}": load, "cost": cost, "mass": mass} for e, (cost, mass) in enumerate(sizes)])
    options += [[{"cost": draw.randint(50, 150), "mass": draw.randint(5, 20)}, {"cost": 0}] for _ in range(ecus)]
    rules = [(f, frozenset({e}), functions + e, frozenset({0})) for f in range(functions) for e in range(ecus)]
    for _ in range(10):
        one, other = draw.sample(range(functions), 2)
        rules += [(one, frozenset({e}), other, frozenset(range(ecus)) - {e}) for e in range(ecus)]
    return Architecture("allocation", options, rules, {f"load{e}": draw.randint(80, 160) for e in range(ecus)})


def pins(places: int = 12) -> Architecture:
    """12 signals on 12 pins, no two on the same, said in pairs."""
    draw = random.Random(1)  # noqa: S311  # reproducible, not secret
    options = [
        [{"cost": draw.randint(1, 20), "mass": draw.randint(1, 12)} for _ in range(places)] for _ in range(places)
    ]
    rules = [
        (one, frozenset({value}), other, frozenset(range(places)) - {value})
        for one in range(places)
        for other in range(one)
        for value in range(places)
    ]
    return Architecture("pins", options, rules, {})


def harness() -> Architecture:
    """40 connectors in a row, of which each must fit the next: a diagram holds the rules."""
    draw = random.Random(1)  # noqa: S311  # reproducible, not secret
    options = [[{"cost": draw.randint(1, 20), "mass": draw.randint(1, 12)} for _ in range(6)] for _ in range(40)]
    rules = [
        (one, frozenset(draw.sample(range(6), 2)), one + 1, frozenset(draw.sample(range(6), 3)))
        for one in range(39)
        for _ in range(2)
    ]
    return Architecture("harness", options, rules, {"mass": 200})


class Plain:
    """The model that one writes by hand, solved with one worker."""

    def __init__(self, of: Architecture, switched: bool = False) -> None:
        self.of = of
        self.model = cp_model.CpModel()
        self.taken = [[self.model.new_bool_var("") for _ in options] for options in of.options]
        self.switches: list[Any] = []
        for values in self.taken:
            self.model.add_exactly_one(values)
        for one, given, other, needed in of.rules:
            self.switches.append(self.model.new_bool_var("") if switched else True)
            for value in given:
                clause = [~self.taken[one][value], *(self.taken[other][each] for each in needed)]
                self.model.add_bool_or(clause).only_enforce_if(self.switches[-1])
        for name, most in of.most.items():
            self.switches.append(self.model.new_bool_var("") if switched else True)
            self.model.add(self.sum(name) <= most).only_enforce_if(self.switches[-1])

    def sum(self, name: str) -> Any:
        terms = [
            (literal, option[name])
            for options, values in zip(self.of.options, self.taken, strict=True)
            for option, literal in zip(options, values, strict=True)
            if option.get(name)
        ]
        return cp_model.LinearExpr.weighted_sum([literal for literal, _ in terms], [size for _, size in terms])

    def solve(self) -> cp_model.CpSolver | None:
        self.solver = cp_model.CpSolver()
        self.solver.parameters.num_workers = 1
        self.solver.parameters.random_seed = 1
        self.solver.parameters.linearization_level = 2
        status = self.solver.solve(self.model)
        assert status in (cp_model.OPTIMAL, cp_model.FEASIBLE, cp_model.INFEASIBLE)
        return None if status == cp_model.INFEASIBLE else self.solver


def plain_best(of: Architecture, number: int) -> list[int]:
    plain = Plain(of)
    plain.model.minimize(plain.sum("cost"))
    found: list[int] = []
    while len(found) < number and (solver := plain.solve()) is not None:
        found.append(round(solver.objective_value))
        plain.model.add_bool_or([~one for values in plain.taken for one in values if solver.boolean_value(one)])
        plain.model.add(plain.sum("cost") >= found[-1])
    return found


def plain_pareto(of: Architecture) -> list[tuple[int, int]]:
    """The constraint method: the least cost, the least mass at that cost, then less mass than that."""
    plain, found = Plain(of), []
    while True:
        plain.model.minimize(plain.sum("cost"))
        if (solver := plain.solve()) is None:
            return found
        cost = round(solver.objective_value)
        one = plain.model.clone()
        one.add(plain.sum("cost") <= cost)
        one.minimize(plain.sum("mass"))
        whole, plain.model = plain.model, one
        mass = round(plain.solve().objective_value)  # type: ignore[union-attr]
        plain.model = whole
        found.append((cost, mass))
        plain.model.add(plain.sum("mass") <= mass - 1)


def plain_conflict(of: Architecture) -> int:
    plain = Plain(of, switched=True)
    number = {switch.index: switch for switch in plain.switches}

    def blamed(switches: Sequence[Any]) -> list[Any] | None:
        plain.model.clear_assumptions()
        plain.model.add_assumptions(switches)
        if plain.solve() is not None:
            return None
        return [number[index] for index in plain.solver.sufficient_assumptions_for_infeasibility()]

    suspects, needed = blamed(plain.switches) or [], []
    while suspects:
        tried = suspects.pop()
        left = blamed([*needed, *suspects])
        if left is None:
            needed.append(tried)
        else:
            suspects = [one for one in suspects if one.index in {each.index for each in left}]
    return len(needed)


def questions(of: Architecture) -> Iterator[tuple[str, Callable[[], Any], Callable[[], Any]]]:
    space = of.space()
    cost, mass = read_aims(["sum(cost)", "sum(mass)"], [])

    def values(number: int) -> list[int]:
        return [int(one.values[0]) for one in open_space(space).best(cost, number)]

    def front() -> list[tuple[int, int]]:
        return [
            (int(one), int(other)) for one, other in (each.values for each in open_space(space).pareto([cost, mass]))
        ]

    yield "first", lambda: open_space(space).engine.first() is not None, lambda: Plain(of).solve() is not None
    yield "best", lambda: values(1), lambda: plain_best(of, 1)
    yield "10 best", lambda: values(10), lambda: plain_best(of, 10)
    yield "Pareto", front, lambda: plain_pareto(of)
    best = values(1)[0]
    tight = replace(of, name=f"{of.name} below {best}", most={**of.most, "cost": best - 1})
    empty = tight.space()
    # Both are minimal; which of several is a matter of taste.
    yield "conflict", lambda: bool(open_space(empty).conflict()), lambda: bool(plain_conflict(tight))


def main() -> None:
    subprocess.run([sys.executable, "-c", "from ortools.sat.python import cp_model"], check=True)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    loading = used.ru_utime + used.ru_stime
    print(f"OR-tools is imported in {loading:.2f} s")
    print("| architecture | question | dse | plain CP-SAT | ratio with import |\n|---|---|--:|--:|--:|")
    for make in (zones, allocation, pins, harness):
        of = make()
        for name, ours, theirs in questions(of):
            cp_sat.cache_clear()
            seconds, answer = timed(ours)
            imported = loading if cp_sat.cache_info().currsize else 0.0
            plain, expected = timed(theirs)
            assert answer == expected, (of.name, name, answer, expected)
            ratio = (imported + seconds) / (loading + plain)
            print(f"| {of.name} | {name} | {seconds:.3f} | {plain:.3f} | {ratio:.2f} |", flush=True)


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    start = time.process_time()
    answer = work()
    return time.process_time() - start, answer


if __name__ == "__main__":
    main()
