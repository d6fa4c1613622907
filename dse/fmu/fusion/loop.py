"""The loop over a system's components, as C: its order, connections, types, checks and recording compiled in.

It does what the kernel's loops (dse/cosim/kernel) do by FMI calls, in the same order. Where one of those calls would be
refused, or a value on a wire is not finite, and at the last communication point, it stops, and leaves the rest to FMI
calls: with Jacobi before anything is changed in that step, with Gauss and Seidel before the element whose turn it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from dse.domain.method import Algorithm
from dse.domain.system import SystemStructure
from dse.fmu.fusion.layout import InstanceLayout
from dse.fmu.fusion.values import ACCESSORS, Signal, checking, declaring, finite, reading, writing


@dataclass(frozen=True, slots=True)
class FusedElement:
    """What stands for an element in the loop: the prefix of its component and where that keeps its variables."""

    prefix: str
    layout: InstanceLayout
    is_model: bool


def loop_text(
    system: SystemStructure, record: Sequence[str], elements: Sequence[FusedElement], algorithm: Algorithm
) -> str:
    """The unit that holds ``dse_fused_simulate``; *elements* are in the order of *system*'s, which are fit for it."""
    outputs = _signals(system, elements)
    pairs = _pairs(system, elements, outputs)
    lines = [
        f"/* Generated: {len(elements)} components and {len(system.wires)} connections in one loop. */",
        '#include "fused_values.h"',
    ]
    for prefix in dict.fromkeys(fused.prefix for fused in elements):
        lines += [
            f"bool {prefix}dse_fused_step(void *c, double time, double step);",
            f"bool {prefix}dse_fused_refresh(void *c, const char *function);",
            f"void {prefix}dse_fused_answer(const void *c, int64_t *status, int64_t *has_ended, double *time);",
        ]
    in_turn = algorithm is Algorithm.GAUSS_SEIDEL
    before, during = (_in_turn if in_turn else _in_parallel)(system, elements, outputs, pairs, record)
    lines += [
        "DSE_EXPORT dse_fused_loop dse_fused_simulate;",
        "int dse_fused_simulate(dse_fused_run *run) {",
        *(f"    char *const e{index} = dse_instance_at(run, {index});" for index in range(len(elements))),
        "    volatile int64_t *const progress = run->progress;",
        "    const int64_t steps = run->steps, call_step = run->call_step;",
        "    const double step = run->step;",
        "    double *row = run->out;",
        "    bool is_usual = true;",
        *(f"    {line}" for signal in outputs.values() for line in declaring(signal)),
        *(f"    {line}" for line in before),
        f"    for (int64_t k = run->first;; k++, row += {len(record)}) {{",
        "        progress[0] = 0, progress[2] = k;",
        "        if (k == steps) {",
        "            return DSE_FUSED_STOPPED;",
        "        }",
        "        /* Never accumulated: 6000 steps of 10 ms end at 60 s, not at 59.9999999999966 s. */",
        "        const double time = (double)k * step;",
        *(f"        {line}" for line in during),
        "    }",
        "}",
    ]
    return "\n".join(lines) + "\n"


_Outputs: TypeAlias = Mapping[str, Signal]
_Pairs: TypeAlias = Sequence[tuple[Signal, Signal]]
_Lines: TypeAlias = Iterator[str]

_UNUSUAL = ("if (!is_usual) {", "    return DSE_FUSED_STOPPED;", "}")
_ERROR = 3  # in both versions of FMI


def _signals(system: SystemStructure, elements: Sequence[FusedElement]) -> dict[str, Signal]:
    found: dict[str, Signal] = {}
    for index, (element, fused) in enumerate(zip(system.elements, elements, strict=True)):
        for variable in element.outputs:
            place = fused.layout.places[variable.reference]
            found[f"{element.name}.{variable.name}"] = Signal(index, len(found), variable, place, fused.is_model)
    return found


def _pairs(system: SystemStructure, elements: Sequence[FusedElement], outputs: _Outputs) -> _Pairs:
    """Every input with the output that it gets."""
    sources = {
        f"{wire.target}.{wire.target_variable}": outputs[f"{wire.source}.{wire.source_variable}"]
        for wire in system.wires
    }
    pairs: list[tuple[Signal, Signal]] = []
    for index, (element, fused) in enumerate(zip(system.elements, elements, strict=True)):
        for variable in element.inputs:
            place = fused.layout.places[variable.reference]
            target = Signal(index, len(pairs), variable, place, fused.is_model)
            pairs.append((sources[f"{element.name}.{variable.name}"], target))
    return pairs


