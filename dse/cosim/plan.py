"""A method and a wired system as the tables of operations that the kernel carries out (plan.h)."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding import plan_layout as layout
from dse.cosim.binding.layout import Group, Groups
from dse.cosim.failing import plan_failure
from dse.cosim.failing.diagnosis import moment_of
from dse.cosim.failing.failure import RunFailed
from dse.cosim.tables.tables import Tables
from dse.cosim.wiring.border import Border, Port
from dse.cosim.wiring.check import OwnStep, extrapolation_of, owner_of
from dse.cosim.wiring.dependency import Loop, Read, Step, Write, doubtful_reads, order_of
from dse.cosim.wiring.wiring import Wiring
from dse.domain.fmu import Variable
from dse.domain.method import Algorithm, Coupling, Extrapolation, Method
from dse.domain.system import Element

READ, WRITE, SOLVE = range(3)
HELD, MIDDLE, SLOPED = range(3)

DISCRETE_WALKS = 20
"""How often a loop without real numbers goes round at most before it counts as having no solution, besides the walks
that settle a loop that is none."""


class Plan:
    """How *tables*' system is simulated by *method*; owns all memory that *structure* points into.

    *loops* are numbered as in the kernel's failures. A plan fits one step of the run at a time: see :meth:`fit`.
    """

    def __init__(self, tables: Tables, method: Method, bond_columns: Sequence[tuple[int, str]]) -> None:
        self.loops: list[Loop] = []
        self._tables, self._wiring, self._method = tables, tables.wiring, method
        self._kept: list[Any] = []
        self._border = Border(self._wiring)
        orders = [order_of(self._wiring, initially=True)]
        if method.coupling is not Coupling.NONE:
            orders.append(order_of(self._wiring, initially=False))
        doubtful = doubtful_reads(self._wiring)
        everything = tuple(Write(e, tuple(range(len(part)))) for e, part in enumerate(self._border.inputs))
        # An order that believes no FMU writes every input once, too.
        reserve = everything if doubtful else ()
        n_staged = sum(self._n_values(write) for order in (*orders, everything, reserve) for write in _writes(order))
        self._staged, self._slopes, self._used = (np.zeros(n_staged) for _ in range(3))
        self._sources, self._moves = (np.zeros(n_staged, np.int32) for _ in range(2))
        self._next = 0
        self.structure = layout.Plan(
            is_sequential=method.algorithm is Algorithm.GAUSS_SEIDEL,
            owners=self._address(np.array(owner_of(self._wiring), np.int32)),
            staged=self._address(self._staged),
            slopes=self._address(self._slopes),
            sources=self._address(self._sources),
            moves=self._address(self._moves),
            used=self._address(self._used),
        )
        self.structure.initial = self._walk(orders[0])
        if len(orders) > 1:
            self.structure.meeting = self._walk(orders[1])
        self._paces = (layout.Pace * len(everything))(*(self._pace(write) for write in everything))
        self.structure.paces = ctypes.addressof(self._paces)
        self._doubt(doubtful)
        self._watch()
        self._bond(bond_columns)
        self._remember()
        self._adapt()

    def fit(self, steps: Sequence[OwnStep]) -> None:
        """Take these own steps of the elements from now on."""
        for pace, own in zip(self._paces, steps, strict=True):
            pace.every, pace.parts = own.every, own.parts

    def believe_nobody(self) -> None:
        """Be ready for FMUs whose dependencies in the initialization are not true: from now on the kernel goes on by
        itself where it stopped with MISLED."""
        self.structure.untold = self._walk(order_of(self._wiring, initially=True, told=False))

    def failure(self, step: float) -> RunFailed | None:
        """What made the master stop the last run, of this *step*, by itself; None if it was an FMU's failure."""
        found = self._tables.system.failure
        if found.kind not in set(plan_failure.Kind):
            return None
        time = moment_of(self._tables, step)
        kind, wiring = plan_failure.Kind(found.kind), self._wiring
        if kind is plan_failure.Kind.NOT_SOLVED:
            return plan_failure.not_solved(wiring, self.loops[found.position], found.value, time)
        if kind is plan_failure.Kind.NEARLY_SINGULAR:
            return plan_failure.nearly_singular(wiring, self.loops[found.position], found.value, time)
        if kind is plan_failure.Kind.NOT_SETTLED:
            return plan_failure.not_settled(wiring, self.loops[found.position], time)
        if kind is plan_failure.Kind.DIVERGED:
            return plan_failure.diverged(wiring, found.position, found.value, time or 0.0)
        if kind is plan_failure.Kind.ENDLESS_STEPS:
            return plan_failure.too_many(wiring, found.position, found.value, time or 0.0)
        return plan_failure.too_short(wiring, found.position, found.value, time or 0.0)

    def _walk(self, order: Sequence[Step]) -> layout.Walk:
        operations = (layout.Operation * len(order))(*(self._operation(step) for step in order))
        self._kept.append(operations)
        begin = ctypes.addressof(operations)
        return layout.Walk(begin, begin + ctypes.sizeof(operations))

    def _operation(self, step: Step, slopes: NDArray[np.float64] | None = None) -> layout.Operation:
        if isinstance(step, Loop):
            return layout.Operation(kind=SOLVE, loop=self._loop(step))
        if isinstance(step, Read):
            names = [self._border.outputs[step.element][place].name for place in step.places]
            return layout.Operation(kind=READ, element=step.element, groups=self._tables.reading(step.element, names))
        names = [self._border.inputs[step.element][place].name for place in step.places]
        first, count = self._next, self._n_values(step)
        groups, sources = self._tables.writing(step.element, names, self._staged, first, slopes)
        self._sources[first : first + count] = sources
        self._next += count
        return layout.Operation(kind=WRITE, element=step.element, groups=groups, first=first, count=count)

    def _loop(self, loop: Loop) -> int:
        values = self._border.values
        reals, others = ([at for port in ports for at in values[port]] for ports in (loop.reals, loop.others))
        torn = np.array([*reals, *others], np.int32)
        n, m = torn.size, len(reals)
        texts = [port for port in loop.others if not self._border.values[port]]
        nominals = [size for port in loop.reals for size in self._nominals(port)]
        structure = layout.Loop(
            walk=self._walk(loop.walk),
            torn=self._address(torn),
            n_reals=m,
            n_torn=n,
            walks=n + len(texts) + 1 + (0 if m else DISCRETE_WALKS),
            number=len(self.loops),
            has_texts=bool(texts),
            nominals=self._address(np.array(nominals, np.float64)),
            room=self._address(np.zeros(5 * n)),
            rows=self._address(np.zeros(m * m)),
            pivots=self._address(np.zeros(m, np.uint32)),
            way=self._address(np.zeros(m)),
        )
        self.loops.append(loop)
        self._kept.append(structure)
        return ctypes.addressof(structure)

    def _pace(self, write: Write) -> layout.Pace:
        is_linear = extrapolation_of(self._wiring.system.elements[write.element], self._method) is Extrapolation.LINEAR
        operation = self._operation(write, self._slopes if is_linear else None)
        sloped = self._sloped(operation.groups) if is_linear else frozenset()
        if is_linear:
            ports = (Port(write.element, False, place) for place in write.places)
            for i, moves in enumerate((each for port in ports for each in self._border.moves(port)), operation.first):
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
        ports = sorted(
            (Port(read.element, True, place) for read in reads for place in read.places),
            key=lambda port: not self._border.is_real(port),
        )
        reals = [port for port in ports if self._border.is_real(port)]
        at = [position for port in ports for position in self._border.values[port]]
        nominals = [nominal for port in reals for nominal in self._nominals(port)]
        self.structure.doubtful = self._walk(reads)
        self.structure.doubted = self._address(np.array(at, np.int32))
        self.structure.n_doubted_reals, self.structure.n_doubted = len(nominals), len(at)
        self.structure.doubted_nominals = self._address(np.array(nominals, np.float64))
        self.structure.passed_on = self._address(np.zeros(len(at)))

    def _watch(self) -> None:
        ports = [port for port in sorted(self._border.values) if port.is_output and self._border.is_floating(port)]
        wired = set(self._wiring.wired)
        elements = self._wiring.system.elements
        watched = [
            (at, declared_nominal(elements[port.element], self._border.variable(port)))
            for port in ports
            for at in self._border.values[port]
            if at in wired
        ]
        self.structure.watched = self._address(np.array([at for at, _ in watched], np.int32))
        self.structure.nominals = self._address(np.array([nominal for _, nominal in watched], np.float64))
        self.structure.limits = self._address(np.zeros(len(watched)))
        self.structure.n_watched = len(watched)

    def _bond(self, columns: Sequence[tuple[int, str]]) -> None:
        values, owners = self._wiring.values, owner_of(self._wiring)
        bonds = []
        for bond in self._method.bonds:
            effort, flow = values.index(bond.effort), values.index(bond.flow)
            bonds.append(
                layout.Bond(effort, flow, self._used_at(owners[flow], effort), self._used_at(owners[effort], flow))
            )
        numbers = {bond.name: number for number, bond in enumerate(self._method.bonds)}
        pairs = [layout.BondColumn(column, numbers[name]) for column, name in columns]
        self.structure.bonds = self._array(layout.Bond, bonds)
        self.structure.n_bonds = len(bonds)
        self.structure.bond_columns = self._array(layout.BondColumn, pairs)
        self.structure.n_bond_columns = len(pairs)

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

    def _adapt(self) -> None:
        adaptive = self._method.adaptive
        if not adaptive:
            return
        ports = [port for port in sorted(self._border.values) if port.is_output and self._border.is_real(port)]
        compared = [at for port in ports for at in self._border.values[port]]
        plan = self.structure
        plan.tolerance, plan.absolute, plan.smallest = adaptive.tolerance, adaptive.absolute, adaptive.smallest
        plan.compared = self._address(np.array(compared, np.int32))
        plan.n_compared = len(compared)
        plan.magnitudes, plan.coarse = (self._address(np.zeros(len(compared))) for _ in range(2))
        plan.kept = self._address(np.zeros(len(self._wiring.values) + plan.n_past))
        plan.reads_again = bool(self._wiring.texts)

    def _nominals(self, port: Port) -> list[float]:
        nominal = nominal_of(self._wiring.system.elements[port.element], self._border.variable(port))
        return [nominal] * len(self._border.values[port])

    def _n_values(self, write: Write) -> int:
        return sum(len(self._border.values[Port(write.element, False, place)]) for place in write.places)

    def _array(self, kind: Any, items: Sequence[Any]) -> int:
        array = (kind * len(items))(*items)
        self._kept.append(array)
        return ctypes.addressof(array)

    def _address(self, array: NDArray[Any]) -> int:
        self._kept.append(array)
        return int(array.ctypes.data)


def columns_of(
    wiring: Wiring, method: Method, names: Sequence[str]
) -> tuple[tuple[int, ...], tuple[tuple[int, str], ...]]:
    """Positions of the values called *names*, and which columns are energies of which bonds (position 0 there).

    DseError naming those that are neither.
    """
    bonds = {f"bonds.{bond.name}": bond.name for bond in method.bonds}
    positions = iter(wiring.record([name for name in names if name not in bonds]))
    columns = tuple((column, bonds[name]) for column, name in enumerate(names) if name in bonds)
    return tuple(0 if name in bonds else next(positions) for name in names), columns


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
        found += _writes(step.walk) if isinstance(step, Loop) else [step] if isinstance(step, Write) else []
    return found
