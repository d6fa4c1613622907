"""The structures and numbers that Python and the kernel share are the same in both: the compiler is asked."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Iterator, Mapping

import pytest

from dse import csolve
from dse.cosim.binding import abilities, calls, exchange_layout, layout, plan_layout
from dse.cosim.failure import fmu_messages
from dse.cosim.failure.run_failed import StopReason
from dse.errors import DseError
from dse.fmu.toolchain.compiler import find_compiler

NAMES = {"Past": "struct dse_past", "Solver": "struct dse_solver", "Reason": "dse_reason"}
"""Of structures that C calls otherwise."""

MIRRORS = {
    mirror
    for module in (layout, plan_layout, exchange_layout)
    for mirror in vars(module).values()
    if isinstance(mirror, type) and issubclass(mirror, ctypes.Structure)
}

NUMBERS: Mapping[str, int] = {
    **{call.name: call for call in calls.Call if call is not calls.Call.LOAD},
    **{each.name: each for each in (*calls.AccessorType, *abilities.Ability)},
    **{reason.name: reason for reason in StopReason},
    **{name: getattr(layout, name) for name in ("LOG_LINES", "LOG_WIDTH")},
    **{name: getattr(fmu_messages, name) for name in ("MOST_STEPS", "MOST_PASSES", "CLOSE_EVENTS")},
}


def _kind(field: type) -> str:
    """What _Generic says of each type where the member is to be of this one."""
    is_double, is_whole = field is ctypes.c_double, field is ctypes.c_int64
    return f"double: {is_double:d}, int64_t: {is_whole:d}, default: {not is_double and not is_whole:d}"


def _claims() -> Iterator[tuple[str, str]]:
    """Claims in C by what each is about."""
    for mirror in MIRRORS:
        name = NAMES.get(mirror.__name__, mirror.__name__)
        yield name, f"sizeof({name}) == {ctypes.sizeof(mirror)}"
        for field, kind in mirror._fields_:
            at = getattr(mirror, field)
            yield f"{name}.{field}", f"offsetof({name}, {field}) == {at.offset}"
            member = f"(({name} *)0)->{field}"
            yield f"{name}.{field}", f"sizeof {member} == {at.size} && _Generic({member}, {_kind(kind)})"
    for name, value in NUMBERS.items():
        yield name, f"{name} == {int(value)}"


def _unmet(folder, claims) -> list[str]:
    lines = [f'_Static_assert({claim}, "{about}");' for about, claim in claims]
    (folder / "claims.c").write_text("\n".join(['#include "cosim/kernel/master.h"', *lines, ""]), encoding="utf-8")
    command = [*find_compiler().command, "-std=c11", "-fsyntax-only", f"-I{csolve.INCLUDE}", "claims.c"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return [line for line in done.stderr.splitlines() if "error:" in line]


def test_structures_and_numbers_are_those_of_the_kernel(tmp_path):
    assert len(MIRRORS) >= 24
    assert _unmet(tmp_path, _claims()) == []


def test_members_that_changed_places_are_noticed(tmp_path):
    offsets = {"is_plain": layout.System.may_roll_back.offset, "may_roll_back": layout.System.is_plain.offset}
    claims = [(name, f"offsetof(System, {name}) == {offset}") for name, offset in offsets.items()]
    assert len(_unmet(tmp_path, claims)) == 2


def test_a_kernel_of_other_sources_is_refused(tmp_path, monkeypatch):
    for path in (layout._COSIM / "kernel").glob("*.[ch]"):
        (tmp_path / "kernel").mkdir(exist_ok=True)
        shutil.copy(path, tmp_path / "kernel")
    shutil.copy(next(layout._COSIM.glob("_kernel.*")), tmp_path)
    monkeypatch.setattr(layout, "_COSIM", tmp_path)
    layout.kernel.__wrapped__()
    with (tmp_path / "kernel" / "plan.h").open("a", encoding="utf-8") as header:
        header.write("/* changed */\n")
    with pytest.raises(DseError, match="not built from this version"):
        layout.kernel.__wrapped__()
