"""Expressions over waveforms → instructions.

Waveforms combine with each other and with numbers row by row (``world.speed - world.lead_speed``, also
comparisons, for `duration`), as does ``time``, in seconds; the functions of `dse.metrics.catalogue` turn them into
numbers. An item of an enumeration is compared by its name, ``mode == speed``. A comparison with NaN is
false, also ``!=``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

import numpy as np

from dse.domain.component import Kind, Type
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
    Truth,
    Unary,
)
from dse.errors import DseError, closest
from dse.expression import (
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
from dse.metrics import functions
from dse.metrics.catalogue import FUNCTIONS, OFFERED, RELATIVE_TO_TARGET, ROWWISE, Argument, Function, Wants
from dse.metrics.machine import TIME, Instruction, Register
from dse.units import Dimension, describe, parse_unit, power, si_unit

Typed = tuple[Sort, Register]

CLOCK = "time"
"""The simulation time, in expressions of metrics."""


class FollowUpError(Exception):
    """Something that cannot be compiled because a metric it uses was not, which is reported already."""


class MetricCompiler:
    """Emits every computation once, however often it is written: one maximum per waveform serves all metrics."""

    def __init__(
        self,
        types: Mapping[str, Type],
        signals: frozenset[str],
        names: Sequence[str],
        functions: Mapping[str, Function] = FUNCTIONS,
        *,
        timed: bool = False,
    ) -> None:
        self.types = types
        self.signals = signals
        self.names = names
        self.functions = functions
        self.timed = timed
        self.rows: Register | None = None
        self.varies = False
        self.reached: set[str] = set()
        self.metrics: dict[str, Typed] = {}
        self.size = TIME + 1
        self.inputs: dict[str, Register] = {}
        self.literals: dict[float, Register] = {}
        self.instructions: dict[tuple[Callable[..., Any], tuple[Register, ...]], Instruction] = {}

    @contextmanager
    def window(self, over: tuple[float, float]) -> Iterator[None]:
        """Waveforms, and the time, are those of the rows *over* so many seconds; `varies` then says if any is used."""
        self.rows = self._add(functions.rows_within, TIME, *map(self._literal, over))
        self.varies = False
        try:
            yield
        finally:
            self.rows = None

    def of_window(self, value: Register) -> Register:
        """*value* as a result of the window: undefined where the run has no row of it."""
        return value if self.rows is None else self._add(functions.of_rows, value, self.rows)

    def compile(self, expression: Expression, node: Node) -> Typed:
        """The sort of *node* and the register its value will be in. Raises DseError or FollowUpError."""
        match node:
            case Number():
                return Sort(Form.NUMBER, node.unit.dimension), self._literal(float(node.si))
            case Truth():
                return TRUTH, self._emit(is_true, self._literal(float(node.value)))
            case Name():
                return self._name(expression, node)
            case Call():
                return self._call(expression, node)
            case Unary():
                sort, operand = self.compile(expression, node.operand)
                function = np.negative if node.operator == "-" else np.logical_not
                return unary_sort(expression, node, sort), self._emit(function, operand)
            case Binary():
                return self._binary(expression, node)
            case Between():
                low = Binary("<=", node.low, node.value, node.span)
                high = Binary("<=", node.value, node.high, node.span)
                return self._binary(expression, Binary("and", low, high, node.span))
            case Conditional():
                condition_sort, condition = self.compile(expression, node.condition)
                require_truth(expression, node.condition, condition_sort)
                (yes_sort, yes), (no_sort, no) = (self.compile(expression, n) for n in (node.yes, node.no))
                sort = choice_sort(expression, node.span, yes_sort, no_sort)
                varies = sort.varies or condition_sort.varies
                return Sort(sort.form, sort.dimension, varies, sort.items), self._emit(select, condition, yes, no)
            case Chosen():
                what = f"'{node.place}' is a choice; metrics do not depend on choices by name"
                raise error_in(expression, node.span, what, "compare an item as in mode == speed")

    def _name(self, expression: Expression, node: Name) -> Typed:
        name = node.path
        if name in self.metrics:
            return self.metrics[name]
        if name == CLOCK and self.timed:
            return Sort(Form.NUMBER, parse_unit("s").dimension, True), self._in_window(TIME)
        if name not in self.types:
            if name in self.reached:
                raise FollowUpError
            if name in self.names:
                raise error_in(expression, node.span, f"metric '{name}' is defined further down", "move it up")
            known = (*self.types, *self.metrics)
            raise error_in(expression, node.span, f"unknown name '{name}'", closest(name, known))
        if name not in self.inputs:
            self.inputs[name] = self._register()
        type_, register, varies = self.types[name], self.inputs[name], name in self.signals
        if varies:
            register = self._in_window(register)
        match type_.kind:
            case Kind.BOOLEAN:
                return Sort(Form.TRUTH, (), varies), self._emit(is_true, register)
            case Kind.ENUMERATION:
                return Sort(Form.ITEM, (), varies, type_.items), register
        return Sort(Form.NUMBER, type_.unit.dimension, varies), register

    def _binary(self, expression: Expression, node: Binary) -> Typed:
        (left_sort, left), (right_sort, right) = self._sides(expression, node)
        sort = binary_sort(expression, node, left_sort, right_sort)
        return sort, self._emit(OPERATORS[node.operator], left, right)

    def _sides(self, expression: Expression, node: Binary) -> tuple[Typed, Typed]:
        if node.operator in ("==", "!="):
            for one, other in ((node.left, node.right), (node.right, node.left)):
                if isinstance(one, Name) and self._is_enumeration(one) and isinstance(other, Name):
                    items = self.types[one.path].items
                    if other.path in items:
                        item = Sort(Form.ITEM, (), False, items), self._literal(float(items.index(other.path)))
                        typed = self._name(expression, one)
                        return (typed, item) if one is node.left else (item, typed)
        return self.compile(expression, node.left), self.compile(expression, node.right)

    def _is_enumeration(self, node: Name) -> bool:
        type_ = self.types.get(node.path)
        return type_ is not None and type_.kind is Kind.ENUMERATION

    def _call(self, expression: Expression, node: Call) -> Typed:
        if node.function in ROWWISE:
            return self._rowwise(expression, node)
        function = self.functions.get(node.function) or _offered(expression, node)
        registers: list[Register] = []
        first: Dimension = ()
        for argument, given in self._arguments(expression, node, function.arguments):
            if given is None:
                registers.append(self._literal(argument.default or 0.0))
                continue
            sort, register = self.compile(expression, given)
            self._check_argument(expression, node, argument, given, sort, first)
            if (
                argument.name == "target"
                and node.function in RELATIVE_TO_TARGET
                and isinstance(given, Number)
                and not given.si
            ):
                what = f"'{node.function}' is relative to its target, which must not be zero"
                raise error_in(expression, given.span, what, "use maximum, minimum, final or steady_state_error")
            first = first if registers else sort.dimension
            registers.append(register)
        return Sort(Form.NUMBER, function.result(first), function.varies), function.emit(self._emit, *registers)

    def _arguments(
        self, expression: Expression, node: Call, wanted: tuple[Argument, ...]
    ) -> Iterable[tuple[Argument, Node | None]]:
        form = f"{node.function}({', '.join(_form(argument) for argument in wanted)})"
        if len(node.arguments) > len(wanted):
            extra = node.arguments[len(wanted)]
            raise error_in(expression, extra.span, f"too many arguments for '{node.function}'", f"the form is {form}")
        given = dict(zip((argument.name for argument in wanted), node.arguments, strict=False))
        for name, value in node.options:
            if name not in {argument.name for argument in wanted}:
                what = f"'{node.function}' has no argument '{name}'"
                raise error_in(expression, value.span, what, f"the form is {form}")
            if name in given:
                raise error_in(expression, value.span, f"'{name}' is given twice", f"the form is {form}")
            given[name] = value
        for argument in wanted:
            if argument.name not in given and argument.default is None:
                what = f"'{node.function}' needs '{argument.name}'"
                raise error_in(expression, node.span, what, f"the form is {form}")
        return [(argument, given.get(argument.name)) for argument in wanted]

    def _check_argument(
        self, expression: Expression, node: Call, argument: Argument, given: Node, sort: Sort, first: Dimension
    ) -> None:
        if argument.wants is Wants.CONDITION:
            require_truth(expression, given, sort)
        else:
            require_number(expression, given, sort)
        if sort.varies is (argument.wants is Wants.CONSTANT):
            shown = expression.text[slice(*given.span)]
            what = f"'{argument.name}' of {node.function} must be {argument.wants}; '{shown}' "
            advice = "take its final value or mean" if sort.varies else "connect or choose a port that varies in time"
            raise error_in(expression, given.span, what + ("varies" if sort.varies else "does not vary"), advice)
        if argument.share and isinstance(given, Number) and not 0 <= given.si <= 1:
            what = (
                f"'{argument.name}' of {node.function} must be between 0 % and 100 %, found {float(given.si * 100):g} %"
            )
            raise error_in(expression, given.span, what, "write a share, as 95 % or 0.95")
        if argument.wants is Wants.CONDITION or argument.any_unit:
            return
        dimension = first if argument.unit is None else parse_unit(argument.unit).dimension
        if sort.dimension != dimension:
            what = f"'{argument.name}' of {node.function} must be {describe(dimension)}, found {sort}"
            unit = si_unit(dimension)
            raise error_in(expression, given.span, what, f"give it in {unit}" if unit.symbol else "give a bare number")

    def _rowwise(self, expression: Expression, node: Call) -> Typed:
        number = 2 if node.function in ("min", "max") else 1
        if len(node.arguments) < number or (number == 1 and len(node.arguments) > 1) or node.options:
            what = f"'{node.function}' needs {'two values or more' if number == 2 else 'one value'}"
            raise error_in(expression, node.span, what, "of a waveform take minimum(…) or maximum(…)")
        compiled = [self.compile(expression, argument) for argument in node.arguments]
        for argument, (sort, _) in zip(node.arguments, compiled, strict=True):
            require_number(expression, argument, sort)
            require_alike(expression, argument.span, compiled[0][0], sort, "compare")
        function = ROWWISE[node.function]
        dimension = compiled[0][0].dimension
        if node.function == "floor" and dimension:
            advice = "divide by a unit first"
            raise error_in(expression, node.span, f"floor takes a plain number, found {compiled[0][0]}", advice)
        result = compiled[0][1]
        for _, register in compiled[1:]:
            result = self._emit(function, result, register)
        if number == 1:
            result = self._emit(function, result)
        if node.function == "sqrt":
            dimension = power(dimension, Fraction(1, 2))
        return Sort(Form.NUMBER, dimension, any(sort.varies for sort, _ in compiled)), result

    def _in_window(self, waveform: Register) -> Register:
        self.varies = True
        return waveform if self.rows is None else self._add(functions.within, waveform, self.rows)

    def _emit(self, function: Callable[..., Any], *arguments: Register) -> Register:
        return self._add(function, *[self._in_window(TIME) if each == TIME else each for each in arguments])

    def _add(self, function: Callable[..., Any], *arguments: Register) -> Register:
        key = function, arguments
        if key not in self.instructions:
            self.instructions[key] = Instruction(function, arguments, self._register())
        return self.instructions[key].target

    def _literal(self, value: float) -> Register:
        if value not in self.literals:
            self.literals[value] = self._register()
        return self.literals[value]

    def _register(self) -> Register:
        self.size += 1
        return self.size - 1


def _offered(expression: Expression, node: Call) -> Function:
    """The function of another package. Only here are packages looked for: most metrics need none."""
    if node.function not in OFFERED.names():
        known = (*OFFERED.names(), *ROWWISE)
        raise error_in(expression, node.span, f"unknown function '{node.function}'", closest(node.function, known))
    try:
        function: object = OFFERED.get(node.function)
    except DseError as error:
        raise error_in(expression, node.span, error.problems[0].what, error.problems[0].hint) from error
    if not isinstance(function, Function):
        package = OFFERED.package(node.function)
        what = f"the metric function '{node.function}' of {package} is of type {type(function).__name__}, not Function"
        raise error_in(expression, node.span, what, f"mend or uninstall {package}")
    return function


def _form(argument: Argument) -> str:
    return argument.name if argument.default is None else f"{argument.name} = {argument.default:g}"


def is_true(x: Any) -> Any:
    """Whether a recorded 0 or 1 stands for true."""
    return np.not_equal(x, 0.0)


def differs(x: Any, y: Any) -> Any:
    """x != y; false where one is NaN."""
    return np.logical_or(np.less(x, y), np.greater(x, y))


def implies(x: Any, y: Any) -> Any:
    """not x or y."""
    return np.logical_or(np.logical_not(x), y)


def select(condition: Any, yes: Any, no: Any) -> Any:
    """*yes* where the condition holds, else *no*; a waveform if one of the three is."""
    if np.ndim(condition) == np.ndim(yes) == np.ndim(no) == 0:
        return yes if condition else no
    return np.where(condition, yes, no)


OPERATORS: Mapping[str, Callable[..., Any]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "^": np.power,
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": differs,
    "and": np.logical_and,
    "or": np.logical_or,
    "xor": np.logical_xor,
    "implies": implies,
    "iff": np.equal,
}
"""The operators of the expression language."""
