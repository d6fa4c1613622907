"""What a generated model is from outside: its ports and parameters, and how its functions are called."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum

from dse.errors import fail
from dse.simulink.declarations import (
    Array,
    CType,
    Declarations,
    Declared,
    Named,
    Pointer,
    Scalar,
)

MODEL = "m"
"""What a model's own storage is called in expressions: a pointer to it."""

_MOST_ELEMENTS = 4096
_MOST_PORTS = 20_000
_DEEPEST = 64


class Style(StrEnum):
    """Where the coder has put a model's data."""

    GLOBAL = "global"
    REUSABLE = "reusable"
    HALF_REUSABLE = "half-reusable"
    CLASS = "class"
    ARGUMENTS = "arguments"


class Data(StrEnum):
    """What a struct of a model holds, by the beginning of its type's name."""

    INPUTS = r"(?:ExtU|ExternalInputs)"
    OUTPUTS = r"(?:ExtY|ExternalOutputs)"
    PARAMETERS = r"(?:P_|P$|Parameters_)"
    MODEL = r"(?:RT_MODEL|rtModel|tag_RTM)"


@dataclass(frozen=True, slots=True)
class Port:
    """A number that goes in or comes out: *expression* is its place in C, *block* what the comment says of it."""

    name: str
    expression: str
    scalar: Scalar
    block: str = ""

    @property
    def place(self) -> str:
        """Its name with what holds it in the code: ``rtU.speed``."""
        return re.sub(rf"^(?:{MODEL}->)?(?:object->)?", "", self.expression)


@dataclass(frozen=True, slots=True)
class Member:
    """A member of a model's own storage."""

    name: str
    type: CType


@dataclass(slots=True)
class Interface:
    """*storage* belongs to an instance; *prepare* are statements before *initialize*, *steps* one call a rate,
    *terminate* frees what the code has made by itself.

    *solver* is the place of the record of its solver, if it integrates by itself, *error* that of what went wrong,
    *end* that of the time at which it would stop; *imported* are variables that the code leaves to others to define.
    """

    style: Style = Style.GLOBAL
    inputs: list[Port] = field(default_factory=list)
    outputs: list[Port] = field(default_factory=list)
    parameters: list[Port] = field(default_factory=list)
    storage: list[Member] = field(default_factory=list)
    prepare: list[str] = field(default_factory=list)
    initialize: str = ""
    terminate: str = ""
    steps: dict[str, str] = field(default_factory=dict)
    is_rated: bool = False
    solver: str = ""
    error: str = ""
    end: str = ""
    imported: list[Declared] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def ports_in(self, type_: CType) -> list[Port] | None:
        """Where the numbers in a struct of that type belong; None if it is none of ports or parameters."""
        for what, ports in (
            (Data.INPUTS, self.inputs),
            (Data.OUTPUTS, self.outputs),
            (Data.PARAMETERS, self.parameters),
        ):
            if holds(type_, what):
                return ports
        return None


def holds(type_: CType, what: Data) -> bool:
    """Whether a type, or what it points to, is named as the coder names *what*."""
    inner = type_.target if isinstance(type_, Pointer) else type_
    return isinstance(inner, Named) and re.match(what, plain_name(inner.name)) is not None


def by_rate(names: Iterable[str]) -> list[str]:
    """Those of the functions *names* that step one rate each (``acc_step0``), the fastest first."""
    return sorted((n for n in names if re.search(r"step\d+$", n)), key=lambda n: int(re.findall(r"\d+$", n)[0]))


def plain_name(name: str) -> str:
    """A record's name without ``struct`` and without the class or namespace around it."""
    return name.removeprefix("struct ").rpartition("::")[2]


def flat(
    known: Declarations, type_: CType, expression: str, name: str, block: str = "", warnings: list[str] | None = None
) -> Iterator[Port]:
    """The numbers in something of a type, from its place in C on.

    Raises DseError for what is no number, and if there are too many.
    """
    return _flat(known, type_, expression, name, block, warnings, iter(range(_MOST_PORTS)))


def _flat(
    known: Declarations,
    type_: CType,
    expression: str,
    name: str,
    block: str,
    warnings: list[str] | None,
    left: Iterator[int],
) -> Iterator[Port]:
    # Structs of structs of structs may hold more than there is time for, and may be nothing for all that.
    if next(left, None) is None or expression.count(".") > _DEEPEST:
        what = f"'{name.partition('.')[0]}' holds more than {_MOST_PORTS:,} numbers, or structs {_DEEPEST} deep"
        raise fail(what, hint="the component needs the few that are connected: let the model have ports for them")
    match type_:
        case Scalar():
            yield Port(name, expression, type_, block)
        case Array(element, count):
            if not 0 <= count <= _MOST_ELEMENTS:
                raise fail(f"'{name}' has {count:,} elements; at most {_MOST_ELEMENTS:,} can be connected")
            for number in range(count):
                place = f"[{number}]"
                yield from _flat(known, element, expression + place, name + place, block, warnings, left)
        case Named():
            record = known.record(type_)
            for each in record.fields if record else ():
                inner = f"{name}.{each.name}" if name else each.name
                member = f"{expression}.{each.name}"
                comment = each.comment if "'<" in each.comment else block
                yield from _flat(known, each.type, member, inner, comment, warnings, left)
        case Pointer():
            if warnings is not None:
                warnings.append(f"'{name}' is a pointer and left out")
        case _:
            raise fail(f"'{name}' has the type {type_.name}, which is not a number")


def places_of_model(known: Declarations, made: Interface, fields: Iterator[tuple[str, CType]]) -> None:
    """Find the solver, the error status and the end of a real-time model among *fields*: places in C, with types."""
    for place, type_ in fields:
        if not holds(type_, Data.MODEL):
            continue
        whole, inner = (f"(*{place})", type_.target) if isinstance(type_, Pointer) else (place, type_)
        record = known.record(inner)
        for each in record.fields if record else ():
            if each.name == "solverInfo":
                made.solver = f"(*{whole}.{each.name})" if isinstance(each.type, Pointer) else f"{whole}.{each.name}"
            if each.name == "Timing":
                timing = known.record(each.type)
                if timing and any(inner.name == "tFinal" for inner in timing.fields):
                    made.end = f"{whole}.Timing.tFinal"
            if each.name == "errorStatus" and isinstance(each.type, Pointer):
                made.error = f"{whole}.{each.name}"
