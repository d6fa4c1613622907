"""Static constraints and selections: expressions over what is chosen, compiled once and evaluated exactly.

* ``place.property`` is a property of the component at a place, ``sensor.range``.
* ``sum min max mean product count (property, place)`` roll up over the parts below a place that state the
  property, without a place over the whole design. A bare ``cost`` is ``sum(cost)``. ``min`` and ``max`` of
  values, ``min(a.mass, b.mass)``, are told apart by the dot in their first argument.
* ``place is x``, ``place in [x, y]``, ``place is absent``, ``place is present``; ``same_choice(p, q)`` compares
  the names of what stands at p and q.
* ``abs sqrt floor min max`` calculate; all is exact but roots and fractional powers, which are floats.
* A property of an absent part is undefined, and so is all that needs it, as in SQL. A constraint whose
  outcome is undefined holds. An absent part is nothing: ``place is x`` is false, roll-ups skip it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from dse.domain.design import Configuration, DesignSpace
from dse.domain.expression import (
    Between,
    Binary,
    Call,
    Chosen,
    Conditional,
    Expression,
    Name,
    Node,
    Number,
    Span,
    Truth,
    Unary,
)
from dse.errors import closest, fail
from dse.loading.expression_sorts import (
    PLAIN,
    TRUTH,
    Form,
    Sort,
    binary_sort,
    choice_sort,
    error_in,
    require_alike,
    require_number,
    require_truth,
    unary_sort,
)
from dse.space.arithmetic import (
    PLAIN_OPERATORS,
    UndefinedError,
    Value,
    conjunction,
    disjunction,
    floor,
    negate,
    opposite,
    square_root,
)
from dse.space.decisions import Choices
from dse.space.places import Places
from dse.space.rollups import ROLLUPS, lookup, roll_up
from dse.units import power

Evaluate = Callable[[Choices], "Value"]


@dataclass(frozen=True, slots=True)
class Rule:
    """A compiled condition; *decisions* are the paths it depends on."""

    expression: Expression
    decisions: frozenset[str]
    _evaluate: Evaluate

    def outcome(self, choices: Choices) -> bool | None:
        """True, false, or None where it is undefined. Raises DseError for a division by zero and its like."""
        try:
            outcome = self._evaluate(choices)
        except OverflowError as error:
            raise fail("a number is too large", self.expression.where) from error
        return None if outcome is None else bool(outcome)


def compile_rule(expression: Expression, space: DesignSpace) -> Rule:
    """*expression* as a condition on the space's configurations.

    Raises DseError, located, for unknown places, components, properties and functions, and for units that do
    not fit.
    """
    return compile_in(expression, Places(space))


def compile_in(expression: Expression, places: Places) -> Rule:
    """Like `compile_rule`, with the places of the space at hand."""
    compiler = _Compiler(expression, places)
    sort, evaluate = compiler.compile(expression.root)
    require_truth(expression, expression.root, sort)
    return Rule(expression, frozenset(compiler.decisions), evaluate)


def matching(
    space: DesignSpace, condition: Expression, configurations: Iterable[Configuration]
) -> Iterator[Configuration]:
    """Those *configurations* for which *condition* is true. Raises DseError like `compile_rule`, at once."""
    rule = compile_rule(condition, space)
    return (configuration for configuration in configurations if rule.outcome(configuration.choices))


class _Compiler:
    """Turns a tree into closures over the choices, and notes what they depend on."""

    def __init__(self, expression: Expression, places: Places) -> None:
        self.expression = expression
        self.places = places
        self.decisions: set[str] = set()

    def compile(self, node: Node) -> tuple[Sort, Evaluate]:
        match node:
            case Number():
                number = node.si
                return Sort(Form.NUMBER, node.unit.dimension), lambda _: number
            case Truth():
                truth = node.value
                return TRUTH, lambda _: truth
            case Name():
                return self.name(node)
            case Chosen():
                return self.chosen(node)
            case Call():
                return self.call(node)
            case Unary():
                sort, operand = self.compile(node.operand)
                sort = unary_sort(self.expression, node, sort)
                return sort, self.apply(node.span, negate if node.operator == "-" else opposite, [operand])
            case Binary():
                return self.binary(node)
            case Conditional():
                return self.conditional(node)
            case Between():
                # x between a and b is a <= x and x <= b, so it is typed and evaluated as that.
                low = Binary("<=", node.low, node.value, node.span)
                return self.binary(Binary("and", low, Binary("<=", node.value, node.high, node.span), node.span))

    def name(self, node: Name) -> tuple[Sort, Evaluate]:
        if "." not in node.path and node.path in self.places.properties:
            return self.roll_up(Call("sum", (node,), (), node.span))
        sort, entries = self.places.property_at(self.expression, node)
        self.note(condition for condition, _ in entries)
        return sort, lookup(entries)

    def chosen(self, node: Chosen) -> tuple[Sort, Evaluate]:
        sites = self.places.at(self.expression, node.place, node.span)
        self.places.check_options(self.expression, node)
        self.note(site.condition for site in sites)
        name_at = lookup([(site.condition, site.name) for site in sites])
        options: set[str | None] = {option for option in node.options if option not in ("present", "absent")}
        if "present" in node.options:
            options.update(site.name for site in sites)
        if "absent" in node.options:
            options.add(None)
        return TRUTH, lambda choices: name_at(choices) in options

    def call(self, node: Call) -> tuple[Sort, Evaluate]:
        function, arguments = node.function, node.arguments
        if node.options:
            name, value = node.options[0]
            raise self.error(value.span, f"'{function}' has no option '{name}'", "constraints have no named arguments")
        if function == "same_choice":
            return self.same_choice(node)
        first = arguments[0] if arguments else None
        if function in ROLLUPS and (
            function not in ("min", "max") or (isinstance(first, Name) and "." not in first.path)
        ):
            return self.roll_up(node)
        compiled = [self.compile(argument) for argument in arguments]
        sorts = [sort for sort, _ in compiled]
        values = [evaluate for _, evaluate in compiled]
        for argument, sort in zip(arguments, sorts, strict=True):
            require_number(self.expression, argument, sort)
        if function in ("min", "max"):
            if len(arguments) < 2:
                raise self.error(node.span, f"'{function}' needs two values or more", f"{function}(a.mass, b.mass)")
            for argument, sort in zip(arguments[1:], sorts[1:], strict=True):
                require_alike(self.expression, argument.span, sorts[0], sort, "compare")
            return sorts[0], self.apply(node.span, min if function == "min" else max, values)
        if function not in ("abs", "sqrt", "floor"):
            known = (*ROLLUPS, "abs", "sqrt", "floor", "same_choice")
            raise self.error(node.span, f"unknown function '{function}'", closest(function, known))
        if len(arguments) != 1:
            raise self.error(node.span, f"'{function}' needs one value", f"{function}(x)")
        if function == "sqrt":
            return Sort(Form.NUMBER, power(sorts[0].dimension, Fraction(1, 2))), self.apply(
                node.span, square_root, values
            )
        if function == "floor":
            require_alike(self.expression, node.span, PLAIN, sorts[0], "take the floor as a plain number of")
            return sorts[0], self.apply(node.span, floor, values)
        return sorts[0], self.apply(node.span, abs, values)

    def roll_up(self, node: Call) -> tuple[Sort, Evaluate]:
        sort, entries = self.places.properties_below(self.expression, node)
        self.note(condition for condition, _ in entries)
        return sort, roll_up(node.function, entries)

    def same_choice(self, node: Call) -> tuple[Sort, Evaluate]:
        names: list[Evaluate] = []
        for argument in node.arguments:
            if not isinstance(argument, Name):
                raise self.error(argument.span, "'same_choice' compares places", "same_choice(front.tyre, rear.tyre)")
            sites = self.places.at(self.expression, argument.path, argument.span)
            self.note(site.condition for site in sites)
            names.append(lookup([(site.condition, site.name) for site in sites]))
        if len(names) < 2:
            raise self.error(node.span, "'same_choice' needs two places or more", "same_choice(front.tyre, rear.tyre)")

        def same(choices: Choices) -> bool | None:
            there = [name for name_at in names if (name := name_at(choices)) is not None]
            return None if len(there) < 2 else len(set(there)) == 1

        return TRUTH, same

    def binary(self, node: Binary) -> tuple[Sort, Evaluate]:
        (left_sort, left), (right_sort, right) = self.compile(node.left), self.compile(node.right)
        sort = binary_sort(self.expression, node, left_sort, right_sort)
        match node.operator:
            case "and":
                return sort, lambda choices: conjunction(_truth(left(choices)), lambda: _truth(right(choices)))
            case "or":
                return sort, lambda choices: disjunction(_truth(left(choices)), lambda: _truth(right(choices)))
            case "implies":
                return sort, lambda choices: disjunction(
                    opposite(_truth(left(choices))), lambda: _truth(right(choices))
                )
        return sort, self.apply(node.span, PLAIN_OPERATORS[node.operator], [left, right])

    def conditional(self, node: Conditional) -> tuple[Sort, Evaluate]:
        condition_sort, condition = self.compile(node.condition)
        require_truth(self.expression, node.condition, condition_sort)
        (yes_sort, yes), (no_sort, no) = self.compile(node.yes), self.compile(node.no)

        def choose(choices: Choices) -> Value:
            outcome = condition(choices)
            return None if outcome is None else (yes if outcome else no)(choices)

        return choice_sort(self.expression, node.span, yes_sort, no_sort), choose

    def apply(self, span: Span, function: Callable[..., Value], operands: list[Evaluate]) -> Evaluate:
        def several(choices: Choices) -> Value:
            values = []
            for operand in operands:
                value = operand(choices)
                if value is None:
                    return None
                values.append(value)
            return guarded(choices, *values)

        def guarded(choices: Choices, *values: Value) -> Value:
            try:
                return function(*values)
            except UndefinedError as error:
                advice = "guard it: if … then … else …"
                raise self.error(span, f"{error}, for {_shown(choices)}", advice) from error

        return several

    def note(self, conditions: Iterable[Iterable[tuple[str, str]]]) -> None:
        self.decisions |= {path for condition in conditions for path, _ in condition}

    def error(self, span: Span, what: str, advice: str) -> Exception:
        return error_in(self.expression, span, what, advice)


def _truth(value: Value) -> bool | None:
    return None if value is None else bool(value)


def _shown(choices: Choices) -> str:
    return ", ".join(f"{path}={choice}" for path, choice in choices.items()) or "the only configuration"