def _in_parallel(
    system: SystemStructure, elements: Sequence[FusedElement], outputs: _Outputs, pairs: _Pairs, record: Sequence[str]
) -> tuple[_Lines, _Lines]:
    """Jacobi: what stands before the steps, and one of them."""

    def during() -> _Lines:
        # In the order in which FMI calls ask for them: those of FMI 2 first.
        may_be_unusual = False
        for index, element in sorted(enumerate(system.elements), key=lambda each: each[1].model.version):
            own = _of(outputs, index)
            if own and elements[index].is_model and may_be_unusual:
                yield from _UNUSUAL  # it would have been met before this model is asked
                may_be_unusual = False
            lines = list(_showing(index, elements[index], own, element.model.version))
            may_be_unusual |= any("is_usual" in line for line in lines)
            yield from lines
        yield from finite(source for source, _ in pairs)
        for source, target in pairs:
            yield from checking(source, target)
        yield from _UNUSUAL
        yield from _recording(outputs, record)
        yield from _writing(elements, pairs)
        for index, fused in enumerate(elements):
            yield from _stepping(index, fused)

    return iter(()), during()


def _in_turn(
    system: SystemStructure, elements: Sequence[FusedElement], outputs: _Outputs, pairs: _Pairs, record: Sequence[str]
) -> tuple[_Lines, _Lines]:
    """Gauss and Seidel: each element is given the newest values, steps, and shows its own."""

    def show(index: int) -> _Lines:
        lines = list(_showing(index, elements[index], _of(outputs, index), system.elements[index].model.version))
        yield from lines
        if any("is_usual" in line for line in lines):
            yield from _stopping_before(index + 1)

    # What an element shows to one whose turn comes later is looked at there, and is the same as the next step begins.
    first = {source.number: target.index for source, target in reversed(pairs) if source.index < target.index}

    def during() -> _Lines:
        yield from finite(source for source, _ in pairs if source.number not in first)
        yield "if (k == 0) {"
        yield from finite(source for source, _ in pairs if source.number in first)
        yield "}"
        yield from _UNUSUAL
        yield from _recording(outputs, record)
        for index, fused in enumerate(elements):
            own = [(source, target) for source, target in pairs if target.index == index]
            checks = list(finite(source for source, _ in own if first.get(source.number) == index))
            for source, target in own:
                checks += checking(source, target)
            yield from checks
            if checks:
                yield from _stopping_before(index)
            yield from _writing(elements, own)
            yield from _stepping(index, fused)
            yield from show(index)

    return (line for index in range(len(elements)) for line in show(index)), during()


def _of(outputs: _Outputs, index: int) -> list[Signal]:
    return [signal for signal in outputs.values() if signal.index == index]


def _showing(index: int, fused: FusedElement, own: Sequence[Signal], version: int) -> _Lines:
    if own and fused.is_model:
        number, accessor = min(ACCESSORS[version][signal.variable.fmi_type] for signal in own)
        yield f"progress[0] = {index}, progress[1] = run->call_get + {number};"
        yield f'if (!{fused.prefix}dse_fused_refresh(e{index}, "{accessor}")) {{'
        yield f"    run->status = {_ERROR};"
        yield "    return DSE_FUSED_FAILED;"
        yield "}"
    for signal in own:
        yield from reading(signal)


def _stopping_before(index: int) -> _Lines:
    yield "if (!is_usual) {"
    yield f"    progress[0] = {index};"
    yield "    return DSE_FUSED_STOPPED;"
    yield "}"


def _recording(outputs: _Outputs, record: Sequence[str]) -> _Lines:
    for column, name in enumerate(record):
        yield f"row[{column}] = {outputs[name].real};"


def _writing(elements: Sequence[FusedElement], pairs: _Pairs) -> _Lines:
    yield from writing(pairs)
    for index in dict.fromkeys(target.index for _, target in pairs if target.is_model):
        yield f"dse_put_u16(e{index} + {elements[index].layout.changed_at}, 1);"


def _stepping(index: int, fused: FusedElement) -> _Lines:
    yield f"progress[0] = {index}, progress[1] = call_step;"
    yield f"if (!{fused.prefix}dse_fused_step(e{index}, time, step)) {{"
    yield f"    {fused.prefix}dse_fused_answer(e{index}, &run->status, &run->has_ended, &run->time);"
    yield "    return DSE_FUSED_FAILED;"
    yield "}"
