"""The model being flattened: its variables by number, the expression graph, and what events have been found."""

from __future__ import annotations

from dataclasses import dataclass, field

from dse.errors import Location
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import symbols, walk
from dse.modelica.flat_model import Assignment, Clock, Relation, Role, ScalarType, Trigger, Variable
from dse.modelica.flatten.values import Value, places


@dataclass(frozen=True, slots=True)
class Declared:
    """A variable of the front-end, maybe an array. *role* is the front-end's word; *names* its scalars row by row."""

    name: str
    role: str
    scalar: str
    shape: tuple[int, ...]
    is_discrete: bool
    where: Location | None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the elements: ``name``, ``name[1]`` or ``name[2,3]``."""
        if not self.shape:
            return (self.name,)
        return tuple(f"{self.name}[{','.join(map(str, place))}]" for place in places(self.shape))


@dataclass(slots=True)
class Model:
    """What grows while equations are read.

    *discrete_inputs* change at events only. *tick_of* names the variable that is true while clock number … ticks;
    *rounded* the variable that holds a rounding between events; *constants* their values, by the node of the binding;
    *compared* are the functions whose derivative annotations were found right, or are *prescribed*: with `noDerivative`
    they state another derivative than the algorithm's.
    Variables made here have names that begin with ``$``.
    """

    graph: Graph
    declared: tuple[Declared, ...]
    discrete_inputs: frozenset[str]
    variables: dict[str, Variable] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)
    relation_of: dict[Expression, int] = field(default_factory=dict)
    clocks: list[Clock] = field(default_factory=list)
    triggers: list[Trigger] = field(default_factory=list)
    assignments: list[Assignment] = field(default_factory=list)
    tick_of: dict[int, str] = field(default_factory=dict)
    rounded: dict[tuple[str, Expression], str] = field(default_factory=dict)
    constants: dict[int, Value] = field(default_factory=dict)
    compared: set[int] = field(default_factory=set)
    prescribed: set[int] = field(default_factory=set)
    _varies: dict[int, bool] = field(default_factory=dict)

    def held(self, truth: Expression, where: Location | None) -> Expression:
        """*truth*, a comparison, as it was at the last event."""
        number = self.relation_of.get(truth)
        if number is None:
            number = len(self.relations)
            self.relation_of[truth] = number
            self.relations.append(Relation(truth, where))
        return self.graph.symbol(Symbol(str(number), referent=Referent.HELD))

    def is_discrete(self, expression: Expression) -> bool:
        """Whether it can change at events only."""
        if expression.number not in self._varies:
            for node in walk((expression,)):
                if node.number not in self._varies:
                    own = node.symbol is not None and not self._is_discrete(node.symbol)
                    self._varies[node.number] = own or any(self._varies[item.number] for item in node.operands)
        return not self._varies[expression.number]

    def is_parameter(self, expression: Expression) -> bool:
        """Whether it depends on parameters and numbers alone."""
        return all(map(self._is_parameter, symbols(expression)))

    def is_known_at_start(self, expression: Expression) -> bool:
        """Whether it depends on parameters, numbers and the time alone."""
        return all(symbol.referent is Referent.TIME or self._is_parameter(symbol) for symbol in symbols(expression))

    def _is_parameter(self, symbol: Symbol) -> bool:
        return symbol.is_variable and not symbol.order and self.variables[symbol.name].role is Role.PARAMETER

    def internal(self, word: str, kind: ScalarType, where: Location | None) -> str:
        """The name of a new discrete variable that no user sees."""
        name = f"${word}{sum(1 for other in self.variables if other.startswith('$')) + 1}"
        self.variables[name] = Variable(
            name, kind, Role.DISCRETE, start=self.graph.constant(0.0), is_protected=True, where=where
        )
        return name

    def ticks(self, clock: int, where: Location | None) -> Expression:
        """Truth of *clock* ticking now: in the first pass of its event only."""
        name = self.tick_of.get(clock)
        if name is None:
            name = self.tick_of[clock] = self.internal("tick", ScalarType.BOOLEAN, where)
            self.triggers.append(Trigger(clocks=(clock,)))
            self.assignments.append(Assignment(name, self.graph.constant(1.0), len(self.triggers) - 1, where))
            self.assignments.append(Assignment(name, self.graph.constant(0.0), None, where))
        return self.graph.variable(name)

    def _is_discrete(self, symbol: Symbol) -> bool:
        if symbol.referent not in (Referent.VARIABLE, Referent.PRE):
            return symbol.referent is not Referent.TIME
        variable = self.variables.get(symbol.name)
        if variable is None or symbol.order:
            return False
        if variable.role is Role.INPUT:
            return symbol.name in self.discrete_inputs
        return variable.role in (Role.PARAMETER, Role.DISCRETE)
