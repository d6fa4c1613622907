"""A small study for the example workspace."""

from __future__ import annotations

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
