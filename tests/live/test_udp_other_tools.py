"""Another FMI tool (FMPy) runs a component of the kind udp: what it is told by status and log."""

from __future__ import annotations

from contextlib import ExitStack
from ctypes import byref, c_double, c_int

import pytest
from answerers import Answerer
from background import LIMIT
from fmu.conftest import Slave
from live.conftest import outside

from dse.domain.udp import UdpSource


@pytest.mark.parametrize("version", [2, 3])
def test_it_learns_of_the_end_by_status_and_of_what_was_ignored_by_the_log(port, cache, version):
    model = outside(UdpSource(port, timeout=LIMIT, wait=LIMIT), cache, ["u"], ["y"], version=version)
    answering = Answerer(lambda time, step, values: [2.0 * values[0] + time], ends_at=3, port=port)
    with answering as other, ExitStack() as ending:
        slave = Slave(model).create()
        ending.callback(slave.fmu.freeInstance)
        slave.ready(u=3.0)
        assert slave.get("y") == 6.0
        slave.set("u", 4.0)
        other.socket.sendto(b"nonsense", slave_address(other))
        slave.step(0.0, 0.01)
        slave.step(0.01, 0.01)
        assert slave.get("y") == 8.02
        if version == 2:
            fmu, instance = slave.fmu, slave.fmu.component
            assert fmu.dll.fmi2DoStep(instance, c_double(0.02), c_double(0.01), c_int(1)) == 2  # discard
            ended, reached = c_int(0), c_double(0.0)
            assert fmu.dll.fmi2GetBooleanStatus(instance, 3, byref(ended)) == 0
            assert fmu.dll.fmi2GetRealStatus(instance, 2, byref(reached)) == 0
            assert (ended.value, reached.value) == (1, 0.02)
        else:
            _, terminate, _, reached = slave.fmu.doStep(0.02, 0.01)
            assert (terminate, reached) == (True, 0.02)
        assert slave.messages == []
        slave.fmu.terminate()
        (told,) = slave.messages
        assert "packets ignored: 1 of a wrong size" in told  # and old ones, if a request was sent again
        assert "(the last of 8 bytes, right are 36)" in told


def slave_address(other: Answerer) -> tuple[str, int]:
    """Where the last one who asked is."""
    return other.senders[-1]
