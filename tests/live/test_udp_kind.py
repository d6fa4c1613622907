"""``source: {kind: udp}``: what is wrong in it is told where it stands; what cannot be done with it by name."""

from __future__ import annotations

import pytest
from kinds.examples import written
from live.conftest import alone, outside

from dse.cosim.binding import library
from dse.domain.component import Causality, Kind, Port, Type
from dse.domain.udp import LinkMode, LinkRole, UdpSource, heard, sent
from dse.errors import DseError
from dse.fmu.fusion.fuse import fuse
from dse.testing.kinds import lay_out, the_component

SOURCE = UdpSource(5005)


@pytest.mark.parametrize(
    ("source", "at", "what"),
    [
        ("{kind: udp}", "", "'port' is missing in 'source'"),
        ("{kind: udp, port: 70000}", "70000", "there is no port 70000"),
        ("{kind: udp, port: x}", "x}", "'source.port': expected a whole number, found 'x'"),
        ("{kind: udp, port: 5005, role: slave}", "slave", "'slave' is none of client, server"),
        ("{kind: udp, port: 5005, mode: fast}", "fast", "'fast' is none of lockstep, free"),
        ("{kind: udp, port: 5005, listen: 10.0.0.1}", "10.0", "a client has no 'listen'"),
        ("{kind: udp, port: 5005, role: server, host: 10.0.0.1}", "10.0", "a server has no 'host'"),
        ('{kind: udp, port: 5005, host: "a b\\"; system"}', "a b", "'a b\"; system' is not an address"),
        ("{kind: udp, port: 5005, timeout: 0 s}", "0 s", "'timeout' is more than 0 s and at most 1 h, not 0 s"),
        ("{kind: udp, port: 5005, wait: 2 h}", "2 h", "'wait' is more than 0 s and at most 1 h, not 2 h"),
        ("{kind: udp, port: 5005, timeout: 3 m}", "3 m", "wrong unit in '3 m': expected time"),
    ],
)
def test_what_is_wrong_is_told_where_it_stands(tmp_path, source, at, what):
    with pytest.raises(DseError) as caught:
        the_component(lay_out(written(source), tmp_path))
    (problem,) = caught.value.problems
    assert (
        str(problem.where).partition("component.yaml:")[2] == f"3:{len('source: ') + source.index(at) + 1 if at else 1}"
    )
    assert what in problem.what


def test_what_is_not_said_has_its_usual_value(tmp_path):
    source = the_component(lay_out(written("{kind: udp, port: 7, role: server, timeout: 300 ms}"), tmp_path)).source
    assert (source.host, source.role, source.mode) == ("127.0.0.1", LinkRole.SERVER, LinkMode.LOCKSTEP)
    assert (source.timeout, source.wait) == (0.3, 0.3)


def test_a_component_tells_what_goes_each_way(tmp_path):
    component = the_component(lay_out(written("{kind: udp, port: 7}"), tmp_path))
    assert [(name, str(type_)) for name, type_ in sent(component)] == [("u", "m"), ("factor", "1")]
    assert [(name, str(type_)) for name, type_ in heard(component)] == [("y", "m")]


@pytest.mark.parametrize(
    ("ports", "what"),
    [
        ([Port("name", Causality.OUTPUT, Type(Kind.TEXT))], "output 'name' is a string: a datagram holds numbers only"),
        (
            [Port("link.lateness", Causality.OUTPUT, Type(Kind.REAL))],
            "'link.lateness' is counted by the component, in ",
        ),
        ([f"y{n}" for n in range(8001)], "8001 values are heard at once: a datagram holds 8000"),
    ],
)
def test_what_cannot_go_over_a_datagram_is_refused(cache, ports, what):
    with pytest.raises(DseError) as caught:
        outside(SOURCE, cache, ["u"], ports)
    assert what in str(caught.value)


@pytest.mark.parametrize("version", [2, 3])
def test_its_fmu_claims_no_saved_state_and_is_not_fused(cache, port, version):
    model = outside(UdpSource(port), cache, ["u"], ["y"], version=version)
    assert model.is_live
    assert not model.capabilities.can_save_state
    with pytest.raises(DseError, match="exchanges datagrams with another process, so it cannot be fused"):
        fuse(alone(model), ["it.y"], cache=cache)


def test_it_is_refused_in_a_sandbox_unless_it_is_given_a_socket(cache, port, monkeypatch):
    model = outside(UdpSource(port), cache, ["u"], ["y"])
    monkeypatch.setattr(library, "is_inside", lambda: True)
    with pytest.raises(DseError, match="a sandbox has no network"):
        library.load(model)
    monkeypatch.setenv("DSE_LIVE_SOCKET", "3")
    library.load(model)
