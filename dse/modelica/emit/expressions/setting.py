"""Where the values of one model are in the memory of its C code, and what symbols, arrays and failures are called."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from dse.errors import Location, fail
from dse.modelica.algebra.expression import TRUTHS, Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import Role
from dse.modelica.solved_model import Solved, When, all_expressions, targets


@dataclass(frozen=True, slots=True)
class MemoryLayout:
    """*places* of variables and derivatives in ``v``: parameters (in the order of the flat model, so that an array is
    in a row), inputs, states, their derivatives in the same order, everything else that is computed.

    *own* are the places of eliminated variables that cannot share one: negated ones and those that equal time.
    *pre* gives the place in ``pre[]`` of a variable's pre-value, *conditions* the first number of each trigger's
    conditions. *size* is the count of places so far; the code may add more behind them.
    """

    places: Mapping[Symbol, int]
    own: Mapping[str, int]
    pre: Mapping[str, int]
    conditions: tuple[int, ...]
    condition_count: int
    size: int

    def of(self, name: str) -> int:
        """Referent of the value of the flat variable *name*."""
        return self.own[name] if name in self.own else self.places[Symbol(name)]


def memory_layout(solved: Solved) -> MemoryLayout:
    """The layout of *solved*. Raises DseError for a variable that no equation computes."""
    places: dict[Symbol, int] = {}
    for symbol in _in_order(solved):
        places.setdefault(symbol, len(places))
    size = len(places)
    own: dict[str, int] = {}
    for name in solved.flat.variables:
        if name in solved.aliases:
            kept, sign = solved.aliases[name]
            if sign > 0 and kept in places:
                places[Symbol(name)] = places[kept]
            else:
                own[name] = size
                size += 1
        elif Symbol(name) not in places:
            where = solved.flat.variables[name].where
            raise fail(f"nothing computes the variable '{name}'", where, "give it an equation, or make it an input")
    conditions, count = [], 0
    for trigger in solved.flat.triggers:
        conditions.append(count)
        count += len(trigger.conditions)
    return MemoryLayout(places, own, _pre(solved, places), tuple(conditions), count, size)


def _in_order(solved: Solved) -> Iterator[Symbol]:
    flat = solved.flat
    for role in (Role.PARAMETER, Role.INPUT):
        for name, declared in flat.variables.items():
            if declared.role is role and name not in solved.aliases:
                yield Symbol(name)
    yield from solved.states
    yield from (state.derivative for state in solved.states)
    for blocks in (solved.parameters, solved.derivatives, solved.outputs, solved.event, solved.initial, solved.guesses):
        yield from targets(blocks)


def _pre(solved: Solved, places: Mapping[Symbol, int]) -> dict[str, int]:
    """Numbers of the variables whose values before the event are kept, for equations and when-clauses."""
    wanted = {symbol.name for symbol in symbols(*all_expressions(solved)) if symbol.referent is Referent.PRE}
    for block in (*solved.event, *solved.initial):
        if isinstance(block, When) and all(trigger is not None for trigger, _ in block.branches):
            wanted.add(block.target.name)
    wanted -= {state.name for state in solved.states if state.order == 0}
    return {name: number for number, name in enumerate(sorted(wanted, key=lambda name: places[Symbol(name)]))}


@dataclass(slots=True)
class Collected:
    """What the functions need beside them: texts of failures, arrays that never change, systems of equations."""

    failures: dict[str, int] = field(default_factory=dict)
    arrays: dict[tuple[float, ...], str] = field(default_factory=dict)
    systems: dict[tuple[object, ...], int] = field(default_factory=dict)
    system_lines: list[str] = field(default_factory=list)
    largest_system: int = 1

    def failure(self, text: str) -> int:
        """What a function returns to tell *text*: 1 + its place in ``dse_failure``."""
        return self.failures.setdefault(text, len(self.failures)) + 1

    def constants(self, values: tuple[float, ...]) -> str:
        """The array of *values*, one for equal ones."""
        return self.arrays.setdefault(values, f"dse_numbers_{len(self.arrays)}")

    def array_lines(self) -> list[str]:
        """The definitions of all `constants`."""
        return [
            line
            for values, name in self.arrays.items()
            for line in table(f"static const double {name}[{len(values)}]", [literal(value) for value in values])
        ]


@dataclass(frozen=True, slots=True)
class Setting:
    """Where a function stands: *is_initial* is the value of ``initial()``, *on_failure* what it does about a code.

    *own* are places behind the layout's, of what is computed from parameters beforehand; *gathered* places in
    ``m->data`` of the arrays of such values, by their nodes' numbers. *names* are those of files by their
    paths: what is built must not depend on where they are.
    """

    layout: MemoryLayout
    collected: Collected
    is_initial: bool = False
    own: Mapping[Symbol, int] = field(default_factory=dict)
    gathered: Mapping[int, int] = field(default_factory=dict)
    on_failure: str = "return {code};"
    names: Mapping[str, str] = field(default_factory=dict)

    def failing(self, text: str) -> str:
        """The statement that tells *text*."""
        return self.on_failure.format(code=self.collected.failure(text))

    def place(self, symbol: Symbol) -> int:
        """Referent in ``v``."""
        found = self.own.get(symbol)
        return self.layout.places[symbol] if found is None else found

    def symbol(self, symbol: Symbol) -> str:
        """The value of *symbol* as an operand."""
        match symbol.referent:
            case Referent.VARIABLE:
                return f"v[{self.place(symbol)}]"
            case Referent.PRE if symbol.name in self.layout.pre:
                return f"m->pre[{self.layout.pre[symbol.name]}]"
            case Referent.PRE:
                return f"v[{self.layout.places[Symbol(symbol.name)]}]"
            case Referent.HELD:
                return f"m->held[{symbol.name}]"
            case Referent.TIME:
                return "m->time"
            case Referent.CONTINUED:
                return "m->continued"
        return "1" if self.is_initial else "0"

    def locations(self, where: Iterable[Location]) -> str:
        """*where* in words, cut after four places."""
        named = [(self.names.get(place.file, place.file), place.line) for place in where]
        shown = [f"{name}:{line}" if line else name for name, line in dict.fromkeys(named)]
        return ", ".join(shown[:4]) + (", …" if len(shown) > 4 else "")

    def array(self, node: Expression) -> str | None:
        """A pointer to the elements of *node*, if they stand in a row somewhere."""
        if all(element.is_constant for element in node.operands):
            return self.collected.constants(tuple(element.value for element in node.operands))
        if node.number in self.gathered:
            return f"(m->data + {self.gathered[node.number]})"
        places = []
        for element in node.operands:
            if element.symbol is None or not element.symbol.is_variable:
                return None
            places.append(self.place(element.symbol))
        is_row = all(place == places[0] + number for number, place in enumerate(places))
        return f"(v + {places[0]})" if is_row else None


def is_truth(node: Expression) -> bool:
    """Whether *node* is an int in C, 0 or 1."""
    if node.symbol is not None:
        return node.symbol.referent in (Referent.HELD, Referent.INITIAL)
    return node.operator in TRUTHS


def literal(value: float) -> str:
    """*value* to the last bit, as an operand: ``2.5``, ``(-1e-09)``, ``NAN``."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "(-INFINITY)"
    shown = repr(value)
    return f"({shown})" if shown.startswith("-") else shown


