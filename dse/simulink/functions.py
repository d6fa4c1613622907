"""How the functions of a generated model in C are called, with what, and which ports and parameters that shows."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from dse.errors import Location, fail
from dse.simulink.blocks import Writing
from dse.simulink.declarations import Array, CType, Declarations, Declared, Function, Named, Pointer, Record
from dse.simulink.interface import (
    MODEL,
    Data,
    Interface,
    Member,
    Port,
    Style,
    by_rate,
    flat,
    holds,
    places_of_model,
    plain_name,
)


def tasks_of(function: Function, code: str) -> list[tuple[int, str]]:
    """The tasks that a function with an argument ``tid`` chooses from, by number, and what it calls for each."""
    if not any(argument.name == "tid" for argument in function.arguments):
        return []
    found = re.search(rf"^void {re.escape(function.name)}\s*\(", code, re.MULTILINE)
    body = code[found.end() : code.find("\n}", found.end())] if found else ""
    return [(int(task), name) for task, name in re.findall(r"case (\d{1,9})\s*:\s*(\w+)\(", body)]


def functions_to_step(known: Declarations, model: str, header: str, where: Location) -> tuple[list[str], bool]:
    """The functions that make one step, in their order, and whether there is one for each rate. Raises DseError."""
    names = [
        name
        for name, function in known.functions.items()
        if re.search(r"_step\d*$", name) and (function.file == header or name.startswith(model))
    ]
    rated = by_rate(names)
    if f"{model}_step" in names and len(rated) < 2:
        return [f"{model}_step"], False
    if rated:
        return rated, True
    if names:
        return names[:1], False
    apart = [f"{model}_output", f"{model}_update"]
    if all(name in known.functions for name in apart):
        return apart, False
    if model in known.functions and f"{model}_initialize" in known.functions:
        what = f"'{model}' is a model that another one refers to: it has no step of its own"
        raise fail(what, where, "give the folder of the top model, which has this one below slprj")
    own = [
        n
        for n, each in known.functions.items()
        if each.file == header and not re.search(r"_(initialize|terminate)$", n)
    ]
    if own:
        what = f"'{model}' has no step: it exports functions for others to call: {', '.join(own[:5])}"
        raise fail(what, where, "call them in a model that has a step, and generate that")
    raise fail(f"'{model}' has no function '{model}_step'", where, "was it generated for another target?")


@dataclass(slots=True)
class Caller:
    """Makes the calls of a model's functions, with storage for what they are given."""

    known: Declarations
    made: Interface
    writing: Writing
    names: dict[str, str] = field(default_factory=dict)
    ports: set[str] = field(default_factory=set)

    def call(self, function: Function, *, is_step: bool, task: int = 0) -> str:
        """How *function* is called, for the *task* of this number if there are several."""
        return f"{function.name}({', '.join(self._argument(each, is_step, task) for each in function.arguments)})"

    def _argument(self, argument: Declared, is_step: bool, task: int) -> str:
        type_, name = argument.type, argument.name
        target = type_.target if isinstance(type_, Pointer) else type_
        record = self.known.record(target)
        if isinstance(type_, Pointer) and record is not None and not is_port(name):
            return "&" + self._held(record, Named(record.name))
        if isinstance(target, Pointer):
            raise fail(f"the argument '{name}' is a pointer to a pointer")
        if name == "tid":
            return str(task)
        place = f"{MODEL}->{name}"
        if name not in self.names:
            self.names[name] = place
            self.made.storage.append(Member(name, target))
        if is_step and name not in self.ports:
            self.ports.add(name)
            self._add(argument, target, place)
        return place if isinstance(target, Array) or not isinstance(type_, Pointer) else f"&{place}"

    def _add(self, argument: Declared, target: CType, place: str) -> None:
        name = argument.name
        is_written = (
            isinstance(argument.type, Pointer | Array) and not argument.is_constant and self.writing.of(name, "")
        )
        is_output = re.search(r"_Y_|^rtY_|^arg_Out", name) or (is_written and not re.search(r"_U_|^rtU_", name))
        ports = self.made.outputs if is_output else self.made.inputs
        plain = re.sub(r"^(?:rt[UY]|\w+_[UY])_(?=\w)", "", name)
        ports += flat(self.known, target, place, plain, argument.comment, self.made.warnings)

    def _held(self, record: Record, type_: CType) -> str:
        """Where a struct is kept that functions are given: one of each type."""
        if record.name not in self.names:
            if record.size <= 0:
                raise fail(f"the type {record.name} is nowhere defined")
            name = "a_" + re.sub(r"\W", "_", plain_name(record.name))
            place = self.names[record.name] = f"{MODEL}->{name}"
            self.made.storage.append(Member(name, type_))
            self.fill(type_, place)
        return self.names[record.name]

    def construct(self, function: Function, made: Pointer) -> None:
        """Let the code make its own data: *function* returns what it has *made*, which points to all it has."""
        place = f"(*{MODEL}->made)"
        self.made.storage.append(Member("made", made))
        self.made.prepare.append(f"if (!({MODEL}->made = {function.name}())) return 0;")
        record = self.known.record(made.target)
        for each in record.fields if record else ():
            inner = self.known.record(each.type.target) if isinstance(each.type, Pointer) else None
            if inner is not None and not holds(Named(inner.name), Data.MODEL):
                self.fill(Named(inner.name), f"(*{MODEL}->made->{each.name})")
        if record:
            self.names[record.name] = place
        last = self.known.functions.get(f"{function.name}_terminate")
        if last and len(last.arguments) == 1:
            self.made.terminate = f"{last.name}({MODEL}->made)"  # what it has made, it frees

    def fill(self, type_: CType, place: str) -> None:
        """Take the ports and parameters of a struct, or give a model what it points to."""
        ports = self.made.ports_in(type_)
        if ports is not None:
            ports += flat(self.known, type_, place, "", "", self.made.warnings)
        elif holds(type_, Data.MODEL):
            self._link(type_, place)

    def _link(self, type_: CType, place: str) -> None:
        """Give a real-time model storage for the data it points to, as the generated main does."""
        record = self.known.record(type_)
        for each in record.fields if record else ():
            if each.name == "ModelData":
                self._link(each.type, f"{place}.ModelData")
            target = self.known.record(each.type.target) if isinstance(each.type, Pointer) else None
            if target is None or target.size <= 0 or re.search(r"Log|Sfcn|Methods", target.name):
                continue
            if target.name == (record.name if record else ""):
                continue
            if holds(Named(target.name), Data.MODEL):
                continue
            name = f"m_{each.name}"
            own = f"{MODEL}->{name}"
            self.made.storage.append(Member(name, Named(target.name)))
            self.made.prepare.append(f"{place}.{each.name} = &{own};")
            self.names[target.name] = own
            self.fill(Named(target.name), own)


