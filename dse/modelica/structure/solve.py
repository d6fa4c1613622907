"""From a flat model to a sorted one."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace

from dse.errors import DseError, Problem, raise_if_any
from dse.graphs import components
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import actual, symbols
from dse.modelica.flat_model import FlatModel, Relation, Role
from dse.modelica.solved_model import Block, EventBlock, Explicit, Solved, System
from dse.modelica.structure.aliases.elimination import Eliminated, rewriter, without_aliases
from dse.modelica.structure.aliases.merging import merged
from dse.modelica.structure.blocks.arrange import Quantity, Stage, arranged
from dse.modelica.structure.blocks.conditioning import refuse_singular
from dse.modelica.structure.events import discrete_steps, ordered
from dse.modelica.structure.initialization import checked, start, values_before, without_values_before
from dse.modelica.structure.known import default, dependent_parameters, is_free
from dse.modelica.structure.preparation import with_initial, with_preferred_rates, without_zeros
from dse.modelica.structure.reduction.selection import with_states
from dse.modelica.structure.rows import Row, listed


def solve(flat: FlatModel) -> Solved:
    """Sort *flat*: aliases eliminated, index reduced, blocks ordered and torn, initialization completed.

    The flat model of the result is rewritten: its expressions refer to no eliminated variable. Raises DseError, with
    the equations' places, for whatever cannot be solved with certainty.
    """
    if flat.graph.knows(Symbol(referent=Referent.CONTINUED)):
        # Only equations are solved by continuation.
        flat = replace(flat.mapped(actual), equations=flat.equations, initial_equations=flat.initial_equations)
    flat = without_zeros(without_values_before(flat))
    preferred = with_preferred_rates(flat)
    if preferred is not flat:
        with contextlib.suppress(DseError):  # a preference is no demand
            return _sorted(preferred)
    return _sorted(flat)


def _sorted(flat: FlatModel) -> Solved:
    parameters = dependent_parameters(flat)
    eliminated = without_aliases(flat)
    flat, notes = _reduced_model(flat, eliminated)
    gone = {*eliminated.aliases, *eliminated.numbers}
    names = [name for name, one in flat.variables.items() if one.role is Role.CONTINUOUS and name not in gone]
    _refuse_lone_derivatives(flat)

    made = with_states(flat, names, parameters)
    flat, known, chains, states = made.flat, made.known, made.chains, made.states
    is_state = set(states)
    unknowns = [symbol for symbol in made.symbols if symbol not in is_state]
    stages = arranged([row for chain in chains for row in chain], unknowns, known)
    refuse_singular((stage.block for stage in stages), known)

    first = start(flat, _at_start(flat, chains), made.symbols, made.started)
    flat = checked(flat, first.superfluous)
    first_stages = arranged(first.rows, first.unknowns, known)
    refuse_singular((stage.block for stage in first_stages), known)

    before = values_before(flat, first)
    steps = discrete_steps(flat)
    inputs = [Symbol(name) for name, one in flat.variables.items() if one.role is Role.INPUT]
    refuse_uncertain(flat, states, Reach([*stages, *steps], states))
    reach = Reach([*stages, *steps], [*inputs, *states], flat.relations)
    wanted = [one.derivative for one in states]
    for selection in made.selections:
        wanted += [*selection.every, *map(Symbol, selection.matrix)]
    wanted += symbols(*(relation.truth for relation in flat.relations))
    blocks = [stage.block for stage in stages if not states]  # whose roots nothing else follows through the time
    wanted += [unknown for one in blocks if isinstance(one, System) and not one.is_linear for unknown in one.unknowns]
    hot, cold = partitioned(stages, wanted)
    aliases = {name: (Symbol(kept), sign) for name, (kept, sign) in eliminated.aliases.items()}
    numbers = [Explicit(Symbol(name), flat.graph.constant(value)) for name, value in eliminated.numbers.items()]
    return Solved(
        flat=flat,
        states=states,
        parameters=(*numbers, *parameters),
        derivatives=tuple(hot),
        outputs=tuple(cold),
        event=tuple(ordered([*stages, *steps])),
        initial=tuple(ordered([*first_stages, *before, *discrete_steps(flat, first.discretes, at_start=True)])),
        aliases=aliases,
        guesses=tuple(_guesses(flat, gone)),
        dependencies=dependencies(flat, reach, states, aliases),
        notes=(*notes, *_jumps(flat, chains), *first.notes),
        selections=made.selections,
    )


def _reduced_model(flat: FlatModel, eliminated: Eliminated) -> tuple[FlatModel, list[str]]:
    """*flat* without the equations and symbols of what is eliminated."""
    rewrite = rewriter(flat.graph, eliminated.substitutes(flat.graph))
    kept = replace(flat, equations=eliminated.equations).mapped(rewrite)
    reinitializations = []
    for one in kept.reinitializations:
        name, sign = eliminated.aliases.get(one.state, (one.state, 1))
        reinitializations.append(replace(one, state=name, value=one.value if sign > 0 else -one.value))
    return merged(replace(kept, reinitializations=tuple(reinitializations)), eliminated)


def _refuse_lone_derivatives(flat: FlatModel) -> None:
    """Derivatives that occur in events only are not among the unknowns: say so."""
    known = symbols(*(one.residual for one in flat.equations))
    orders = {symbol.name: symbol.order for symbol in sorted(known, key=lambda one: one.order)}
    others = [*flat.at_events(), *((one.residual, one.where) for one in flat.initial_equations)]
    problems = [
        Problem(f"{symbol} is used here, but in no equation", where, f"add a variable that equals {symbol}")
        for root, where in others
        for symbol in symbols(root)
        if symbol.is_variable and symbol.order > orders.get(symbol.name, 0)
    ]
    raise_if_any(problems)


def _at_start(flat: FlatModel, chains: Sequence[Sequence[Row]]) -> list[Row]:
    """The equations and their derivatives as they are while ``initial()`` is true."""
    rows = []
    for equation, chain in zip(flat.equations, chains, strict=True):
        first = with_initial(equation.residual, 1.0)
        if actual(first) is not chain[0].residual and len(chain) > 1:
            what = "this equation differs at the start, but its derivative is needed"
            raise DseError(Problem(what, equation.where, "write an initial equation instead of initial()"))
        rows.extend([Row(first, equation.where), *chain[1:]])
    return rows


def _jumps(flat: FlatModel, chains: Sequence[Sequence[Row]]) -> list[str]:
    """What happens at events to variables that are joined by an equation that changes there."""
    notes = []
    for chain in chains:
        causes = [
            symbol
            for symbol in (symbols(chain[0].residual) if len(chain) > 1 else ())
            if symbol.referent is Referent.HELD
            or (symbol.is_variable and flat.variables[symbol.name].role is Role.DISCRETE and symbol.name[0] != "$")
        ]
        if causes:
            place = f"{chain[0].where}: " if chain[0].where else ""
            what = f"{place}{chain[0]} joins states and depends on {listed(causes)}"
            notes.append(f"{what}: at its events what is not a state jumps, without an impulse on the states")
    return notes


def _guesses(flat: FlatModel, gone: Set[str]) -> Iterator[Explicit]:
    for name, variable in flat.variables.items():
        is_unknown = variable.role in (Role.CONTINUOUS, Role.DISCRETE) and name not in gone
        if is_unknown or is_free(variable):
            value = flat.graph.constant(default(variable)) if variable.start is None else variable.start
            yield Explicit(Symbol(name), value)


def partitioned(stages: Sequence[Stage[Block]], wanted: Iterable[Symbol]) -> tuple[list[Block], list[Block]]:
    """Blocks of *stages* that *wanted* needs, and the others; both in their order."""
    needed: set[Quantity] = set(wanted)
    is_hot = [False] * len(stages)
    for place in reversed(range(len(stages))):
        if needed.intersection(stages[place].gives):
            is_hot[place] = True
            needed.update(stages[place].needs)
    hot = [stage.block for stage, is_wanted in zip(stages, is_hot, strict=True) if is_wanted]
    return hot, [stage.block for stage, is_wanted in zip(stages, is_hot, strict=True) if not is_wanted]


# On which inputs and states the outputs and derivatives depend, for the model description.


class Reach:
    """On which of *sources* everything that is computed depends, also by way of discrete variables.

    By way of held *relations* too, if they are given; not by way of pre-values, which are known at an event.
    """

    def __init__(
        self,
        stages: Sequence[Stage[EventBlock]],
        sources: Sequence[Symbol],
        relations: Sequence[Relation] = (),
    ) -> None:
        self._sources = {symbol: place for place, symbol in enumerate(sources)}
        nodes: list[tuple[tuple[Quantity, ...], tuple[Quantity, ...]]] = [(one.gives, one.needs) for one in stages]
        nodes += [
            ((Symbol(str(place), referent=Referent.HELD),), tuple(symbols(relation.truth)))
            for place, relation in enumerate(relations)
        ]
        self._giver = {quantity: place for place, (gives, _) in enumerate(nodes) for quantity in gives}
        needs = [[self._giver[quantity] for quantity in refers if quantity in self._giver] for _, refers in nodes]
        self._reached = [0] * len(nodes)
        for component in components(needs):
            mask = 0
            for place in component:
                for quantity in nodes[place][1]:
                    if quantity in self._sources:
                        mask |= 1 << self._sources[quantity]
                for other in needs[place]:
                    mask |= self._reached[other]
            for place in component:
                self._reached[place] = mask

    def of(self, *symbols: Symbol) -> list[Symbol]:
        """The sources that *symbols* depend on, themselves if they are sources."""
        mask = 0
        for symbol in symbols:
            if symbol in self._sources:
                mask |= 1 << self._sources[symbol]
            elif symbol in self._giver:
                mask |= self._reached[self._giver[symbol]]
        return [symbol for symbol, place in self._sources.items() if mask >> place & 1]


def dependencies(
    flat: FlatModel, reach: Reach, states: Sequence[Symbol], aliases: Mapping[str, tuple[Symbol, int]]
) -> dict[str, frozenset[str]]:
    """For each output (its name) and state's derivative (its symbol's text): names of inputs, texts of states."""
    outputs = [name for name, variable in flat.variables.items() if variable.is_output]
    wanted = {name: aliases[name][0] if name in aliases else Symbol(name) for name in outputs}
    wanted |= {str(state.derivative): state.derivative for state in states}
    return {name: frozenset(map(str, reach.of(symbol))) for name, symbol in wanted.items()}


def refuse_uncertain(flat: FlatModel, states: Sequence[Symbol], reach: Reach) -> None:
    """Raise DseError for each ``reinit`` of what is no state, and where old and new values of a state could be mixed.

    ``reinit(x, expression)`` makes x an unknown of the event instant (Modelica 3.6, 8.3.6), so whatever else reads x
    without ``pre`` at that instant means the new value; but values are read before any state is written. Its own state
    may be read plainly: ``reinit(v, -e * v)`` is common and means the value before.
    """
    names = {state.name for state in states if not state.order}
    hint = "prefer it as a state by stateSelect"
    what = "reinit of '{}', which is not a state: its value follows from other states"
    problems = [
        Problem(what.format(one.state), one.where, hint) for one in flat.reinitializations if one.state not in names
    ]
    written = {one.state for one in flat.reinitializations}
    written_by = {(one.trigger, one.state) for one in flat.reinitializations}
    for one in flat.reinitializations:
        for name in _read(one.value, reach):
            if name in written and name != one.state:
                what = f"the new value of '{one.state}' is read from '{name}', which is set anew itself"
                problems.append(Problem(what, one.where, f"write pre({name})"))
    for assignment in flat.assignments:
        if assignment.trigger is None:
            continue
        for name in _read(assignment.value, reach):
            if (assignment.trigger, name) in written_by:
                what = f"'{assignment.target}' is read from '{name}', which is set anew at the same instant"
                problems.append(Problem(what, assignment.where, f"write pre({name})"))
    raise_if_any(problems)


def _read(value: Expression, reach: Reach) -> list[str]:
    """States that *value* depends on at the instant."""
    return [symbol.name for symbol in reach.of(*symbols(value)) if not symbol.order]
