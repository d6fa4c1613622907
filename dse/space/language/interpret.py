"""From an expression to a term: names are resolved, units checked, and what makes no sense is refused.

``between``, ``implies``, ``same_choice`` and the bare name of a property are shorthands and leave no trace in the term.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from dse.domain.expression import (
    ROLLUPS,
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
from dse.errors import DseError, closest
from dse.expression import (
    COMPARISON_OPERATORS,
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
from dse.loading import unfold
from dse.space.decisions import Site
from dse.space.language.places import Places
from dse.space.language.terms import (
    ConditionalTerm,
    Constant,
    Every,
    Quota,
    RollUp,
    Selected,
    Some,
    Stated,
    Term,
    TermOperation,
)
from dse.units import power

QUOTAS = ("at_least", "at_most", "exactly")
"""Functions that count conditions: ``at_least(2, a is x, b is y, c is z)``."""

_FUNCTIONS = ("abs", "sqrt", "floor", "min", "max")


def interpret_condition(expression: Expression, places: Places) -> Term:
    """*expression* as a condition.

    Raises DseError, located, for unknown places, components, properties, parameters and functions, and for units
    that do not fit.
    """
    sort, term = interpret(expression, places)
    require_truth(expression, expression.root, sort)
    return term


def interpret(expression: Expression, places: Places) -> tuple[Sort, Term]:
    """*expression* with the sort of its value. Raises DseError like `interpret_condition`."""
    expression = unfold(expression, places.instances)
    return _Interpreter(expression, places).term(expression.root)


class _Interpreter:
    def __init__(self, expression: Expression, places: Places) -> None:
        self.expression = expression
        self.places = places

    def term(self, node: Node) -> tuple[Sort, Term]:
        match node:
            case Number():
                return Sort(Form.NUMBER, node.unit.dimension), Constant(node.si)
            case Truth():
                return TRUTH, Constant(node.value)
            case Name():
                return self.name(node)
            case Chosen():
                return TRUTH, self.chosen(node)
            case Call():
                return self.call(node)
            case Unary():
                sort, operand = self.term(node.operand)
                sort = unary_sort(self.expression, node, sort)
                return sort, TermOperation("not" if node.operator == "not" else "negative", (operand,), node.span)
            case Binary("and" | "or"):
                return TRUTH, self.junction(node)
            case Binary():
                return self.binary(node)
            case Conditional():
                return self.conditional(node)
            case Between():
                # x between a and b is a <= x and x <= b, so it is typed and evaluated as that.
                low = Binary("<=", node.low, node.value, node.span)
                high = Binary("<=", node.value, node.high, node.span)
                return TRUTH, self.junction(Binary("and", low, high, node.span))

    def name(self, node: Name) -> tuple[Sort, Term]:
        if "." not in node.path and node.path in self.places.properties:
            return self.roll_up(Call("sum", (node,), (), node.span))
        sort, entries = self.places.value_at(self.expression, node)
        return sort, Stated(entries)

    def chosen(self, node: Chosen) -> Term:
        sites = self.places.at(self.expression, node.place, node.place_span())
        self.places.check_options(self.expression, node)
        named: set[str | None] = {option for option in node.options if option not in ("present", "absent")}
        if "present" in node.options:
            named |= self.places.names_at(node.place)
        if "absent" in node.options:
            named.add(None)
        return Selected(sites, frozenset(named))

    def call(self, node: Call) -> tuple[Sort, Term]:
        function, arguments = node.function, node.arguments
        if node.options:
            name, value = node.options[0]
            raise self.error(value.span, f"'{function}' has no option '{name}'", "constraints have no named arguments")
        if function == "same_choice":
            return TRUTH, self.same_choice(node)
        if function in QUOTAS:
            return TRUTH, self.quota(node)
        first = arguments[0] if arguments else None
        if function in ROLLUPS and (
            function not in ("min", "max") or (isinstance(first, Name) and "." not in first.path)
        ):
            return self.roll_up(node)
        pairs = [self.term(argument) for argument in arguments]
        for argument, (sort, _) in zip(arguments, pairs, strict=True):
            require_number(self.expression, argument, sort)
        if function not in _FUNCTIONS:
            known = (*ROLLUPS, *_FUNCTIONS, *QUOTAS, "same_choice")
            raise self.error(node.span, f"unknown function '{function}'", closest(function, known))
        sort = self.function_sort(node, [sort for sort, _ in pairs])
        return sort, TermOperation(function, tuple(operand for _, operand in pairs), node.span)

    def function_sort(self, node: Call, sorts: Sequence[Sort]) -> Sort:
        function = node.function
        if function in ("min", "max"):
            if len(sorts) < 2:
                raise self.error(node.span, f"'{function}' needs two values or more", f"{function}(a.mass, b.mass)")
            for argument, sort in zip(node.arguments[1:], sorts[1:], strict=True):
                require_alike(self.expression, argument.span, sorts[0], sort, "compare")
            return sorts[0]
        if len(sorts) != 1:
            raise self.error(node.span, f"'{function}' needs one value", f"{function}(x)")
        if function == "sqrt":
            return Sort(Form.NUMBER, power(sorts[0].dimension, Fraction(1, 2)))
        if function == "floor":
            require_alike(self.expression, node.span, PLAIN, sorts[0], "take the floor as a plain number of")
        return sorts[0]

    def roll_up(self, node: Call) -> tuple[Sort, Term]:
        sort, entries = self.places.values_below(self.expression, node)
        return sort, RollUp(node.function, entries)

    def same_choice(self, node: Call) -> Term:
        compared = []
        for argument in node.arguments:
            if not isinstance(argument, Name):
                raise self.error(argument.span, "'same_choice' compares places", "same_choice(front.tyre, rear.tyre)")
            compared.append(self.places.at(self.expression, argument.path, argument.span))
        if len(compared) < 2:
            raise self.error(node.span, "'same_choice' needs two places or more", "same_choice(front.tyre, rear.tyre)")
        # At each place there is one choice, absent among them: two are the same if what the one is the other is, too.
        return Every(tuple(_alike(one, other, node.span) for one, other in pairwise(compared)))

    def quota(self, node: Call) -> Term:
        form = f"{node.function}(2, a is x, b is y, c is z)"
        number = node.arguments[0] if node.arguments else node
        if not isinstance(number, Number) or number.unit.dimension or number.si.denominator != 1 or number.si < 0:
            raise self.error(number.span, f"'{node.function}' needs to know how many", f"write a number: {form}")
        conditions = []
        for argument in node.arguments[1:]:
            sort, condition = self.term(argument)
            require_truth(self.expression, argument, sort)
            conditions.append(condition)
        if not conditions:
            raise self.error(node.span, f"'{node.function}' needs conditions", form)
        of = int(number.si)
        if of > len(conditions) and node.function != "at_most":
            what = f"{of} of {len(conditions)} conditions can never hold"
            raise self.error(number.span, what, "lower the number or add conditions")
        low = None if node.function == "at_most" else of
        high = None if node.function == "at_least" else of
        return Quota(low, high, tuple(conditions))

    def junction(self, node: Binary) -> Term:
        """A chain of the same word is one term, however long it is."""
        word = node.operator
        conditions = []
        stack: list[Node] = [node]
        while stack:
            below = stack.pop()
            if isinstance(below, Binary) and below.operator == word:
                stack += [below.right, below.left]
                continue
            sort, condition = self.term(below)
            require_truth(self.expression, below, sort)
            conditions.append(condition)
        return Every(tuple(conditions)) if word == "and" else Some(tuple(conditions))

    def binary(self, node: Binary) -> tuple[Sort, Term]:
        (left_sort, left), (right_sort, right) = self.term(node.left), self.term(node.right)
        operator = node.operator
        if operator in ("+", "-", *COMPARISON_OPERATORS):
            left_sort, right_sort = _with_zeros((left_sort, left), (right_sort, right))
        sort = binary_sort(self.expression, node, left_sort, right_sort)
        if operator == "implies":
            return sort, Some((TermOperation("not", (left,), node.left.span), right))
        if operator in ("==", "!=") and left_sort.form is Form.TRUTH:
            operator = "iff" if operator == "==" else "xor"
        return sort, TermOperation(operator, (left, right), node.span)

    def conditional(self, node: Conditional) -> tuple[Sort, Term]:
        condition_sort, condition = self.term(node.condition)
        require_truth(self.expression, node.condition, condition_sort)
        (yes_sort, yes), (no_sort, no) = self.term(node.yes), self.term(node.no)
        yes_sort, no_sort = _with_zeros((yes_sort, yes), (no_sort, no))
        return choice_sort(self.expression, node.span, yes_sort, no_sort), ConditionalTerm(condition, yes, no)

    def error(self, span: Span, what: str, advice: str) -> DseError:
        return error_in(self.expression, span, what, advice)


def _with_zeros(left: tuple[Sort, Term], right: tuple[Sort, Term]) -> tuple[Sort, Sort]:
    """The sorts of two numbers; a literal 0 without a unit is 0 in any unit."""
    (left_sort, left_term), (right_sort, right_term) = left, right
    if left_sort.form is right_sort.form is Form.NUMBER:
        if isinstance(left_term, Constant) and left_term.value == 0 and left_sort == PLAIN:
            return right_sort, right_sort
        if isinstance(right_term, Constant) and right_term.value == 0 and right_sort == PLAIN:
            return left_sort, left_sort
    return left_sort, right_sort


def _alike(one: tuple[Site, ...], other: tuple[Site, ...], span: Span) -> Term:
    named = [frozenset([choice]) for choice in (*dict.fromkeys(site.name for site in one), None)]
    return Every(
        tuple(Some((TermOperation("not", (Selected(one, each),), span), Selected(other, each))) for each in named)
    )