def is_port(argument: str) -> bool:
    """Whether the coder names an argument as it names a port that is a bus."""
    return re.search(r"_U_|_Y_|^rtU_|^rtY_|^arg_", argument) is not None


def global_ports(known: Declarations, made: Interface, writing: Writing, imported: str) -> None:
    """Take ports and parameters that are variables of the whole program.

    Those that the header *imported* declares are for others to define: here it is done where nobody does.
    """
    own = [member.type for member in made.storage]
    for name, variable in known.variables.items():
        if variable.type in own or variable.is_constant:
            continue  # the values that an instance's own begin with
        is_imported = variable.file == imported
        whole, target = name, variable.type
        if isinstance(target, Pointer):
            whole, target = f"(*{name})", target.target
            if not is_imported and not holds(target, Data.INPUTS) and not holds(target, Data.OUTPUTS):
                continue
        into, begins = _kind_of(variable, target, made, writing)
        if into is None:
            continue
        if is_imported:
            made.imported.append(variable)
            if into is made.parameters:
                made.warnings.append(f"the value of '{name}' is not in the code: it begins as 0")
        into += flat(known, target, whole, begins, variable.comment if begins else "", made.warnings)


def _kind_of(variable: Declared, target: CType, made: Interface, writing: Writing) -> tuple[list[Port] | None, str]:
    """Where the numbers in a variable belong, and what their names begin with."""
    ports = made.ports_in(target)
    if ports is not None:
        return ports, ""
    if "Variable:" in variable.comment:
        return made.parameters, variable.name
    if "'<Root>/" in variable.comment:
        return made.outputs if writing.of(variable.name, variable.comment) else made.inputs, variable.name
    return None, ""


def style_of(ports: Sequence[Port], storage: Sequence[Member]) -> Style:
    """How a model in C keeps its data."""
    own = [port.expression.startswith((f"{MODEL}->", f"(*{MODEL}->")) for port in ports]
    if any(holds(member.type, Data.MODEL) for member in storage):
        return Style.REUSABLE if all(own) else Style.HALF_REUSABLE
    return Style.ARGUMENTS if any(own) else Style.GLOBAL


def read_interface(known: Declarations, model: str, header: str, code: str, where: Location) -> Interface:
    """How a model in C is called, from the declarations of its *header* and the text of the *code* made for it."""
    made, writing = Interface(), Writing(code)
    steps, made.is_rated = functions_to_step(known, model, header, where)
    caller = Caller(known, made, writing)
    first = next(
        (n for n in (f"{model}_initialize", re.sub(r"_step\d*$", "_initialize", steps[0])) if n in known.functions), ""
    )
    constructor = known.functions.get(model)
    if constructor and not constructor.arguments and isinstance(constructor.result, Pointer):
        caller.construct(constructor, constructor.result)
    if first:
        made.initialize = caller.call(known.functions[first], is_step=False)
    calls = [(0, name, caller.call(known.functions[name], is_step=True)) for name in steps]
    tasks = [
        (task, name, caller.call(known.functions[step], is_step=True, task=task))
        for step in steps
        for task, name in tasks_of(known.functions[step], code)
    ]
    made.is_rated |= bool(tasks)
    # All of a task before the next one, as the generated main calls them.
    made.steps = {name: call for _, name, call in sorted(tasks or calls, key=lambda each: each[0])}
    global_ports(known, made, writing, f"{model}_private.h")
    made.style = style_of([*made.inputs, *made.outputs, *made.parameters], made.storage)
    own = ((f"{MODEL}->{member.name}", member.type) for member in made.storage)
    places_of_model(known, made, iter([*own, *((name, each.type) for name, each in known.variables.items())]))
    return made
