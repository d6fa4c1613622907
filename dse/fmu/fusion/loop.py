"""The loop over a system's components, as C: Jacobi with the connections, types, checks and recording compiled in.

It does what the kernel's loop (dse/cosim/kernel/kernel.c) does by FMI calls, in the same order. Where one of those
calls would be refused, or a value on a wire is not finite, and at the last communication point, it stops before
anything is changed, and leaves the rest to FMI calls.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from dse.domain.system import SystemStructure
from dse.fmu.fusion.layout import InstanceLayout
from dse.fmu.fusion.values import ACCESSORS, Signal, checking, reading, writing


@dataclass(frozen=True, slots=True)
class FusedElement:
    """What stands for an element in the loop: the prefix of its component and where that keeps its variables."""

    prefix: str
    layout: InstanceLayout
    is_model: bool


def loop_text(system: SystemStructure, record: Sequence[str], elements: Sequence[FusedElement]) -> str:
    """The unit that holds ``dse_fused_simulate``; *elements* are in the order of *system*'s, which are fit for it."""
    outputs = _signals(system, elements)
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
    lines += [
        "DSE_EXPORT dse_fused_loop dse_fused_simulate;",
        "int dse_fused_simulate(dse_fused_run *run) {",
        *(f"    char *const e{index} = dse_instance_at(run, {index});" for index in range(len(elements))),
        "    volatile int64_t *const progress = run->progress;",
        "    const int64_t steps = run->steps, call_step = run->call_step;",
        "    const double step = run->step;",
        "    double *row = run->out;",
        f"    for (int64_t k = 0;; k++, row += {len(record)}) {{",
        "        bool is_usual = true;",
        "        progress[2] = k;",
        "        if (k == steps) {",
        "            return DSE_FUSED_STOPPED;",
        "        }",
        *_indented(_reading(system, elements, outputs)),
        *_indented(_exchange(system, elements, outputs, record)),
        "        /* Never accumulated: 6000 steps of 10 ms end at 60 s, not at 59.9999999999966 s. */",
        "        const double time = (double)k * step;",
        *_indented(_stepping(elements)),
        "    }",
        "}",
    ]
    return "\n".join(lines) + "\n"


_Outputs = Mapping[str, Signal]

_UNUSUAL = ("if (!is_usual) {", "    return DSE_FUSED_STOPPED;", "}")
_ERROR = 3  # in both versions of FMI


def _signals(system: SystemStructure, elements: Sequence[FusedElement]) -> dict[str, Signal]:
    found: dict[str, Signal] = {}
    for index, (element, fused) in enumerate(zip(system.elements, elements, strict=True)):
        for variable in element.outputs:
            place = fused.layout.places[variable.reference]
            found[f"{element.name}.{variable.name}"] = Signal(index, len(found), variable, place, fused.is_model)
    return found


def _reading(system: SystemStructure, elements: Sequence[FusedElement], outputs: _Outputs) -> Iterator[str]:
    """All outputs, in the order in which FMI calls ask for them: those of FMI 2 first."""
    may_be_unusual = False
    for index, element in sorted(enumerate(system.elements), key=lambda each: each[1].model.version):
        own = [signal for signal in outputs.values() if signal.index == index]
        if own and elements[index].is_model:
            if may_be_unusual:
                yield from _UNUSUAL  # it would have been met before this model is asked
                may_be_unusual = False
            number, accessor = min(ACCESSORS[element.model.version][signal.variable.fmi_type] for signal in own)
            yield from _refreshing(index, elements[index].prefix, number, accessor)
        for signal in own:
            lines = list(reading(signal))
            may_be_unusual |= any("is_usual" in line for line in lines)
            yield from lines


def _refreshing(index: int, prefix: str, type_number: int, accessor: str) -> Iterator[str]:
    yield f"progress[0] = {index}, progress[1] = run->call_get + {type_number};"
    yield f'if (!{prefix}dse_fused_refresh(e{index}, "{accessor}")) {{'
    yield f"    run->status = {_ERROR};"
    yield "    return DSE_FUSED_FAILED;"
    yield "}"


def _exchange(
    system: SystemStructure, elements: Sequence[FusedElement], outputs: _Outputs, record: Sequence[str]
) -> Iterator[str]:
    """Check what goes over the wires, record, and write all inputs."""
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
    for value in sorted({source.number for source, _ in pairs if source.is_real}):
        yield f"is_usual &= v{value} - v{value} == 0.0; /* finite */"
    for source, target in pairs:
        yield from checking(source, target)
    yield from _UNUSUAL
    for column, name in enumerate(record):
        yield f"row[{column}] = {outputs[name].real};"
    for source, target in pairs:
        yield from writing(source, target)
    for index in dict.fromkeys(target.index for _, target in pairs if target.is_model):
        yield f"dse_put_u16(e{index} + {elements[index].layout.changed_at}, 1);"


def _stepping(elements: Sequence[FusedElement]) -> Iterator[str]:
    for index, fused in enumerate(elements):
        yield f"progress[0] = {index}, progress[1] = call_step;"
        yield f"if (!{fused.prefix}dse_fused_step(e{index}, time, step)) {{"
        yield f"    {fused.prefix}dse_fused_answer(e{index}, &run->status, &run->has_ended, &run->time);"
        yield "    return DSE_FUSED_FAILED;"
        yield "}"


def _indented(lines: Iterator[str]) -> Iterator[str]:
    return (f"        {line}" for line in lines)
