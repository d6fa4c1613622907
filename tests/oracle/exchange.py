"""A model exchange element in the master written in Python: what happens inside the element is the kernel's C.

The master's algorithm is written twice, to be compared; the integration of an element between two communication points
is not part of it.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from dse.cosim.binding import layout
from dse.cosim.binding.abilities import Ability, abilities_of
from dse.cosim.binding.calls import AccessorType, Call, function_name
from dse.cosim.binding.exchange_layout import Exchange
from dse.cosim.binding.integration import Integration
from dse.cosim.binding.library import address
from dse.cosim.failure.diagnosis import failed_call
from dse.cosim.failure.run_failed import StopReason
from dse.domain.system import Element

_SET = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.POINTER(ctypes.c_double)
)
_OK, _ERROR = 0, 3


class ReferenceExchange:
    """The integration of *element*, whose instance is *handle*; *log* gives what the FMU has logged.

    Its methods raise RunFailed as the kernel's diagnosis would; *moment* is the time of a step for messages.
    """

    def __init__(self, element: Element, library: ctypes.CDLL, handle: int, log: Callable[[], tuple[str, ...]]) -> None:
        self._element = element
        self._log = log
        self._kernel = layout.kernel()
        self._integration = Integration(element.model, library, has_inputs=bool(element.inputs))
        self._structure = layout.Element(
            version=element.model.version,
            instance=handle,
            exchange=self._integration.pointer,
            abilities=abilities_of(element.model, library),
        )
        self._structure.exit_initialization = address(
            element.model, library, function_name(Call.EXIT_INITIALIZATION, element.model.version)
        )
        if self._structure.abilities & Ability.CAN_DIRECTIONAL:
            name = function_name(Call.GET_DIRECTIONAL_DERIVATIVE, element.model.version)
            self._structure.get_directional_derivative = address(element.model, library, name)
        self._system = layout.System(elements=ctypes.addressof(self._structure), n_elements=1)
        self._mover = _Mover()

    @property
    def structure(self) -> Exchange:
        """Where the integration stands."""
        return self._integration.structure

    def start(self) -> None:
        """Leave initialization mode, through the first event iteration."""
        self._check(self._kernel.dse_exchange_start(ctypes.byref(self._system)), None)

    def step(
        self,
        time: float,
        step: float,
        move: Callable[[float], None] | None = None,
        *,
        may_roll_back: bool = False,
    ) -> None:
        """From *time* over *step* (seconds); *move* sets the inputs to what they are that long after *time*."""
        self._system.may_roll_back = may_roll_back
        self._structure.moving = self._mover.groups(move)
        self._structure.moving_from = time
        failed = self._kernel.dse_exchange_step(
            ctypes.byref(self._system), ctypes.c_double(time), ctypes.c_double(step)
        )
        self._structure.moving = None
        self._mover.raise_what_was_raised()
        self._check(failed, time)

    def save(self) -> None:
        """Keep where the integration stands; the FMU's own state is kept by the caller."""
        self._kernel.dse_exchange_save(ctypes.byref(self._system))

    def restore(self) -> None:
        """Back to where it was kept."""
        self._kernel.dse_exchange_restore(ctypes.byref(self._system))

    def _check(self, failed: int, moment: float | None) -> None:
        if not failed:
            return
        failure = self._system.failure
        if failure.kind == StopReason.STEP_CUT_SHORT and failure.status:
            moment = failure.value
        raise failed_call(failure, self._element, moment, self._log())


class _Mover:
    """One made-up input of the element that moves by 1 a second: setting it calls back with the time gone by."""

    def __init__(self) -> None:
        self._move: Callable[[float], None] | None = None
        self._raised: BaseException | None = None
        self._set = _SET(self._called)
        self._slope, self._value, self._room, self._scratch = (ctypes.c_double(x) for x in (1.0, 0.0, 0.0, 0.0))
        self._group = (layout.Group * 1)(
            layout.Group(
                access=ctypes.cast(self._set, ctypes.c_void_p).value,
                room=ctypes.addressof(self._room),
                values=ctypes.addressof(self._value),
                slopes=ctypes.addressof(self._slope),
                scratch=ctypes.addressof(self._scratch),
                count=1,
                n_values=1,
                version=2,
                type=AccessorType.FLOAT64,
            )
        )
        first = ctypes.addressof(self._group)
        end = first + ctypes.sizeof(self._group)
        self._groups = layout.Groups(fmi2=first, fmi3=end, end=end)

    def groups(self, move: Callable[[float], None] | None) -> Any:
        """What Element.moving points at while *move* is to be called."""
        self._move, self._raised = move, None
        return None if move is None else ctypes.addressof(self._groups)

    def raise_what_was_raised(self) -> None:
        """An error of *move*, which could not pass through C."""
        if self._raised is not None:
            raise self._raised

    def _called(self, _instance: int, _references: int, _count: int, elapsed: Any) -> int:
        if self._move is None:
            return _ERROR
        try:
            self._move(elapsed[0])
        except BaseException as error:  # noqa: BLE001  # C cannot carry it: it is raised again after the step
            self._raised = error
            return _ERROR
        return _OK
