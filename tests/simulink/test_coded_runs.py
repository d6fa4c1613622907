"""Every run of a generated model is that of a new one, whatever it leaves behind; it begins with its outputs at 0 s."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import coded_texts as texts
import numpy as np
import pytest
from numpy.typing import NDArray

from dse.cosim.simulator import Simulator
from dse.domain.fmu import FmuModel
from dse.domain.system import Element, SystemStructure
from dse.errors import DseError
from dse.fmu.component_build import build, with_platforms
from dse.fmu.fusion.fuse import fuse
from dse.fmu.toolchain.platforms import platforms_named
from dse.fmu.unpack import open_fmu
from dse.testing.kinds import lay_out, the_component

pytest.importorskip("clang.cindex")

STEP = texts.STEP
COMPONENT = "component: lag\nimplements: lag\nsource: {kind: simulink, folder: lag_ert_rtw, step: 100 ms}\n"


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@dataclass(frozen=True)
class Made:
    """A generated model as an FMU."""

    folder: Path
    cache: Path

    def of(self, files: Mapping[str, str], inputs: str, outputs: str) -> FmuModel:
        ports = f"  lag:\n    inputs: {{{inputs}}}\n    outputs: {{{outputs}}}\n"
        lay_out(
            {
                "interfaces.yaml": f"interfaces:\n{ports}",
                "lag/component.yaml": COMPONENT,
                **{f"lag/lag_ert_rtw/{name}": text for name, text in files.items()},
            },
            self.folder,
        )
        return open_fmu(build(the_component(self.folder), cache=self.cache), cache=self.cache)


@pytest.fixture
def made(tmp_path: Path, cache: Path) -> Made:
    return Made(tmp_path, cache)


def system_of(model: FmuModel, *names: str) -> SystemStructure:
    outputs = tuple(v for v in model.variables.values() if v.causality == "output")
    return SystemStructure("tested", tuple(Element(name, model, (), outputs, {}) for name in names), ())


def runs(model: FmuModel, count: int, output: str, **start: float) -> list[NDArray[np.float64]]:
    """Of two instances with the same start values, side by side."""
    with Simulator(system_of(model, "one", "other"), [f"one.{output}", f"other.{output}"]) as simulator:
        begin = {f"{name}.{key}": value for name in ("one", "other") for key, value in start.items()}
        return [simulator.run(stop=2.0, step=STEP, start=begin) for _ in range(count)]


PORTS = ("speed", "enable", "filtered")
STYLES = {
    "whole_program": (texts.whole_program, PORTS),
    "exported": (texts.exported, PORTS),
    "reusable": (texts.reusable, PORTS),
    "arguments": (texts.arguments, ("arg_speed", "arg_enable", "arg_Out1")),
    "class": (texts.class_of_cpp, PORTS),
}


@pytest.mark.parametrize("style", STYLES)
def test_every_run_of_every_instance_is_that_of_a_new_model(style: str, made: Made) -> None:
    files, (speed, enable, filtered) = STYLES[style]
    model = made.of(files(), f'{speed}: "1", {enable}: bool', f'{filtered}: "1"')
    expected = [0.0, *texts.lag([2.0] * 20)]
    for run in runs(model, 4, filtered, **{speed: 2.0, enable: 1.0}):
        assert run[:, 0] == pytest.approx(expected, rel=1e-12, abs=1e-12)
        assert run[:, 0].tobytes() == run[:, 1].tobytes()


@pytest.mark.parametrize("style", ["whole_program", "reusable"])
def test_a_fused_model_is_new_in_every_run_too(style: str, made: Made) -> None:
    files, _ = STYLES[style]
    model = made.of(files(), 'speed: "1", enable: bool', 'filtered: "1"')
    system, record = system_of(model, "one", "other"), ["one.filtered", "other.filtered"]
    start = {"one.speed": 2.0, "one.enable": 1.0, "other.speed": -3.0, "other.enable": 1.0}
    with (
        Simulator(system, record) as plain,
        Simulator(system, record, fused=fuse(system, record, cache=made.cache)) as quick,
    ):
        for _ in range(4):
            one, other = (each.run(stop=2.0, step=STEP, start=start) for each in (plain, quick))
            assert one.tobytes() == other.tobytes()
            assert one[-1].tolist() == pytest.approx([texts.lag([u] * 20)[-1] for u in (2.0, -3.0)], rel=1e-12)
        assert quick.fused_steps > 0


def test_libraries_for_other_platforms_are_refused_by_name(made: Made) -> None:
    model = made.of(texts.gain("lag"), 'u: "1"', 'y: "1"')
    with pytest.raises(DseError, match="cannot be built for x86_64-windows: it contains code from Simulink as a libr"):
        with_platforms("lag", model.archive, platforms_named(["win64"]), cache=made.cache)


def test_outputs_that_follow_inputs_at_once_do_so_at_the_start(made: Made) -> None:
    model = made.of(texts.gain("lag"), 'u: "1"', 'y: "1"')
    with Simulator(system_of(model, "one"), ["one.y"]) as simulator:
        for u in (3.0, 4.0):
            assert simulator.run(stop=STEP, step=STEP, start={"one.u": u})[:, 0].tolist() == [2 * u, 2 * u]


@pytest.mark.parametrize("order", [1, 4])
def test_a_model_that_integrates_starts_with_its_initial_state(order: int, made: Made) -> None:
    model = made.of(texts.continuous(order), 'speed: "1"', 'filtered: "1"')
    expected = [0.0, *texts.lag_by_ode(order, [2.0] * 20)]
    for run in runs(model, 3, "filtered", speed=2.0):
        assert run[:, 0] == pytest.approx(expected, rel=1e-12, abs=1e-12)
