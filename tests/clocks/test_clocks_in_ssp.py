"""SSP packages of FMUs with clocks: simulated, checked, imported; what does not fit is told at its line."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path

import pytest
from command_line import run_dse
from ssp_packages import (
    binding,
    bindings,
    component,
    connection,
    connections,
    description,
    elements,
    pack,
    parameter_set,
)

from clocks.fmus import Workshop

CHANNEL = ("output Tx_Data", "input Rx_Data", "input Rx_Clock", "output received", "output last_id", "output malformed")


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


def package(
    folder: Path,
    workshop: Workshop,
    *wires: tuple[str, str],
    timed: bool = False,
    channel: Sequence[str] = CHANNEL,
) -> Path:
    """Two virtual ECUs a and b, called 17 and 18, and these connections besides those of the data."""
    channel = [*channel, f"{'input' if timed else 'output'} Tx_Clock"]
    said = [
        component(name, *channel, source="resources/vecu.fmu", more=bindings(binding(parameter_set(*values))))
        for name, values in (
            ("a", ("id Real 17", "period Real 0.3", "offset Real 0.3")),
            ("b", ("id Real 18", "period Real 0.2", "offset Real 0.2")),
        )
    ]
    data = (("a.Tx_Data", "b.Rx_Data"), ("b.Tx_Data", "a.Rx_Data"))
    text = description(elements(*said) + connections(*(connection(*ends) for ends in (*data, *wires))))
    fmu = workshop.vecu(timed=timed).read_bytes()
    return pack(folder / "can.ssp", {"SystemStructure.ssd": text, "resources/vecu.fmu": fmu})


SENT = {"a.Tx_Clock": 4.0, "a.Tx_Data": 83.0, "b.Tx_Clock": 6.0, "b.Tx_Data": 123.0}
"""What each has sent after 1 s: 23 bytes of configuration and 3 or 5 frames of 20 bytes, each with a tick."""

CLOCKS = ("a.Tx_Clock", "b.Rx_Clock"), ("b.Tx_Clock", "a.Rx_Clock")


@pytest.mark.thorough
@pytest.mark.sampled(4)
@pytest.mark.parametrize("timed", [False, True], ids=["triggered", "countdown"])
@pytest.mark.parametrize("wires", [CLOCKS, ()], ids=["clocks connected", "data alone"])
def test_virtual_ecus_exchange_can_frames(tmp_path, workshop, cache, timed, wires):
    path = package(tmp_path, workshop, *wires, timed=timed)
    done = run_dse(tmp_path, "check", str(path), cache=cache)
    assert (done.returncode, done.stdout) == (0, "ok: 2 FMUs, 10 outputs\n")
    done = run_dse(tmp_path, "simulate", str(path), "--stop", "1", "--step", "0.1", "-o", "wave.csv", cache=cache)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "wave.csv").open(encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    found = {name.split(" ", 1)[0]: float(value) for name, value in last.items()}
    assert (found["a.received"], found["a.last_id"], found["a.malformed"]) == (5, 18, 0)
    assert (found["b.received"], found["b.last_id"], found["b.malformed"]) == (3, 17, 0)
    assert {name: found[name] for name in SENT} == SENT


@pytest.mark.thorough
def test_a_package_with_nothing_but_a_bus_records_its_ticks_and_bytes(tmp_path, workshop, cache):
    path = package(tmp_path, workshop, channel=CHANNEL[:3])
    done = run_dse(tmp_path, "simulate", str(path), "--stop", "1", "--step", "0.1", "-o", "wave.csv", cache=cache)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "wave.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {name: float(rows[-1][name]) for name in SENT} == SENT
    # Sends at 0.3, 0.6 and 0.9 s are in the rows at these times.
    assert [int(float(row["a.Tx_Clock"])) for row in rows] == [1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4]


def test_what_no_tick_can_go_over_is_told_where_it_is_connected(tmp_path, workshop, cache):
    path = package(tmp_path, workshop, ("a.Tx_Clock", "b.received"))
    done = run_dse(tmp_path, "check", str(path), cache=cache)
    assert done.returncode == 1
    assert "a.Tx_Clock - b.received: both ends give values" in done.stderr
    path = package(tmp_path, workshop, ("a.received", "b.Rx_Clock"))
    done = run_dse(tmp_path, "check", str(path), cache=cache)
    assert done.returncode == 1
    assert "a.received - b.Rx_Clock: types differ: real and Clock" in done.stderr
    path = package(tmp_path, workshop, ("a.Rx_Clock", "b.Rx_Clock"))
    done = run_dse(tmp_path, "check", str(path), cache=cache)
    assert done.returncode == 1
    assert "a.Rx_Clock - b.Rx_Clock: both ends take values" in done.stderr


@pytest.mark.thorough
def test_clocks_tick_in_a_workspace_without_ports_of_their_own(tmp_path, workshop, cache):
    said = [
        component(n, "output sum", "output count", "output rings", "input u", "input v", source="resources/t.fmu")
        for n in "ab"
    ]
    wired = connections(connection("a.count", "b.v"), connection("b.count", "a.u"))
    fmu = workshop.ticker('intervalVariability="constant" intervalDecimal="0.3"').read_bytes()
    files = {"SystemStructure.ssd": description(elements(*said) + wired), "resources/t.fmu": fmu}
    path = pack(tmp_path / "ticks.ssp", files)
    done = run_dse(tmp_path, "import", "ssp", str(path), "work", "--stop", "1", "--step", "0.1", cache=cache)
    assert done.returncode == 0, done.stderr
    (bench,) = (tmp_path / "work" / "testbenches").iterdir()
    done = run_dse(tmp_path / "work", "simulate", str(bench), "--format", "json", cache=cache)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["metrics"]
    # Ticks at 0, 0.3, 0.6 and 0.9 s: a adds what b has counted in the same instant, b is told each time.
    assert (found["a_sum_at_the_end"], found["b_count_at_the_end"], found["b_rings_at_the_end"]) == (10, 4, 4)


@pytest.mark.thorough
def test_a_probe_does_not_touch_what_belongs_to_clocks(tmp_path, workshop, cache):
    done = run_dse(tmp_path, "probe", str(workshop.vecu()), "--format", "json", cache=cache)
    assert done.returncode == 0, done.stderr
    assert '"runs": "yes"' in done.stdout


@pytest.mark.thorough
@pytest.mark.parametrize("wires", [CLOCKS, ()], ids=["clocks connected", "data alone"])
def test_virtual_ecus_exchange_can_frames_in_a_workspace(tmp_path, workshop, cache, wires):
    path = package(tmp_path, workshop, *wires)
    done = run_dse(tmp_path, "import", "ssp", str(path), "work", "--stop", "1", "--step", "0.1", cache=cache)
    assert done.returncode == 0, done.stderr
    (bench,) = (tmp_path / "work" / "testbenches").iterdir()
    done = run_dse(tmp_path / "work", "simulate", str(bench), "--format", "json", cache=cache)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["metrics"]
    assert (found["a_received_at_the_end"], found["a_last_id_at_the_end"], found["a_malformed_at_the_end"]) == (
        5,
        18,
        0,
    )
    assert (found["b_received_at_the_end"], found["b_last_id_at_the_end"], found["b_malformed_at_the_end"]) == (
        3,
        17,
        0,
    )
