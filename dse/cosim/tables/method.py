"""A method and a wired system as the tables of operations that the kernel carries out (plan.h)."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding import plan_layout as layout
from dse.cosim.binding.layout import Group, Groups
from dse.cosim.tables.clocks import CompiledClocks
from dse.cosim.tables.tables import Tables
from dse.cosim.wiring.border import Border, ElementPort
from dse.cosim.wiring.check import OwnStep, extrapolation_of
from dse.cosim.wiring.clocks import Act, ClockStep
from dse.cosim.wiring.dependency import AlgebraicLoop, Read, Step, Write, doubtful_reads, order_of
from dse.cosim.wiring.wiring import Wiring
from dse.domain.fmu import Variable
from dse.domain.method import Adaptive, Algorithm, Bond, Coupling, Extrapolation, Method
from dse.domain.system import Element

READ, WRITE, SOLVE = range(3)
HELD, MIDDLE, SLOPED = range(3)

DISCRETE_SWEEPS = 20
"""How often a loop without real numbers goes round at most before it counts as having no solution, besides the sweeps
that settle a loop that is none."""


class Columns(NamedTuple):
    """Where recorded columns come from: *positions* of values (0 for others), *energies* of bonds as (column, bond),
    *counts* of clocks as (column, whether of ticks, clock or step)."""

    positions: tuple[int, ...]
    energies: tuple[tuple[int, int], ...]
    counts: tuple[tuple[int, bool, int], ...]


class CompiledMethod:
    """How *tables*' system is simulated by *method*; owns all memory that *structure* points into.

    *energies* are the columns of the record that hold energies of bonds, with the numbers of the bonds. *loops* are
    numbered as in the kernel's failures. One step of the run at a time is fitted: see :meth:`fit`.
    """

    def __init__(self, tables: Tables, method: Method, columns: Columns) -> None:
        self.loops: list[AlgebraicLoop] = []
        self._tables, self._wiring, self._method = tables, tables.wiring, method
        self._kept: list[Any] = []
        self._border = Border(self._wiring)
        orders = [order_of(self._wiring, initially=True)]
        if method.coupling is not Coupling.NONE:
            orders.append(order_of(self._wiring, initially=False))
        doubtful = doubtful_reads(self._wiring)
        everything = tuple(
            Write(e, tuple(port for port in ports if not self._border.is_clocked(port)))
            for e, ports in enumerate(self._border.inputs)
        )
        # An order that believes no FMU writes every input once, too.
        reserve = tuple(Write(e, tuple(ports)) for e, ports in enumerate(self._border.inputs)) if doubtful else ()
        n_staged = sum(self._n_values(write) for order in (*orders, everything, reserve) for write in _writes(order))
        n_staged += sum(step.variable.size for step in self._wiring.clocks.steps if step.act is Act.DELIVER)
        self._staged, self._slopes, self._used = (np.zeros(n_staged) for _ in range(3))
        self._sources, self._moves = (np.zeros(n_staged, np.int32) for _ in range(2))
        self._next = 0
        self.structure = layout.Plan(
            is_sequential=method.algorithm is Algorithm.GAUSS_SEIDEL,
            n_leading=len(method.leading),
            owners=self._integers(self._wiring.owners),
            staged=self._address(self._staged),
            slopes=self._address(self._slopes),
            sources=self._address(self._sources),
            moves=self._address(self._moves),
            used=self._address(self._used),
        )
        self.structure.initial = self._sweep(orders[0])
        if len(orders) > 1:
            self.structure.meeting = self._sweep(orders[1])
        self._paces = (layout.Pace * len(everything))(*(self._pace(write) for write in everything))
        self.structure.paces = ctypes.addressof(self._paces)
        self._doubt(doubtful)
        self._watch()
        self._bond(method.bonds, columns.energies)
        self._remember()
        if method.adaptive:
            self._adapt(method.adaptive)
        self._clocks = CompiledClocks(tables, self._operation_at_tick, columns.counts)
        self._clocks.enter(self.structure)
        tables.publish()

    def fit(self, steps: Sequence[OwnStep]) -> None:
        """Take these own steps of the elements from now on."""
        for pace, own in zip(self._paces, steps, strict=True):
            pace.every, pace.parts = own.every, own.parts

    def distrust_dependencies(self) -> None:
        """Be ready for FMUs whose dependencies in the initialization are not true: from now on the kernel goes on by
        itself where it stopped with MISLED."""
        self.structure.untold = self._sweep(order_of(self._wiring, initially=True, told=False))
        self._tables.publish()

    def _sweep(self, order: Sequence[Step]) -> layout.Sweep:
        operations = (layout.Operation * len(order))(*(self._operation(step) for step in order))
        self._kept.append(operations)
        begin = ctypes.addressof(operations)
        return layout.Sweep(begin, begin + ctypes.sizeof(operations))

    def _operation(self, step: Step, slopes: NDArray[np.float64] | None = None) -> layout.Operation:
        if isinstance(step, AlgebraicLoop):
            return layout.Operation(kind=SOLVE, loop=self._loop(step))
        names = [self._border.variable(port).name for port in step.ports]
        if isinstance(step, Read):
            return self._reading(step.element, names)
        return self._writing(step.element, names, slopes)

    def _operation_at_tick(self, step: ClockStep) -> layout.Operation:
        act = self._reading if step.act is Act.SAMPLE else self._writing
        return act(step.element, [step.variable.name])

    def _reading(self, element: int, names: Sequence[str]) -> layout.Operation:
        return layout.Operation(kind=READ, element=element, groups=self._tables.reading(element, names))

    def _writing(
        self, element: int, names: Sequence[str], slopes: NDArray[np.float64] | None = None
    ) -> layout.Operation:
        first = self._next
        groups, sources = self._tables.writing(element, names, self._staged, first, slopes)
        count = len(sources)
        self._sources[first : first + count] = sources
        self._next += count
        return layout.Operation(kind=WRITE, element=element, groups=groups, first=first, count=count)

    def _loop(self, loop: AlgebraicLoop) -> int:
        reals, others = (self._positions(ports) for ports in (loop.reals, loop.others))
        n, m = len(reals) + len(others), len(reals)
        n_texts = sum(not self._border.values[port] for port in loop.others)
        structure = layout.Loop(
            sweep=self._sweep(loop.sweep),
            torn=self._integers([*reals, *others]),
            n_reals=m,
            n_torn=n,
            sweeps=n + n_texts + 1 + (0 if m else DISCRETE_SWEEPS),
            number=len(self.loops),
            has_texts=bool(n_texts),
            nominals=self._numbers(self._nominals(loop.reals)),
            room=self._zeros(5 * n),
            rows=self._zeros(m * m),
            pivots=self._address(np.zeros(m, np.uint32)),
            way=self._zeros(m),
        )
        self.loops.append(loop)
        self._kept.append(structure)
        return ctypes.addressof(structure)

    def _pace(self, write: Write) -> layout.Pace:
        is_linear = extrapolation_of(self._wiring.system.elements[write.element], self._method) is Extrapolation.LINEAR
        operation = self._operation(write, self._slopes if is_linear else None)
        sloped = self._sloped(operation.groups) if is_linear else frozenset()
        if is_linear:
            for i, moves in enumerate((each for p in write.ports for each in self._border.moves(p)), operation.first):
                if moves:
                    self._moves[i] = SLOPED if i in sloped else MIDDLE
        return layout.Pace(every=1, parts=1, has_slopes=bool(sloped), inputs=operation)

    def _sloped(self, groups: Groups) -> frozenset[int]:
        """Which of the staged inputs the element takes slopes for."""
        size = ctypes.sizeof(Group)
        first = int(self._staged.ctypes.data)
        found: set[int] = set()
        for address in range(groups.fmi2 or 0, groups.end or 0, size):
            group = Group.from_address(address)
            if group.slopes:
                at = (group.values - first) // self._staged.itemsize
                found.update(range(at, at + group.n_values))
        return frozenset(found)

    def _doubt(self, reads: Sequence[Read]) -> None:
        ports = [port for read in reads for port in read.ports]
        reals = [port for port in ports if self._border.is_real(port)]
        at = self._positions([*reals, *(port for port in ports if not self._border.is_real(port))])
        nominals = self._nominals(reals)
        plan = self.structure
        plan.doubtful = self._sweep(reads)
        plan.doubted = self._integers(at)
        plan.n_doubted_reals, plan.n_doubted = len(nominals), len(at)
        plan.doubted_nominals = self._numbers(nominals)
        plan.passed_on = self._zeros(len(at))

    def _watch(self) -> None:
        wired = set(self._wiring.wired)
        elements = self._wiring.system.elements
        watched = [
            (at, declared_nominal(elements[port.element], self._border.variable(port)))
            for port in self._border.floating_outputs
            for at in self._border.values[port]
            if at in wired
        ]
        plan = self.structure
        plan.watched = self._integers([at for at, _ in watched])
        plan.nominals = self._numbers([nominal for _, nominal in watched])
        plan.limits = self._zeros(len(watched))
        plan.n_watched = len(watched)

    def _bond(self, bonds: Sequence[Bond], energies: Sequence[tuple[int, int]]) -> None:
        values, owners = self._wiring.values, self._wiring.owners
        ends = [(values.index(bond.effort), values.index(bond.flow)) for bond in bonds]
        structures = [
            layout.Bond(effort, flow, self._used_at(owners[flow], effort), self._used_at(owners[effort], flow))
            for effort, flow in ends
        ]
        plan = self.structure
        plan.bonds, plan.n_bonds = self._array(layout.Bond, structures), len(bonds)
        plan.bond_columns = self._array(layout.BondColumn, [layout.BondColumn(*energy) for energy in energies])
        plan.n_bond_columns = len(energies)

    def _used_at(self, element: int, position: int) -> int:
        inputs = self._paces[element].inputs
        sources = self._sources[inputs.first : inputs.first + inputs.count].tolist()
        return int(inputs.first) + int(sources.index(position))

    def _remember(self) -> None:
        n, elements = len(self._wiring.values), len(self._wiring.system.elements)
        bonds = len(self._method.bonds)
        past = np.zeros(n + 2 * elements + 3 * bonds)
        at = self._address(past)
        self.structure.past, self.structure.n_past = at, past.size
        sizes = {"before": n, "shown": elements, "spans": elements, "energies": bonds, "met": 2 * bonds}
        for name, size in sizes.items():
            setattr(self.structure, name, at)
            at += past.itemsize * size

    def _adapt(self, adaptive: Adaptive) -> None:
        compared = self._positions(self._border.real_outputs)
        plan = self.structure
        plan.tolerance, plan.absolute, plan.smallest = adaptive.tolerance, adaptive.absolute, adaptive.smallest
        plan.compared = self._integers(compared)
        plan.n_compared = len(compared)
        plan.magnitudes, plan.coarse = self._zeros(len(compared)), self._zeros(len(compared))
        plan.kept = self._zeros(len(self._wiring.values) + plan.n_past)
        plan.reads_again = bool(self._wiring.texts)

    def _positions(self, ports: Sequence[ElementPort]) -> list[int]:
        return [at for port in ports for at in self._border.values[port]]

    def _nominals(self, ports: Sequence[ElementPort]) -> list[float]:
        elements = self._wiring.system.elements
        return [
            nominal_of(elements[port.element], self._border.variable(port))
            for port in ports
            for _ in self._border.values[port]
        ]

    def _n_values(self, write: Write) -> int:
        return len(self._positions(write.ports))

    def _array(self, structure: Any, items: Sequence[Any]) -> int:
        array = (structure * len(items))(*items)
        self._kept.append(array)
        return ctypes.addressof(array)

    def _integers(self, values: Sequence[int]) -> int:
        return self._address(np.array(values, np.int32))

    def _numbers(self, values: Sequence[float]) -> int:
        return self._address(np.array(values, np.float64))

    def _zeros(self, count: int) -> int:
        return self._address(np.zeros(count))

    def _address(self, array: NDArray[Any]) -> int:
        self._kept.append(array)
        return int(array.ctypes.data)


def columns_of(wiring: Wiring, method: Method, names: Sequence[str]) -> Columns:
    """Where what is called *names* comes from. DseError naming what is not to be had."""
    bonds = {f"bonds.{bond.name}": number for number, bond in enumerate(method.bonds)}
    counted = wiring.clocks.counted(wiring.system)
    positions = iter(wiring.record([name for name in names if name not in bonds and name not in counted]))
    return Columns(
        tuple(0 if name in bonds or name in counted else next(positions) for name in names),
        tuple((column, bonds[name]) for column, name in enumerate(names) if name in bonds),
        tuple((column, *counted[name]) for column, name in enumerate(names) if name in counted),
    )


def nominal_of(element: Element, variable: Variable) -> float:
    """Size of the values that are usual for *variable*, outside of the FMU; 1 if the FMU does not tell (FMI 2.2.7)."""
    conversion = element.conversions.get(variable.name)
    nominal = abs((variable.nominal or 1.0) * (conversion.factor if conversion else 1.0))
    return nominal if nominal > 0.0 else 1.0


def declared_nominal(element: Element, variable: Variable) -> float:
    """The same, but infinite if the FMU does not tell: what is too large for *variable* is not known then."""
    return nominal_of(element, variable) if variable.nominal else inf


def _writes(order: Sequence[Step]) -> list[Write]:
    found: list[Write] = []
    for step in order:
        found += _writes(step.sweep) if isinstance(step, AlgebraicLoop) else [step] if isinstance(step, Write) else []
    return found
