"""What is heard of the car, rendered by WebAudio without a loudspeaker: pitches against the speed of the engine."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from chromium import started_chromium

pytestmark = pytest.mark.thorough

WEB = Path(__file__).parents[2] / "dse" / "report" / "web"
RATE = 44_100
RENDER = """async ([does, rate]) => {
  const context = new OfflineAudioContext(1, 2 * rate, rate);
  const voices = sound.buildVoices(context);
  for (const [what, told] of does) voices[what](told);
  return [...(await context.startRendering()).getChannelData(0).slice(rate)];
}"""


@pytest.fixture(scope="module")
def rendered() -> Iterator[Callable[..., np.ndarray]]:
    """The spectrum of the last of two seconds, 1 Hz apart, after the voices were told what they are given."""
    bundle = [WEB / "node_modules" / ".bin" / "esbuild", "src/drive/sound.ts", "--bundle", "--format=iife"]
    script = subprocess.run(
        [*bundle, "--global-name=sound"], cwd=WEB, capture_output=True, text=True, check=True
    ).stdout
    with started_chromium() as browser:
        page = browser.new_page()
        page.add_script_tag(content=script)

        def render(*does: tuple[str, object]) -> np.ndarray:
            samples = np.array(page.evaluate(RENDER, [[list(each) for each in does], RATE]))
            assert np.all(np.abs(samples) <= 1)
            return np.abs(np.fft.rfft(samples)) / (len(samples) / 2)

        yield render


def driving(**changed: object) -> tuple[str, object]:
    speed = changed.get("speed", 20.0)
    told = {"speed": speed, "spin": speed / 0.31, "drive": 1500.0, "radius": 0.31, "wetness": 0.0}
    return "hear", told | changed


@pytest.mark.parametrize(("speed", "gear"), [(6.0, 13.0), (20.0, 4.1), (30.0, 2.8)])
def test_an_engine_of_four_cylinders_fires_twice_a_turn(rendered, speed, gear) -> None:
    turns = speed / 0.31 * gear / (2 * np.pi)  # 1/s
    spectrum = rendered(driving(speed=speed))
    low = spectrum[:400]
    assert abs(np.argmax(low) - 2 * turns) <= 1
    # All tones are multiples of one turn; between them there is only noise of tyres and wind.
    tones = [round(number * turns) for number in range(1, 5)]
    between = [round((number + 0.5) * turns) for number in range(1, 5)]
    peaks, floor = (max(low[at - 1 : at + 2].max() for at in places) for places in (tones, between))
    assert peaks > 8 * floor


def test_idle_is_heard_at_standstill_and_nothing_after_it_is_switched_off(rendered) -> None:
    idle = rendered(driving(speed=0.0, drive=0.0))
    assert 25 <= np.argmax(idle[:400]) <= 29  # 85 rad/s fire 27 times a second
    assert rendered(driving(), ("hush", None)).max() < 1e-6


def test_wheels_that_slip_squeal_and_water_silences_them(rendered) -> None:
    def squeal(**changed: object) -> float:
        return float(rendered(driving(drive=0.0, **changed))[900:1000].mean())

    assert squeal(spin=0.0) > 5 * squeal()
    assert squeal(spin=0.0, wetness=1.0) < 0.5 * squeal(spin=0.0)


def test_the_horn_has_two_tones_also_while_the_car_is_not_heard(rendered) -> None:
    spectrum = rendered(("horn", True))
    assert sorted(np.argsort(spectrum)[-2:].tolist()) == [405, 508]
    assert rendered(("horn", True), ("horn", False)).max() < 1e-6
