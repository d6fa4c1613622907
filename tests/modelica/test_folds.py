"""Loops with a fold: their root is followed to its very end, and only there another one is taken.

Relaxation oscillators, an amplifier with positive feedback that charges a capacitor: the root of the loop ends at a
voltage that a closed form gives, and the period is an integral over the branch.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cosim.exchange_models import simulated
from modelica_components import Built
from scipy.integrate import quad
from scipy.optimize import brentq

from dse.domain.fmu import Experiment, FmiInterface
from dse.fmu.unpack import open_fmu

TAU = 0.1
"""Seconds in which the capacitor is charged; the output swings between -5 and 5."""
AMPLIFIERS = {
    "smooth": "vo = 5*tanh(20*(0.5*vo - vc))",
    "limited": "vo = smooth(0, noEvent(if 15000*e > 5 then 5 elseif 15000*e < -5 then -5 else 15000*e))",
}


def model(amplifier: str) -> str:
    return f"""model Multivibrator
  Real vc(start = 0, fixed = true);
  Real e = 0.5*vo - vc;
  output Real vo(start = 5);
equation
  {TAU}*der(vc) = vo - vc;
  {AMPLIFIERS[amplifier]};
end Multivibrator;
"""


def period(amplifier: str) -> float:
    if amplifier == "limited":
        highest = 2.5 - 5 / 15000
        return 2 * TAU * math.log((5 + highest) / (5 - highest))
    # With a = 20*e: vo = 5 tanh(a), vc = vo/2 - a/20. The branch ends where dvc/da = 0.
    end = math.atanh(math.sqrt(1 - 1 / 50))

    def charge(a: float) -> float:
        return 2.5 * math.tanh(a) - a / 20

    begin = brentq(lambda a: charge(a) + charge(end), end, 200)
    half, _ = quad(lambda a: (2.5 / math.cosh(a) ** 2 - 1 / 20) / (5 * math.tanh(a) - charge(a)), begin, end, limit=500)
    return 2 * TAU * half


@pytest.mark.parametrize("amplifier", AMPLIFIERS)
@pytest.mark.parametrize("interface", FmiInterface)
@pytest.mark.parametrize("tolerance", [pytest.param(1e-4, marks=pytest.mark.thorough), 1e-6, 1e-8])
def test_the_oscillator_has_its_period(
    amplifier: str, interface: FmiInterface, tolerance: float, built: Built, cache: Path, tmp_path: Path
) -> None:
    file = tmp_path / "Multivibrator.mo"
    file.write_text(model(amplifier), encoding="utf-8")
    fmu = open_fmu(built(file, 2).archive, cache=cache, interface=interface)
    fmu = replace(fmu, experiment=Experiment(tolerance=tolerance))
    expected, step = period(amplifier), 1e-4
    time, found = simulated(fmu, ["vo"], stop=round(4.2 * expected / step) * step, step=step)
    rises = time[1:][(found["vo"][1:] > 0) & (found["vo"][:-1] < 0)]
    assert len(rises) == 4
    # The tolerance is one of volts in a step, of which 25 pass in a second; rises are seen at communication points.
    assert np.abs(np.diff(rises) - expected).max() < 1.5 * step + 100 * tolerance * expected