def quoted(text: str) -> str:
    """*text* as a C string in plain ASCII; everything else in UTF-8, as octal escapes."""
    return '"' + "".join(_ESCAPES.get(byte) or _PLAIN[byte] for byte in text.encode("utf-8")) + '"'


# A question mark is escaped because of trigraphs.
_ESCAPES = {ord('"'): '\\"', ord("\\"): "\\\\", ord("\n"): "\\n", ord("\t"): "\\t", ord("?"): "\\?"}


_PLAIN = [chr(byte) if 32 <= byte < 127 else f"\\{byte:03o}" for byte in range(256)]


def comment(text: str) -> str:
    """*text* as a comment of one line, whatever it contains."""
    plain = text.encode("ascii", "replace").decode().replace("\n", " ").replace("\\", "/")
    return f"/* {plain.replace('*/', '* /').replace('/*', '/ *')} */"


_WIDTH = 110


def table(declaration: str, items: list[str], empty: str = "0") -> list[str]:
    """An array's definition; C has no empty arrays, so an empty one gets an unused element."""
    lines = [f"{declaration} = {{"]
    line = ""
    for item in items or [empty]:
        if line and len(line) + len(item) + 6 > _WIDTH:
            lines.append(f"    {line.rstrip()}")
            line = ""
        line += f"{item}, "
    return [*lines, f"    {line.rstrip()}", "};"]
