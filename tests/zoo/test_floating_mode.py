"""An FMU that leaves the processor in another mode, in every loop there is."""

from __future__ import annotations

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


def third() -> float:
    """A third, rounded by the processor: another number where it rounds up."""
    return float(np.float64(1.0) / np.float64(3.0))


@pytest.mark.sampled(4)
@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
@pytest.mark.parametrize("name", ["changes_rounding", "changes_rounding_first", "traps_floating_point"])
def test_who_changed_the_mode_is_told_and_later_runs_round_as_ever(name: str, method: Method, tmp_path: Path) -> None:
    models = {
        "tail": open_fmu(build_animal(ANIMALS["tame"], tmp_path, "tame"), cache=tmp_path / "cache"),
        "head": open_fmu(build_animal(ANIMALS[name], tmp_path, name), cache=tmp_path / "cache"),
    }
    system = system_of(models, ["head.y -> tail.u"], ["tail.y"])
    expected = third()
    with Simulator(system, ["tail.y"], method=method) as simulator:
        before = simulator.run(stop=1.0, step=0.1)
        for _ in range(2):
            with pytest.raises(RunFailed) as caught:
                simulator.run(stop=1.0, step=0.1, start={"head.bites": 1.0})
            assert caught.value.element == "head"
            assert [piece for piece in ANIMALS[name].says if piece not in str(caught.value)] == []
            # Python computes metrics in the same process.
            assert third() == expected
        assert simulator.run(stop=1.0, step=0.1).tobytes() == before.tobytes()
