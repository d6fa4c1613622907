"""Simulations of one system, one kernel call per run."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from types import MappingProxyType, TracebackType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding import layout
from dse.cosim.binding.fused import fitted, loop_of
from dse.cosim.binding.library import occupy, vacate
from dse.cosim.clock import end_of, steps_in
from dse.cosim.failure.diagnosis import diagnose
from dse.cosim.failure.run_failed import RunFailed, StopReason
from dse.cosim.feasibility import refusals
from dse.cosim.instance_budget import InstanceBudget
from dse.cosim.tables.method import CompiledMethod, columns_of
from dse.cosim.tables.tables import Tables
from dse.cosim.wiring.check import check_wired, is_plain, own_steps
from dse.cosim.wiring.wiring import wire_up
from dse.domain.facts import FmuFacts, Question
from dse.domain.fused import FusedLibrary
from dse.domain.method import PLAIN, Method
from dse.domain.system import SystemStructure
from dse.errors import fail, raise_if_any

__all__ = ["RunFailed", "Simulator"]

_NO_START: Mapping[str, float] = MappingProxyType({})
_NOTHING_KNOWN: Mapping[str, FmuFacts] = MappingProxyType({})


class _Run(NamedTuple):
    stop: float
    step: float
    steps: int
    out: NDArray[np.float64]


class _Misled(Exception):  # noqa: N818  # not an error: the run is made again
    """FMUs' dependencies are not true."""


