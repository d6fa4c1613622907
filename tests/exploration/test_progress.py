"""How quick an exploration is, and how long it will take."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from dse.api import progress_bar
from dse.exploration import progress
from dse.exploration.progress import Meter, Progress, Stage


def test_the_rate_is_the_mean_since_the_stage_began(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(progress.time, "monotonic", lambda: now)
    meter = Meter(40)
    assert meter.rate(40) == 0.0
    now = 110.0
    assert meter.rate(140) == 10.0
    now = 150.0  # nothing for 40 s: the mean, not the rate before
    assert meter.rate(140) == 2.0
    assert Progress(Stage.RUNS, 140, 200, 0, meter.rate(140)).left == 30.0


def test_the_bar_says_the_mean_rate_and_what_is_left_at_it() -> None:
    screen = Console(file=io.StringIO(), force_terminal=True, width=120)
    with progress_bar(screen) as show:
        show(Progress(Stage.RUNS, 140, 200, 3, 2.0))
    assert "2 runs/s" in screen.file.getvalue()  # type: ignore[attr-defined]
    assert "about 0:00:30 left" in screen.file.getvalue()  # type: ignore[attr-defined]
    assert "3 failed" in screen.file.getvalue()  # type: ignore[attr-defined]
