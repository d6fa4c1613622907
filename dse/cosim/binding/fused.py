"""A fused library in the place of FMUs, where it simulates the same system."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

from dse.domain.fused import FusedLibrary
from dse.domain.method import Method
from dse.domain.system import SystemStructure
from dse.errors import fail


def fitted(fused: FusedLibrary, system: SystemStructure, record: Sequence[str], method: Method) -> SystemStructure:
    """*system* with the FMI functions of *fused*; DseError if that was made for another system, record or method."""
    is_fused = method.is_plain_but_for_order and method.algorithm is fused.algorithm
    difference = fused.difference(system, record) if is_fused else "another method"
    if difference:
        what = f"{system.name}: {fused.path.name} was not fused for this system: this one has {difference}"
        raise fail(what, hint="fuse it again")
    if not fused.path.is_file():
        raise fail(f"{system.name}: the fused library {fused.path} is gone", hint="fuse it again")
    return fused.applied(system)


def loop_of(fused: FusedLibrary) -> int:
    """Address of the loop in the library; DseError if it cannot be loaded."""
    try:
        found = ctypes.cast(ctypes.CDLL(str(fused.path)).dse_fused_simulate, ctypes.c_void_p).value
    except (OSError, AttributeError) as error:
        raise fail(f"the fused library cannot be loaded: {error}", hint="fuse it again") from error
    if found is None:
        raise fail(f"the fused library {fused.path.name} holds no loop", hint="fuse it again")
    return found
