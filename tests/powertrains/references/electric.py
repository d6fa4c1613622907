"""Electric drives written from their physics, for comparison: functions of plain numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import PchipInterpolator


@dataclass(frozen=True)
class SynchronousMachine:
    """Non-salient permanent-magnet machine and its inverter. SI; fluxes and currents are amplitudes of a phase."""

    max_torque: float = 310.0
    max_power: float = 150e3
    torque_lag: float = 0.02
    pole_pairs: int = 4
    flux_linkage: float = 0.0812
    inductance: float = 1.22e-4
    stator_resistance: float = 0.007
    hysteresis_loss: float = 35.0
    eddy_loss: float = 0.012
    viscous_friction: float = 2e-4
    modulation: float = 0.95
    threshold_voltage: float = 0.8
    on_resistance: float = 1.2e-3
    switching_time: float = 2.5e-7
    switching_frequency: float = 1e4
    standby_loss: float = 60.0

    def phase_voltage(self, link_voltage: float) -> float:
        """Largest amplitude, V."""
        return self.modulation * link_voltage / math.sqrt(3.0)

    def weakening(self, torque: float, speed: float, link_voltage: float) -> float:
        """Voltage the flux without weakening would need, less the one there is, V; positive: the field is weakened."""
        flux = math.hypot(self.flux_linkage, self.inductance * self.torque_current(torque))
        return self.pole_pairs * abs(speed) * flux - self.phase_voltage(link_voltage)

    def torque_current(self, torque: float) -> float:
        """Current along the quadrature axis, A: power of the back-emf over speed is the torque."""
        return torque / (1.5 * self.pole_pairs * self.flux_linkage)

    def losses(self, torque: float, speed: float, link_voltage: float, weakened: bool | None = None) -> float:
        """Of machine and inverter, W. *weakened* holds the branch (for integration across the corner)."""
        electrical = self.pole_pairs * speed
        across = self.inductance * self.torque_current(torque)
        if weakened is None:
            weakened = self.weakening(torque, speed, link_voltage) > 0
        along = self.flux_linkage
        if weakened:
            reach = self.phase_voltage(link_voltage) / abs(electrical)
            along = math.sqrt(max(reach * reach - across * across, 0.0))
        field_current = (along - self.flux_linkage) / self.inductance
        squared = field_current**2 + self.torque_current(torque) ** 2
        copper = 1.5 * self.stator_resistance * squared
        flux = along * along + across * across
        iron = flux * electrical**2 * (self.hysteresis_loss / math.sqrt(electrical**2 + 1.0) + self.eddy_loss)
        amplitude = squared / math.sqrt(squared + 1.0)
        leg_mean = 2.0 / math.pi * amplitude
        conduction = 3.0 * (leg_mean * self.threshold_voltage + 0.5 * squared * self.on_resistance)
        switching = 3.0 * leg_mean * self.switching_frequency * self.switching_time * link_voltage
        return copper + iron + self.viscous_friction * speed**2 + conduction + switching + self.standby_loss

    def power_limit(self, link_voltage: float) -> float:
        """Of the shaft, W: the rated one, or 95 % of what the voltage allows however weak the field."""
        pull_out = 1.5 * self.phase_voltage(link_voltage) * self.flux_linkage / self.inductance
        return min(self.max_power, 0.95 * pull_out)

    def torque_limit(self, speed: float, link_voltage: float, fast: bool | None = None) -> float:
        """Constant torque, then constant power, N.m."""
        limit = self.power_limit(link_voltage)
        if fast is None:
            fast = self.max_torque * abs(speed) > limit
        return limit / abs(speed) if fast else self.max_torque


CELL_SOC = np.array([0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])


def chen_rincon_mora(soc: np.ndarray) -> np.ndarray:
    """Open-circuit voltage of a cell, V (Chen and Rincon-Mora, IEEE Trans. Energy Convers. 21, 2006, eq. 2)."""
    return -1.031 * np.exp(-35 * soc) + 3.685 + 0.2156 * soc - 0.1178 * soc**2 + 0.3201 * soc**3


CELL_VOLTAGE = np.round(chen_rincon_mora(CELL_SOC), 4)


@dataclass(frozen=True)
class Battery:
    """Equal cells; resistances of a cell times its capacity are constants of the chemistry. Two pairs, or none."""

    series_cells: int = 108
    capacity: float = 561600.0
    series: float = 227.8
    pairs: tuple[tuple[float, float], ...] = ((142.9, 32.85), (152.5, 223.0))
    spline: PchipInterpolator = field(default_factory=lambda: PchipInterpolator(CELL_SOC, CELL_VOLTAGE))

    def open_circuit(self, charge: float) -> float:
        """V."""
        return self.series_cells * float(self.spline(charge / self.capacity))

    def resistance(self, specific: float) -> float:
        """Ohm."""
        return specific * self.series_cells / self.capacity

    def current(self, power: float, inner: float) -> float:
        """Root of ``R i^2 - inner i + power = 0`` that vanishes with the power, A."""
        resistance = self.resistance(self.series)
        if resistance == 0.0:
            return power / inner
        half = inner / (2.0 * resistance)
        root = math.sqrt(half * half - power / resistance)
        return power / resistance / (half + root)

    def flows(self, current: float, voltages: Sequence[float]) -> tuple[list[float], float, float]:
        """Time derivatives of the pairs' *voltages* (V/s), heat (W) and voltage lost at the poles (V)."""
        series = self.resistance(self.series)
        rates, heat, drop = [], series * current**2, series * current
        for voltage, (specific, time_constant) in zip(voltages, self.pairs, strict=True):
            resistance = self.resistance(specific)
            rates.append((resistance * current - voltage) / time_constant)
            heat += voltage**2 / resistance
            drop += voltage
        return rates, heat, drop


@dataclass(frozen=True)
class Axle:
    """Fixed reduction with gear losses and half shafts."""

    ratio: float = 11.53
    stiffness: float = 3000.0
    damping: float = 100.0
    loss_share: float = 0.02
    viscous_friction: float = 1.5e-3

    def gear_loss(self, torque: float, speed: float) -> float:
        """Torque on the fast side that is lost, N.m."""
        return (
            self.loss_share * math.hypot(torque, 1.0) * speed / math.hypot(speed, 5.0) + self.viscous_friction * speed
        )


@dataclass(frozen=True)
class Car:
    """Road loads on a rigid wheel. Volkswagen ID.3 Pro: mass with driver, drag coefficient 0.267 times 2.36 m2."""

    mass: float = 1880.0
    wheel_radius: float = 0.335
    drag_area: float = 0.63
    air_density: float = 1.2
    rolling_resistance: float = 0.009
    gravity: float = 9.81

    def resistance(self, speed: float) -> float:
        """N, smooth about standstill."""
        rolling = self.rolling_resistance * self.mass * self.gravity * math.tanh(speed / 0.1)
        return rolling + 0.5 * self.air_density * self.drag_area * speed * abs(speed)