class Simulator:
    """Runs *system* again and again; *record* names the outputs to record, in order (``element.fmi_variable``).

    Loads each FMU library once and owns the instances; close it, or use it in a ``with`` block. The first run is on
    fresh instances. On the second the FMUs' reset is put to the proof: the run is made on reset instances and again on
    fresh ones, and every output of every step is compared, bit for bit. From then on instances are reset if that made
    no difference, and made anew before each run if it did. After a failed run they are made anew in any case, and
    before a run that does not give all start values that runs have given to the present instances. If fresh instances
    differ from each other as well, this run and all later ones fail: no result would be the right one.

    *reset_is_trusted* tells the outcome, None before the proof; set it to False to do without resets from the start.
    *reset_differs* names the elements whose outputs were the first to differ. *progress* is a writable buffer of
    :data:`dse.cosim.failure.progress.PROGRESS_BYTES` in which the kernel keeps note of the FMI call it is in.

    *method* is the co-simulation algorithm. With bonds in it, *record* may name their residual energies as
    ``bonds.NAME``. A clock is recorded as the number of its ticks so far, a string or binary that belongs to clocks and
    is passed on as the number of its bytes so far. A run that diverges fails: if a wired output is not finite at a
    communication point, or larger at the end than 2^53 times the nominal value that its FMU declares and its first one.

    A run in which an FMU asks to end the simulation ends there: *ended* tells, of the last run, who and when.

    *facts* tell what is known of elements: those that lie about their reset are never reset, and *runs_left* counts
    down where a process bears only so many instances.

    *fused* is the library that `dse.fmu.fusion` compiled for this system, record and method: it takes the
    place of the FMUs and of the loop over FMI calls, with the same results and failures.

    Raises DseError if the system cannot be simulated (a library that does not load, a wire to a string, …).
    One simulator must not be used from two threads at a time.
    """

    def __init__(
        self,
        system: SystemStructure,
        record: Sequence[str],
        *,
        method: Method = PLAIN,
        progress: memoryview | None = None,
        facts: Mapping[str, FmuFacts] = _NOTHING_KNOWN,
        fused: FusedLibrary | None = None,
    ) -> None:
        raise_if_any(refusals(system, method, facts))
        self.system = system = system if fused is None else fitted(fused, system, record, method)
        self.method = method
        self.reset_differs = tuple(name for name, known in facts.items() if known.denies(Question.RESETS))
        # Two runs of what is live need not be the same: nothing can be proved by them, and each is a session outside.
        is_live = any(element.model.is_live for element in system.elements)
        self.reset_is_trusted: bool | None = False if self.reset_differs or is_live else None
        self.ended = ""
        self._budget = InstanceBudget(system, facts)
        wiring = wire_up(system)
        check_wired(wiring, method)
        columns = columns_of(wiring, method, record)
        self._record = np.array(columns.positions, np.int32)
        self._kernel = layout.kernel()
        self._tables = Tables(wiring, progress, plain=is_plain(method))
        self._compiled = CompiledMethod(self._tables, method, columns)
        self._tables.system.plan = ctypes.addressof(self._compiled.structure)
        self._tables.system.fused = None if fused is None else loop_of(fused)
        self._system = ctypes.byref(self._tables.system)
        self._request = layout.Request(record=self._record.ctypes.data, n_record=self._record.size)
        self._fitted = (0.0, 0.0)
        self._occupied = occupy(system)
        self._can_reset = False
        self._given: frozenset[str] = frozenset()  # start values that runs have given to the present instances
        self._lost: RunFailed | None = None
        self._closed = False

    def run(
        self,
        *,
        stop: float,
        step: float,
        start: Mapping[str, float] = _NO_START,
        out: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Simulate from 0 to *stop* in steps of *step* (seconds).

        *start* gives values to parameters and unconnected inputs by ``element.fmi_variable``, for this run only and
        before those of ``Element.start``. Returns an array of shape ``(round(stop/step) + 1, len(record))``, row k
        holding the outputs at time ``k * step``: a fresh one, or *out* if it is given (float64, C order, that shape;
        after a failed run its contents mean nothing). If an FMU asks to end the simulation, these are the rows up to
        the last one that all elements have come to. Raises RunFailed if an FMU fails, DseError for an impossible
        request.
        """
        if self._closed:
            raise ValueError("the simulator is closed")
        if self._lost:
            raise self._lost
        steps = steps_in(stop, step)
        if (stop, step) != self._fitted:
            self._compiled.fit(own_steps(self.system, self.method, stop=stop, step=step))
            self._fitted = (stop, step)
        out = self._rows(steps, out)
        starts = self._tables.starts
        if not starts.covers(start):
            own = {f"{element.name}.{name}" for element in self.system.elements for name in element.start}
            self._tables.set_starts(sorted(start.keys() - own))
            starts = self._tables.starts
            # The proof of a reset says nothing about what this run leaves at the FMU's own value and others have set.
            self._can_reset = self._can_reset and self._given <= starts.extra
        starts.take(start)
        run = _Run(end_of(stop, step, steps), step, steps, out)
        try:
            return self._make(run)
        except _Misled:
            # Rare, and the order that believes no FMU takes its time to find: only where it is needed.
            self._compiled.distrust_dependencies()
            return self._make(run)

    def _make(self, run: _Run) -> NDArray[np.float64]:
        if self._can_reset and self.reset_is_trusted is None:
            return self._prove_reset(run)
        if self._can_reset and self.reset_is_trusted and self._reset():
            return self._simulate(run)
        self._renew()
        return self._simulate(run)

    @property
    def runs_left(self) -> int | None:
        """How many more runs this process may make of the system; None for any number."""
        return 0 if self._lost else self._budget.runs_left

    @property
    def fused_steps(self) -> int:
        """How many steps of the last run were made by the loop of the fused library."""
        return int(self._tables.system.fused_steps)

    def close(self) -> None:
        """Free the instances and let go of the progress block. Safe to call twice."""
        if self._closed:
            return
        self._closed = True
        self._kernel.dse_free(self._system)
        self._tables.release()
        if not (self._lost and self._lost.fatal):
            vacate(self._occupied)

    def __enter__(self) -> Simulator:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _rows(self, steps: int, out: NDArray[np.float64] | None) -> NDArray[np.float64]:
        shape = (steps + 1, self._record.size)
        if out is None:
            try:
                return np.empty(shape, np.float64)
            except (MemoryError, ValueError) as error:
                raise fail(
                    f"{shape[0]} rows of {shape[1]} outputs do not fit into memory", hint="use longer steps"
                ) from error
        if out.shape != shape or out.dtype != np.float64 or not out.flags.c_contiguous or not out.flags.writeable:
            raise ValueError(f"out must be a writeable float64 array of shape {shape} in C order")
        return out

    def _simulate(self, run: _Run, digests: NDArray[np.uint64] | None = None) -> NDArray[np.float64]:
        request = self._request
        request.stop, request.step, request.steps = run.stop, run.step, run.steps
        request.out = run.out.__array_interface__["data"][0]
        request.digests = None if digests is None else digests.ctypes.data
        self._can_reset = False
        failed = self._call_kernel()
        if failed and self._tables.system.failure.kind == StopReason.FLOATING_CHANGED:
            # The loop looks once, at the end of a run: which FMU it was shows when each step is looked at.
            failed = self._simulate_watched()
        if failed and self._tables.system.failure.kind == StopReason.MISLED:
            raise _Misled
        if failed:
            raise self._failure(run.step)
        self._can_reset = True
        self.ended = str(self._failure(run.step)) if self._tables.system.has_ended else ""
        return run.out[: self._tables.system.rows] if self.ended else run.out

    def _simulate_watched(self) -> int:
        self._renew()
        self._tables.system.watches = 1
        try:
            return self._call_kernel()
        finally:
            self._tables.system.watches = 0

    def _call_kernel(self) -> int:
        self._given |= self._tables.starts.extra
        return int(self._kernel.dse_run(self._system, ctypes.byref(self._request)))

    def _reset(self) -> bool:
        if not self._kernel.dse_reset(self._system):
            return True
        failure = self._failure(0.0)
        self.reset_is_trusted, self.reset_differs = False, (failure.element,)
        if failure.fatal:
            raise failure
        return False

    def _renew(self) -> None:
        self._kernel.dse_free(self._system)
        self._given = frozenset()
        self._budget.note()
        self._tables.elements.renew_folders()
        if self._kernel.dse_instantiate(self._system):
            raise self._failure(0.0)

    def _prove_reset(self, run: _Run) -> NDArray[np.float64]:
        after_reset, fresh = (np.zeros((run.steps + 1, len(self.system.elements)), np.uint64) for _ in range(2))
        failed_at = None
        if self._reset():
            try:
                self._simulate(run, after_reset)
            except RunFailed as failure:
                if failure.fatal:
                    raise
                failed_at = failure.element
        self._renew()
        out = self._simulate(run, fresh)  # if this fails too, the run is at fault and the reset still unproven
        if self.reset_is_trusted is None:
            self.reset_differs = (failed_at,) if failed_at else self._differing(after_reset, fresh)
            self.reset_is_trusted = not self.reset_differs
        if not self.reset_is_trusted:
            self._prove_renewal(run, fresh)
        return out

    def _prove_renewal(self, run: _Run, fresh: NDArray[np.uint64]) -> None:
        """What is not reset may as well be nowhere in the instance: then fresh ones differ from each other, too."""
        again = np.zeros_like(fresh)
        self._renew()
        self._simulate(run, again)
        if names := self._differing(again, fresh):
            what = (
                f"{', '.join(names)}: the outputs of two fresh instances differ: what it computes depends on what was "
                f"simulated before in this process, or on chance; `dse probe` finds out, and gives each run a process"
            )
            self._lost = RunFailed(names[0], what)
            raise self._lost

    def _differing(self, a: NDArray[np.uint64], b: NDArray[np.uint64]) -> tuple[str, ...]:
        """Elements whose outputs were the first to differ; () if all are equal."""
        differs = a != b
        first = differs[differs.any(axis=1).argmax()]
        return tuple(element.name for element, differ in zip(self.system.elements, first, strict=True) if differ)

    def _failure(self, step: float) -> RunFailed:
        failure = diagnose(self._tables, self._compiled.loops, step)
        if failure.fatal:
            self._abandon(failure)
        return failure

    def _abandon(self, failure: RunFailed) -> None:
        """After a fatal error no function of that library may be called any more, not even to free an instance."""
        self._lost = failure
        library = self.system.element(failure.element).model.library
        for element, structure in zip(self.system.elements, self._tables.elements.structures, strict=True):
            if element.model.library == library:
                structure.instance = None
