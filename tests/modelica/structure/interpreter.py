"""A sorted model executed in Python, as a reader of `Solved` would: an oracle that shares nothing with the C code."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from scipy.integrate import solve_ivp

from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.flat_model import Equation, FlatModel, Relation, Role, ScalarType, Variable
from dse.modelica.solved_model import Activation, EventBlock, Explicit, Solved, System, When


class RunError(Exception):
    """What a run ends with when a system cannot be solved."""


def symbol(name: str, order: int = 0) -> Symbol:
    return Symbol(name, order)


class Building:
    """A flat model put together by hand."""

    def __init__(self, name: str = "Hand") -> None:
        self.graph = Graph()
        self.name = name
        self.variables: dict[str, Variable] = {}
        self.equations: list[Equation] = []
        self.initial: list[Equation] = []
        self.relations: list[Relation] = []
        self.more: dict[str, object] = {}
        self.time = self.graph.symbol(Symbol(referent=Referent.TIME))

    def parameter(self, name: str, value: float, **more: object) -> Expression:
        return self._declare(name, Role.PARAMETER, {"start": value, "is_fixed": True, **more})

    def input(self, name: str, start: float = 0.0, **more: object) -> Expression:
        return self._declare(name, Role.INPUT, {"start": start, **more})

    def real(self, name: str, **more: object) -> Expression:
        return self._declare(name, Role.CONTINUOUS, more)

    def reals(self, names: str, **more: object) -> list[Expression]:
        return [self.real(name, **more) for name in names.split()]

    def discrete(self, name: str, **more: object) -> Expression:
        return self._declare(name, Role.DISCRETE, more)

    def _declare(self, name: str, role: Role, more: dict[str, object]) -> Expression:
        for key in ("start", "binding", "minimum", "maximum"):
            if isinstance(more.get(key), (int, float)):
                more[key] = self.graph.constant(float(more[key]))  # type: ignore[arg-type]  # a number, as tested
        kind = more.pop("kind", ScalarType.REAL)
        self.variables[name] = Variable(name, kind, role, **more)  # type: ignore[arg-type]  # tests name the fields
        return self.graph.variable(name)

    def der(self, name: str, order: int = 1) -> Expression:
        return self.graph.variable(name, order)

    def held(self, number: int) -> Expression:
        return self.graph.symbol(Symbol(str(number), referent=Referent.HELD))

    def equal(self, left: Expression, right: Expression | float) -> None:
        self.equations.append(Equation(left - right))

    def at_start(self, left: Expression, right: Expression | float) -> None:
        self.initial.append(Equation(left - right))

    def flat(self) -> FlatModel:
        return FlatModel(
            self.name,
            self.graph,
            self.variables,
            tuple(self.equations),
            initial_equations=tuple(self.initial),
            relations=tuple(self.relations),
            **self.more,  # type: ignore[arg-type]  # tests name the fields
        )


class Machine:
    """One instance of a sorted model."""

    def __init__(self, solved: Solved, inputs: Callable[[str, float], float] | None = None) -> None:
        self.solved = solved
        self.inputs = inputs
        self.values: dict[Symbol, float] = {}
        self.pre: dict[str, float] = {}
        self.held = [0.0] * len(solved.flat.relations)
        self.is_true: dict[tuple[int, int], bool] = {}
        self.is_active: dict[int, bool] = {}
        self.time = 0.0
        self.ticks = [0] * len(solved.flat.clocks)
        self.ticking: frozenset[int] = frozenset()
        self.was_true: dict[tuple[int, int], bool] = {}
        self.is_initial = False
        for variable in solved.flat.variables.values():
            if variable.role in (Role.PARAMETER, Role.INPUT):
                given = variable.start if variable.binding is None else variable.binding
                is_number = given is not None and given.is_constant
                self.values[symbol(variable.name)] = given.value if given is not None and is_number else 0.0

    def of(self, one: Symbol) -> float:
        match one.referent:
            case Referent.TIME:
                return self.time
            case Referent.INITIAL:
                return float(self.is_initial)
            case Referent.HELD:
                return self.held[int(one.name)]
            case Referent.PRE:
                return self.pre[one.name]
        if self.inputs is not None and self.solved.flat.variables[one.name].role is Role.INPUT:
            return self.inputs(one.name, self.time)
        return self.values[one]

    def value(self, name: str, order: int = 0) -> float:
        """Value of any variable, eliminated ones too."""
        if name in self.solved.aliases:
            kept, sign = self.solved.aliases[name]
            return sign * self.of(kept)
        return self.of(symbol(name, order))

    def run(self, blocks: Iterable[EventBlock]) -> None:
        for block in blocks:
            match block:
                case Explicit():
                    self.values[block.unknown] = evaluate((block.value,), self.of)[0]
                case System():
                    self._solve(block)
                case When():
                    self._choose(block)
                case Activation():
                    self._activate(block.trigger)

    def _choose(self, block: When) -> None:
        for trigger, value in block.branches:
            if trigger is None or self.is_active[trigger]:
                self.values[block.target] = evaluate((value,), self.of)[0]
                return
        self.values[block.target] = self.pre[block.target.name]

    def _activate(self, number: int) -> None:
        trigger = self.solved.flat.triggers[number]
        is_active = self.is_initial and trigger.at_start
        is_active = is_active or any(clock in self.ticking for clock in trigger.clocks)
        for place, condition in enumerate(trigger.conditions):
            is_true = evaluate((condition,), self.of)[0] != 0
            if not self.is_initial:
                is_active = is_active or (is_true and not self.was_true.get((number, place), False))
            self.is_true[number, place] = is_true
        self.is_active[number] = is_active

    def _solve(self, system: System) -> None:
        size = len(system.unknowns)
        x = np.array([self.values.get(unknown, 0.0) for unknown in system.unknowns])

        def residuals(at: np.ndarray) -> np.ndarray:
            self.values.update(zip(system.unknowns, map(float, at), strict=True))
            self.run(system.inner)
            return np.array(evaluate(system.residuals, self.of))

        if system.is_linear:
            x = np.zeros(size)
        f = residuals(x)
        for _ in range(200):
            entries = evaluate([entry for row in system.jacobian for entry in row], self.of)
            matrix = np.array(entries).reshape(size, size)
            scale = np.abs(matrix).max(axis=1)
            if not (np.isfinite(matrix).all() and np.isfinite(f).all() and scale.all()):
                raise RunError(f"singular: {system.unknowns}")
            scaled = matrix / scale[:, None]
            if np.linalg.cond(scaled) > 1e14:
                raise RunError(f"singular: {system.unknowns}")
            step = np.linalg.solve(scaled, -f / scale)
            if system.is_linear:
                residuals(x + step)
                return
            if np.all(np.abs(step) <= 1e-12 * np.maximum(np.abs(x), 1e-3)):
                residuals(x + step)
                return
            damping = 1.0
            while True:
                trial = residuals(x + damping * step)
                if np.isfinite(trial).all() and np.linalg.norm(trial / scale) <= (1 - damping / 4) * np.linalg.norm(
                    f / scale
                ):
                    break
                damping /= 2
                if damping < 1e-6:
                    break
            if damping < 1e-6:
                if np.linalg.norm(f / scale) < 1e-12:
                    residuals(x)
                    return
                raise RunError(f"no convergence: {system.unknowns}")
            x, f = x + damping * step, trial
        raise RunError(f"no convergence: {system.unknowns}")

    def start(self) -> None:
        """Initialization: parameters, guesses, then the initial blocks until no relation changes."""
        self.was_true = {}
        self.run(self.solved.parameters)
        for one in self._derivative_symbols():
            self.values[one] = 0.0
        self.run(self.solved.guesses)
        self.is_initial = True
        self._keep_pre()
        for _ in range(100):
            self.run(self.solved.initial)
            self.was_true = dict(self.is_true)
            if not self._changed():
                break
            self._keep_pre()
        else:
            raise RunError("the initialization does not come to rest")
        self.is_initial = False
        self.run(self.solved.parameters)
        self._keep_pre()
        self.event()

    def event(self) -> None:
        """One event iteration."""
        self._keep_pre()
        for _ in range(100):
            self.was_true = dict(self.is_true)
            self._changed()
            self.run(self.solved.event)
            ticked, self.ticking = self.ticking, frozenset()
            is_reinitialized = self._reinitialize()
            before = dict(self.pre)
            self._keep_pre()
            if (
                before == self.pre
                and not self._changed()
                and self.was_true == self.is_true
                and not (is_reinitialized or ticked)
            ):
                return
        raise RunError("the event iteration does not come to rest")

    def _reinitialize(self) -> bool:
        written: dict[str, float] = {}
        for one in self.solved.flat.reinitializations:
            if self.is_active.get(one.trigger) and one.state not in written:
                written[one.state] = evaluate((one.value,), self.of)[0]
        for name, value in written.items():
            self.values[symbol(name)] = value
        if written:
            self.run(self.solved.derivatives)
        return bool(written)

    def _changed(self) -> bool:
        new = evaluate([one.truth for one in self.solved.flat.relations], self.of)
        is_changed, self.held = new != self.held, new
        return is_changed

    def _keep_pre(self) -> None:
        for name, variable in self.solved.flat.variables.items():
            if variable.role is Role.DISCRETE or symbol(name) in self.solved.states:
                self.pre[name] = self.values[symbol(name)]

    def _derivative_symbols(self) -> list[Symbol]:
        found: dict[Symbol, None] = {}
        for block in (*self.solved.initial, *self.solved.derivatives, *self.solved.outputs):
            for one in gives(block):
                found[one] = None
        return list(found)

    def derivatives(self, time: float, states: Sequence[float]) -> list[float]:
        self.time = float(time)
        self.values.update(zip(self.solved.states, map(float, states), strict=False))
        self.run(self.solved.derivatives)
        return [self.of(one.derivative) for one in self.solved.states]

    def simulate(self, stop: float, names: Sequence[str], points: int = 21, tolerance: float = 1e-10) -> np.ndarray:
        """Values of *names* at evenly spaced points of time, one row a point; events are located."""
        self.start()
        times = np.linspace(0.0, stop, points)
        table = []
        for target in times:
            self.advance(float(target), tolerance)
            table.append([self.value(name) for name in names])
        return np.array(table)

    def advance(self, target: float, tolerance: float = 1e-10) -> None:
        """Integrate up to *target*, then compute everything."""
        self._tick()
        while self.time < target:
            clocks = self.solved.flat.clocks
            nexts = [float(c.phase + self.ticks[k] * c.period) for k, c in enumerate(clocks)]
            self._advance(min([target, *nexts]), tolerance)
            self._tick()
        self.derivatives(self.time, [self.of(one) for one in self.solved.states])
        self.run(self.solved.outputs)

    def _tick(self) -> None:
        clocks = self.solved.flat.clocks
        due = [k for k, c in enumerate(clocks) if float(c.phase + self.ticks[k] * c.period) <= self.time]
        if due:
            for number in due:
                self.ticks[number] += 1
            self.ticking = frozenset(due)
            self.event()

    def _advance(self, target: float, tolerance: float) -> None:
        begin = [self.of(one) for one in self.solved.states]
        if not begin and not self.solved.flat.relations:
            self.time = target
            return

        def crossing(relation: Relation, truth: float) -> Callable[[float, Sequence[float]], float]:
            def side(time: float, states: Sequence[float]) -> float:
                self.derivatives(time, states)
                left, right = evaluate(relation.truth.operands, self.of)
                # Just past the point where the truth changes, not on it.
                tilt = 1e-12 if (truth != 0) == (relation.truth.operator in ("less", "less_equal")) else -1e-12
                return left - right - tilt

            side.terminal = True  # type: ignore[attr-defined]  # as solve_ivp wants it
            return side

        events = [crossing(one, truth) for one, truth in zip(self.solved.flat.relations, self.held, strict=True)]
        if not begin:
            begin = [0.0]
        found = solve_ivp(
            lambda time, states: self.derivatives(time, states) if self.solved.states else [0.0],
            (self.time, target),
            begin,
            method="DOP853",
            rtol=tolerance,
            atol=tolerance,
            events=events or None,
        )
        if not found.success:
            raise RunError(found.message)
        if any(math.isnan(value) for value in found.y[:, -1]):
            raise RunError("not a number")
        self.derivatives(found.t[-1], found.y[:, -1])
        if found.status == 1:
            self.event()


def gives(block: EventBlock) -> tuple[Symbol, ...]:
    """What *block* computes."""
    match block:
        case Explicit():
            return (block.unknown,)
        case System():
            return (*block.unknowns, *(one.unknown for one in block.inner))
        case When():
            return (block.target,)
    return ()


def check_order(solved: Solved) -> None:
    """Every list of blocks computes each symbol once and refers to nothing that comes later."""
    known_states = set(solved.states)
    for blocks in ((*solved.derivatives, *solved.outputs), solved.event):
        done: set[Symbol] = set()
        every = [one for block in blocks for one in gives(block)]
        assert len(every) == len(set(every))
        assert known_states.isdisjoint(every)
        for block in blocks:
            own = set(gives(block))
            refers = _refers(block)
            assert (refers & set(every)) - own <= done, (block, refers)
            done |= own


def _refers(block: EventBlock) -> set[Symbol]:
    from dse.modelica.algebra.traversal import symbols

    roots: list[Expression] = []
    match block:
        case Explicit():
            roots = [block.value]
        case System():
            roots = [*block.residuals, *(one.value for one in block.inner), *(e for row in block.jacobian for e in row)]
        case When():
            roots = [value for _, value in block.branches]
    return {one for root in roots for one in symbols(root)}
