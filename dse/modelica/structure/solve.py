"""From a flat model to a sorted one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from dse.errors import DseError, Problem
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import actual, replaced, symbols
from dse.modelica.flat_model import FlatModel, Role
from dse.modelica.solved_model import Block, Explicit, Solved
from dse.modelica.structure.aliases.elimination import Eliminated, rewriter, without_aliases
from dse.modelica.structure.aliases.merging import merged
from dse.modelica.structure.blocks.arrange import Quantity, Stage, arranged
from dse.modelica.structure.blocks.conditioning import refuse_singular
from dse.modelica.structure.dependencies import Reach, dependencies, refuse_uncertain
from dse.modelica.structure.events import discrete_steps, ordered
from dse.modelica.structure.initialization import checked, start
from dse.modelica.structure.known import Known, Starts, default, dependent_parameters, is_free
from dse.modelica.structure.reduction.dummies import chosen
from dse.modelica.structure.reduction.guards import guarded
from dse.modelica.structure.reduction.pantelides import reduced
from dse.modelica.structure.rows import Row, listed


def solve(flat: FlatModel) -> Solved:
    """Sort *flat*: aliases eliminated, index reduced, blocks ordered and torn, initialization completed.

    The flat model of the result is rewritten: its expressions refer to no eliminated variable. Raises DseError, with
    the equations' places, for whatever cannot be solved with certainty.
    """
    if flat.graph.knows(Symbol(referent=Referent.CONTINUED)):
        # Only equations are solved by continuation.
        flat = replace(flat.mapped(actual), equations=flat.equations, initial_equations=flat.initial_equations)
    parameters = dependent_parameters(flat)
    eliminated = without_aliases(flat)
    flat, notes = _reduced_model(flat, eliminated)
    names = _unknown_names(flat, eliminated)
    _refuse_lone_derivatives(flat)
    known = Known(flat, Starts(flat, parameters))

    rows = [Row(actual(_with_initial(one.residual, 0.0)), one.where) for one in flat.equations]
    found = reduced(rows, names, flat.variables)
    choice = chosen(found, flat.variables, known)
    chains = guarded(found.chains, choice.guards)
    every = [Symbol(name, order) for name in names for order in range(found.highest[name] + 1)]
    states = [
        symbol
        for symbol in every
        if symbol.order < found.highest[symbol.name] and symbol.derivative not in choice.dummies
    ]
    is_state = set(states)
    unknowns = [symbol for symbol in every if symbol not in is_state]
    stages = arranged([row for chain in chains for row in chain], unknowns, known)
    refuse_singular((stage.block for stage in stages), known)

    first = start(flat, _at_start(flat, chains), every, states)
    flat = checked(flat, first.superfluous)
    first_stages = arranged(first.rows, first.unknowns, known)
    refuse_singular((stage.block for stage in first_stages), known)

    steps = discrete_steps(flat)
    inputs = [Symbol(name) for name, one in flat.variables.items() if one.role is Role.INPUT]
    refuse_uncertain(flat, states, Reach([*stages, *steps], states))
    reach = Reach([*stages, *steps], [*inputs, *states], flat.relations)
    wanted = [one.derivative for one in states]
    wanted += symbols(*(relation.truth for relation in flat.relations))
    hot, cold = partitioned(stages, wanted)
    aliases = {name: (Symbol(kept), sign) for name, (kept, sign) in eliminated.aliases.items()}
    numbers = [Explicit(Symbol(name), flat.graph.constant(value)) for name, value in eliminated.numbers.items()]
    return Solved(
        flat=flat,
        states=tuple(states),
        parameters=(*numbers, *parameters),
        derivatives=tuple(hot),
        outputs=tuple(cold),
        event=tuple(ordered([*stages, *steps])),
        initial=tuple(ordered([*first_stages, *discrete_steps(flat, first.discretes, at_start=True)])),
        aliases=aliases,
        guesses=tuple(_guesses(flat, eliminated)),
        dependencies=dependencies(flat, reach, states, aliases),
        notes=(*notes, *_jumps(flat, chains), *first.notes),
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


def _unknown_names(flat: FlatModel, eliminated: Eliminated) -> list[str]:
    return [
        name
        for name, variable in flat.variables.items()
        if variable.role is Role.CONTINUOUS and name not in eliminated.aliases and name not in eliminated.numbers
    ]


def _refuse_lone_derivatives(flat: FlatModel) -> None:
    """Derivatives that occur in events only are not among the unknowns: say so."""
    known = symbols(*(one.residual for one in flat.equations))
    orders: dict[str, int] = {}
    for symbol in known:
        orders[symbol.name] = max(orders.get(symbol.name, 0), symbol.order)
    others = [*flat.at_events(), *((one.residual, one.where) for one in flat.initial_equations)]
    problems = [
        Problem(f"{symbol} is used here, but in no equation", where, f"add a variable that equals {symbol}")
        for root, where in others
        for symbol in symbols(root)
        if symbol.is_variable and symbol.order > orders.get(symbol.name, 0)
    ]
    if problems:
        raise DseError(*problems)


def _with_initial(residual: Expression, value: float) -> Expression:
    """*residual* where ``initial()`` is *value*."""
    number = residual.graph.constant(value)

    def new(node: Expression) -> Expression | None:
        return number if node.symbol is not None and node.symbol.referent is Referent.INITIAL else None

    return replaced((residual,), new)[0]


def _at_start(flat: FlatModel, chains: Sequence[Sequence[Row]]) -> list[Row]:
    """The equations and their derivatives as they are while ``initial()`` is true."""
    rows = []
    for equation, chain in zip(flat.equations, chains, strict=True):
        first = _with_initial(equation.residual, 1.0)
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
            or (symbol.is_variable and flat.variables[symbol.name].role is Role.DISCRETE)
        ]
        if causes:
            place = f"{chain[0].where}: " if chain[0].where else ""
            what = f"{place}{chain[0]} joins states and depends on {listed(causes)}"
            notes.append(f"{what}: at its events what is not a state jumps, without an impulse on the states")
    return notes


def _guesses(flat: FlatModel, eliminated: Eliminated) -> list[Explicit]:
    found = []
    gone: Mapping[str, object] = {**eliminated.aliases, **eliminated.numbers}
    for name, variable in flat.variables.items():
        is_unknown = variable.role in (Role.CONTINUOUS, Role.DISCRETE) and name not in gone
        if is_unknown or is_free(variable):
            value = flat.graph.constant(default(variable)) if variable.start is None else variable.start
            found.append(Explicit(Symbol(name), value))
    return found


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
