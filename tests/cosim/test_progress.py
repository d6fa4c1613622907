from __future__ import annotations

import mmap
import os
import pickle
import struct
import subprocess
import sys
from pathlib import Path

import pytest

import dse
from dse.cosim.failure.progress import PROGRESS_BYTES, describe_progress
from dse.cosim.simulator import RunFailed, Simulator

CRASHING = """
import mmap, pickle, sys
from pathlib import Path
from dse.cosim.simulator import Simulator
with open(sys.argv[2], "r+b") as file:
    block = mmap.mmap(file.fileno(), 0)
system = pickle.loads(Path(sys.argv[1]).read_bytes())
Simulator(system, ["car.y"], progress=memoryview(block)).run(
    stop=10, step=0.01, start={"world.mode": 6, "world.at": 3.21}
)
"""


@pytest.mark.parametrize("version", [2, 3])
def test_after_a_crash_the_block_tells_which_call_it_was(lone, tmp_path, version):
    system = lone(version)
    (tmp_path / "system").write_bytes(pickle.dumps(system))
    (tmp_path / "block").write_bytes(bytes(PROGRESS_BYTES))
    script = tmp_path / "crash.py"
    script.write_text(CRASHING, encoding="utf-8")
    command = [sys.executable, str(script), str(tmp_path / "system"), str(tmp_path / "block")]
    environment = {**os.environ, "PYTHONPATH": str(Path(dse.__file__).parents[1])}
    ended = subprocess.run(command, env=environment, check=False, capture_output=True)
    assert ended.returncode != 0
    assert b"Traceback" not in ended.stderr
    block = (tmp_path / "block").read_bytes()
    assert describe_progress(block, system, 0.01) == f"world: fmi{version}DoStep at t = 3.21 s"


def test_a_finished_run_leaves_the_block_between_two_calls_and_counts(lone):
    system = lone(2)
    block = mmap.mmap(-1, PROGRESS_BYTES)
    with Simulator(system, ["car.y"], progress=memoryview(block)) as simulator:
        for _ in range(2):
            simulator.run(stop=1, step=0.1)
        with pytest.raises(RunFailed):
            simulator.run(stop=1, step=0.1, start={"world.mode": 1})
        assert describe_progress(bytes(block), system, 0.1) == "between two FMI calls"
        assert struct.unpack("=4q", bytes(block))[3] == 4  # the second run was made twice, to prove the reset
    block.close()  # refused while anything still points into it


def test_a_progress_block_must_be_large_enough_and_aligned(lone):
    for block in (bytearray(PROGRESS_BYTES - 1), memoryview(bytearray(PROGRESS_BYTES + 1))[1:]):
        with pytest.raises(ValueError, match=r"Buffer size|multiple of 8"):
            Simulator(lone(2), ["car.y"], progress=memoryview(block))


def test_every_call_has_its_name(lone):
    system = lone(3)
    names = [
        describe_progress(struct.pack("=4q", 1, call, -1, 1), system, 0.1) for call in (1, 2, 3, 5, 6, 8, 64, 102, 74)
    ]
    assert names == [
        "car: fmi3InstantiateCoSimulation",
        "car: fmi3FreeInstance",
        "car: fmi3Reset",
        "car: fmi3EnterInitializationMode",
        "car: fmi3ExitInitializationMode",
        "car: fmi3Terminate",
        "car: fmi3GetFloat64",
        "car: fmi3SetInt32",
        "car: fmi3GetBoolean",
    ]
    assert describe_progress(struct.pack("=4q", 0, 4, -1, 1), lone(2), 0.1) == "world: fmi2SetupExperiment"
    assert describe_progress(struct.pack("=4q", 9, 7, 3, 1), system, 0.1) == "between two FMI calls"
