"""Report contents made up for the tests: a small car that follows another, in closed vectorised form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from background import LIMIT
from chromium import started_chromium
from numpy.typing import NDArray
from report_pages import Open

from dse.report.content.data import (
    ConfigurationEntry,
    FigureSpec,
    Floats,
    MetricColumn,
    Property,
    ReportContent,
    ReportVariable,
    RequirementRow,
    Runs,
    SamplerKind,
)
from dse.report.page.html import write_report

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

SET_SPEED, LEAD_SPEED, START_GAP, SET_GAP = 70 / 3.6, 50 / 3.6, 150.0, 40.0
GAINS = (
    ("controller.kp_speed", "speed P gain", "1/s", 0.1, 3.0, 1.2),
    ("controller.kd_speed", "speed D gain", "", 0.0, 2.0, 0.6),
    ("controller.kp_gap", "distance P gain", "1/s²", 0.01, 0.12, 0.04),
    ("controller.kd_gap", "distance D gain", "1/s", 0.05, 1.2, 0.5),
)


@dataclass(frozen=True)
class Drives:
    """Outcome of many drives: one row per run, and one value per 0.1 s in the waveforms."""

    time: Floats
    speed: NDArray[np.float32]
    gap: NDArray[np.float32]
    target_speed: NDArray[np.float32]
    speed_overshoot: Floats
    gap_undershoot: Floats
    peak_deceleration: Floats
    reached: NDArray[np.bool_]


def drive(gains: Floats, rows: int = 601, step: float = 0.02) -> Drives:
    """Drive every row of *gains* (n, 4) for 60 s: hold a speed, then a distance, with a lagging powertrain."""
    kp_speed, kd_speed, kp_gap, kd_gap = gains.T
    n = len(gains)
    speed, acceleration, gap = np.zeros(n), np.zeros(n), np.full(n, START_GAP)
    following = np.zeros(n, dtype=bool)
    top, least, hardest = np.full(n, -np.inf), np.full(n, np.inf), np.zeros(n)
    stride = round(60 / step) // (rows - 1)
    kept = np.empty((3, rows, n), dtype=np.float32)
    for k in range(round(60 / step) + 1):
        following |= gap < 90
        hold = kp_speed * (SET_SPEED - speed) - kd_speed * acceleration
        follow = kp_gap * (gap - SET_GAP) + kd_gap * (LEAD_SPEED - speed)
        wanted = np.clip(np.where(following, np.minimum(hold, follow), hold), -4, 2.5)
        if k % stride == 0:
            kept[:, k // stride] = speed * 3.6, gap, np.where(following, LEAD_SPEED, SET_SPEED) * 3.6
        top, least = np.maximum(top, speed), np.minimum(least, gap)
        hardest = np.maximum(hardest, -acceleration)
        acceleration = acceleration + step * (wanted - acceleration) / 0.8
        speed = speed + step * acceleration
        gap = gap + step * (LEAD_SPEED - speed)
    return Drives(
        np.linspace(0, 60, rows),
        kept[0].T,
        kept[1].T,
        kept[2].T,
        (top - SET_SPEED) / SET_SPEED * 100,
        (SET_GAP - least) / SET_GAP * 100,
        hardest,
        np.abs(gap - SET_GAP) < 4,
    )


def build(
    gains: Floats,
    sampler: SamplerKind,
    *,
    slices: tuple[tuple[str, ...], ...] = (),
    levels: int | None = None,
    failed: tuple[int, ...] = (37, 311),
    used: tuple[int, ...] = (0, 1, 2, 3),
    keep_every: int = 1,
    configurations: tuple[str, ...] = ("c4f1a2",),
    title: str = "Gains of the adaptive cruise control",
) -> ReportContent:
    """Content with the gains' columns *used* as design variables, the runs dealt out over the configurations."""
    drives = drive(gains)
    n = len(gains)
    done = ~np.isin(np.arange(n), failed)
    kept = np.flatnonzero(done)[::keep_every]
    hole = np.where(done, 0.0, np.nan)
    share = n // len(configurations)
    return ReportContent(
        title=title,
        sampler=sampler,
        study_folder="out/acc_gains",
        runs=Runs(
            numbers=np.arange(n, dtype=np.int64),
            configurations=tuple(configurations[min(i // share, len(configurations) - 1)] for i in range(n)),
            done=done,
            problems=tuple("" if ok else "powertrain: fmi2DoStep returned fmi2Error at t = 12.31 s" for ok in done),
        ),
        configurations=tuple(
            ConfigurationEntry(
                name,
                {
                    "sensor": ("radar_77ghz_long", "lidar_905nm")[i % 2],
                    "controller": "pd_acc",
                    "brake": ("hydraulic_booster", "brake_by_wire")[i // 2 % 2],
                },
                {"cost": Property(9450.0 + 310 * i, "EUR"), "mass": Property(412.0 + 7 * i, "kg")},
            )
            for i, name in enumerate(configurations)
        ),
        variables=tuple(
            ReportVariable(name, label, unit, low, high, levels, nominal, gains[:, i].copy())
            for i, (name, label, unit, low, high, nominal) in enumerate(GAINS)
            if i in used
        ),
        metrics=(
            MetricColumn("speed_overshoot", "speed overshoot", "%", drives.speed_overshoot + hole),
            MetricColumn("gap_overshoot", "distance undershoot", "%", drives.gap_undershoot + hole),
            MetricColumn("peak_deceleration", "peak deceleration", "m/s²", drives.peak_deceleration + hole),
        ),
        requirements=(
            RequirementRow("R1", "no speed overshoot", "speed_overshoot", 0.5, None, np.ones(n, dtype=bool)),
            RequirementRow("R2", "no distance undershoot", "gap_overshoot", 1.0, None, drives.reached),
        ),
        figures=(
            FigureSpec(
                "gap",
                "Distance to the vehicle ahead",
                "m",
                "distance",
                "set distance",
                drives.time,
                kept,
                drives.gap[kept],
                np.full(len(kept), SET_GAP),
            ),
            FigureSpec(
                "speed",
                "Speed",
                "km/h",
                "speed",
                "set speed",
                drives.time,
                kept,
                drives.speed[kept],
                drives.target_speed[kept],
            ),
        ),
        slices=slices,
        facts=(("study", "acc_gains"), ("sampler", str(sampler)), ("runs", str(n)), ("seed", "1"), ("dse", "0.1.0")),
    )


def grid(levels: int, axes: tuple[int, int]) -> Floats:
    """A grid over two gains, the others at nominal, (levels², 4)."""
    gains = np.tile([gain[5] for gain in GAINS], (levels * levels, 1)).astype(np.float64)
    a, b = (np.linspace(GAINS[axis][3], GAINS[axis][4], levels) for axis in axes)
    gains[:, axes[0]], gains[:, axes[1]] = np.tile(a, levels), np.repeat(b, levels)
    return gains


def scatter(samples: int) -> Floats:
    """A Latin hypercube over the four gains, (samples, 4)."""
    random = np.random.default_rng(1)
    unit = np.stack([(random.permutation(samples) + random.random(samples)) / samples for _ in GAINS], axis=1)
    low, high = np.array([g[3] for g in GAINS]), np.array([g[4] for g in GAINS])
    return np.asarray(low + (high - low) * unit, dtype=np.float64)


SLICES = (("controller.kp_speed", "controller.kd_speed"), ("controller.kp_gap", "controller.kd_gap"))


@pytest.fixture(scope="session")
def sliced() -> ReportContent:
    """Two slices of 11 × 11 runs; every second run's waveforms are kept."""
    return build(
        np.concatenate([grid(11, (0, 1)), grid(11, (2, 3))]),
        SamplerKind.SLICED,
        slices=SLICES,
        levels=11,
        failed=(37, 150),
        keep_every=2,
    )


@pytest.fixture(scope="session")
def scattered() -> ReportContent:
    """A Latin hypercube of 200 runs over four variables."""
    return build(scatter(200), SamplerKind.SCATTERED)


@pytest.fixture(scope="session")
def bench_only() -> ReportContent:
    """Six configurations, one run each, and no design variable."""
    return build(scatter(6), SamplerKind.SCATTERED, failed=(4,), used=(), configurations=tuple("abcdef"))


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with started_chromium() as started:
        yield started


@pytest.fixture
def open_report(browser: Browser, tmp_path: Path) -> Iterator[Open]:
    """Opens a report from disk; at the end nothing must have been logged, thrown or fetched but the report itself."""
    context = browser.new_context(viewport={"width": 1440, "height": 1000}, color_scheme="light")
    complaints: list[str] = []
    report = tmp_path / "report.html"

    def opened(content: ReportContent) -> Page:
        write_report(content, report)
        page = context.new_page()
        page.set_default_timeout(1000 * LIMIT)
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: complaints.append(request.url) if request.url[:5] != "data:" else None)
        complaints.clear()
        page.goto(report.as_uri())
        page.wait_for_selector("html[data-ready]")
        assert complaints == [report.as_uri()]
        complaints.clear()
        return page

    yield opened
    context.close()
    # It may be loaded again.
    assert set(complaints) <= {report.as_uri()}
