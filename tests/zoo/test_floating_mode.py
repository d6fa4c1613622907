"""An FMU that leaves the processor in another mode, in every loop there is."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path

import numpy as np
import pytest
from reference_fmus.systems import system_of

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.method import Algorithm, Coupling, Method
from dse.fmu.unpack import open_fmu
from zoo.animals import ANIMALS, build_animal

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="feenableexcept")

METHODS = {
    "plain": Method(),
    "gauss_seidel": Method(algorithm=Algorithm.GAUSS_SEIDEL),
    "propagate": Method(coupling=Coupling.PROPAGATE),
}


def thirds() -> tuple[float, float, str]:
    """A third, rounded by the processor's two units and by C's printf: other numbers where they round up."""
    printed = ctypes.create_string_buffer(40)
    ctypes.CDLL(None).snprintf(printed, 40, b"%.12g", ctypes.c_double(0.5000000000000001))
    return float(np.float64(1.0) / np.float64(3.0)), float(np.longdouble(1) / np.longdouble(3)), printed.value.decode()


@pytest.mark.sampled(4)
@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
@pytest.mark.parametrize("name", ["changes_rounding", "changes_rounding_first", "traps_floating_point"])
def test_who_changed_the_mode_is_told_and_later_runs_round_as_ever(name: str, method: Method, tmp_path: Path) -> None:
    models = {
        "tail": open_fmu(build_animal(ANIMALS["tame"], tmp_path, "tame"), cache=tmp_path / "cache"),
        "head": open_fmu(build_animal(ANIMALS[name], tmp_path, name), cache=tmp_path / "cache"),
    }
    system = system_of(models, ["head.y -> tail.u"], ["tail.y"])
    expected = thirds()
    with Simulator(system, ["tail.y"], method=method) as simulator:
        before = simulator.run(stop=1.0, step=0.1)
        for _ in range(2):
            with pytest.raises(RunFailed) as caught:
                simulator.run(stop=1.0, step=0.1, start={"head.bites": 1.0})
            assert caught.value.element == "head"
            assert [piece for piece in ANIMALS[name].says if piece not in str(caught.value)] == []
            # Python computes metrics in the same process.
            assert thirds() == expected
        assert simulator.run(stop=1.0, step=0.1).tobytes() == before.tobytes()
