"""The master's algorithms in plain Python: slow, simple, and the same bits as the kernel.

They exist to be compared with: nothing here is shared with the kernel's loops, variables are read and written one by
one, and values are kept under their names. Only the order of direct dependencies is found by the same function.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding.library import load, occupy, vacate
from dse.cosim.clock import end_of, steps_in
from dse.cosim.tables.method import columns_of
from dse.cosim.tables.starts import starts_of
from dse.cosim.wiring.check import check_wired, own_steps
from dse.cosim.wiring.wiring import wire_up
from dse.domain.method import PLAIN, Method
from dse.domain.system import SystemStructure
from oracle.element import ReferenceElement
from oracle.master import Master

_NO_START: Mapping[str, float] = {}


def run_reference(
    system: SystemStructure,
    record: Sequence[str],
    *,
    stop: float,
    step: float,
    start: Mapping[str, float] = _NO_START,
    method: Method = PLAIN,
) -> NDArray[np.float64]:
    """Simulate *system* once on fresh instances; arguments, result and errors as of ``Simulator`` and its ``run``."""
    wiring = wire_up(system)
    check_wired(wiring, method)
    columns_of(wiring, method, record)
    steps = steps_in(stop, step)
    own = own_steps(system, method, stop=stop, step=step)
    starts_of(system, start)  # refuses names that cannot be set
    libraries = {element.model.library: load(element.model) for element in system.elements}
    with ExitStack() as stack:
        stack.callback(vacate, occupy(system))
        parts = [
            stack.enter_context(ReferenceElement(element, libraries[element.model.library]))
            for element in system.elements
        ]
        return Master(wiring, parts, method, own).run(record, start, end_of(stop, step, steps), step, steps)
