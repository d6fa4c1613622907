"""The example workspace: what is in it, and a small study for it."""

from __future__ import annotations

from pathlib import Path

_ROOT = Path(__file__).parents[1]

_STUDY = """\
study: small
testbench: acc_following
configurations:
  where: >-
    sensor is radar_77ghz_mid and controller is pd_acc and brake is hydraulic_booster
    and powertrain is bev_ideal and video is absent
design_variables:
  controller.kp_speed: {range: [0.5, 4.5], levels: %d, nominal: 1.2}
  controller.kd_speed: {range: [0, 1], levels: %d, nominal: 0.5}
sampler: full_factorial
keep_waveforms: all
"""


def small_study(kp_levels: int, kd_levels: int) -> str:
    """Its YAML: one configuration, two variables of so many levels, all waveforms kept."""
    return _STUDY % (kp_levels, kd_levels)


def example_designs() -> list[str]:
    """The design spaces of the example workspace."""
    return _names("designs", ".yaml")


def example_benches() -> list[str]:
    """Its test benches."""
    return [name for name in _names("testbenches", ".yaml") if not name.endswith((".pet", ".rating", ".procedure"))]


def example_studies() -> list[str]:
    """Its studies."""
    return _names("testbenches", ".pet.yaml")


def _names(folder: str, ending: str) -> list[str]:
    found = (path.name.removesuffix(ending) for path in (_ROOT / folder).glob(f"*{ending}"))
    return sorted(name for name in found if not name.startswith("_"))
