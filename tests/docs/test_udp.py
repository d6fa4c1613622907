"""docs/udp.md: its component and who answers it, in one run; the bytes it tells."""

from __future__ import annotations

import re
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from background import LIMIT

from dse.cosim import Simulator
from dse.domain.system import Element, SystemStructure
from dse.fmu import build, open_fmu
from dse.live.packet import MAGIC_VERSION, Flag, size_of
from dse.loading import Workspace

TEXT = (Path(__file__).parents[2] / "docs" / "udp.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)


def test_the_component_and_who_answers_it_make_a_run(tmp_path):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
    for block in blocks("yaml"):
        file = tmp_path / re.match(r"# (\S+)", block)[1]
        file.parent.mkdir(parents=True, exist_ok=True)
        patient = block.replace("timeout: 2 s", f"timeout: {LIMIT:g} s")  # until Python is there, however busy it is
        file.write_text(patient.replace("5005", str(port)), encoding="utf-8")
    (code,) = blocks("python")
    component = Workspace(tmp_path).component("world_outside")
    model = open_fmu(build(component, cache=tmp_path / "cache"), cache=tmp_path / "cache")
    outputs = (model.variables["gap"],)
    started = {"speed": 20.0, "brakes": 0.0, "start_gap": 50.0}
    system = SystemStructure("one", (Element("world", model, (), outputs, started),), ())
    answering = subprocess.Popen([sys.executable, "-c", code.replace("5005", str(port))], stderr=subprocess.PIPE)
    try:
        with Simulator(system, ["world.gap"]) as simulator:
            gaps = simulator.run(stop=1.0, step=0.01).ravel()
    finally:
        answering.kill()
        told = answering.communicate(timeout=LIMIT)[1]
    assert not told
    assert gaps[0] == 50.0
    assert gaps[-1] == pytest.approx(55.0, abs=1e-9)


def test_the_table_of_bytes_is_the_codec_s():
    assert f"{MAGIC_VERSION:#x}" in TEXT
    assert f"{size_of(0)} + 8n bytes" in TEXT
    for flag in Flag:
        assert f"{int(flag)} {flag.name}" in TEXT
