"""What other packages add, as a user of the command line meets it."""

from __future__ import annotations

import json
import shutil

import pytest
from installed_package import install

SOURCE = '''
import numpy as np
from dse.metrics.catalogue import Argument, Wants, metric_function, same

class Broken:
    title = "Broken"

    def charts(self, content):
        raise ValueError("[b]no such thing[/b]")

broken = Broken()

def peak_to_peak(x):
    """Largest less smallest value, in x's unit."""
    return float(np.max(x) - np.min(x))

def careless(x, start):
    if np.max(x) - np.min(x) > start:
        raise ValueError(f"a swing of {np.max(x) - np.min(x)} m")
    return 1.0

X = Argument("x", Wants.WAVEFORM, any_unit=True)
PEAK_TO_PEAK = metric_function(peak_to_peak, [X], same)
CARELESS = metric_function(careless, [X, Argument("from", Wants.CONSTANT, "m", 100.0)], same)
'''
POINTS = {
    "dse.figures": {"broken": "broken"},
    "dse.metrics": {"peak_to_peak": "PEAK_TO_PEAK", "careless": "CARELESS"},
}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return install(tmp_path_factory.mktemp("site"), "others", SOURCE, POINTS)


@pytest.fixture
def others(site, monkeypatch):
    """Has the package of others installed."""
    monkeypatch.setenv("PYTHONPATH", str(site))


def test_report_names_a_figure_that_fails_and_writes_the_page(dse, explored, others, tmp_path):
    page = tmp_path / "page.html"
    done = dse("report", str(explored), "-o", str(page))
    assert done.returncode == 0
    assert "the figure 'broken' cannot be drawn: ValueError: [b]no such thing[/b]" in done.stderr
    assert "hint: mend or uninstall others" in done.stderr
    assert "the figure 'broken' cannot be drawn" in page.read_text(encoding="utf-8")


@pytest.mark.thorough
def test_figure_draws_the_others_and_then_fails(dse, explored, others, tmp_path):
    done = dse("figure", str(explored), "-o", str(tmp_path))
    assert done.returncode == 1
    assert "the figure 'broken' cannot be drawn" in done.stderr
    assert "Traceback" not in done.stderr
    drawn = {path.stem.split("_")[0] for path in tmp_path.iterdir()}
    assert {"constraints", "margins", "parallel", "progress", "waveforms"} <= drawn
    assert "broken" not in drawn


@pytest.mark.thorough
def test_figure_draws_only_what_is_asked_for(dse, explored, tmp_path):
    done = dse("figure", str(explored), "-o", str(tmp_path), "--only", "margins", "--only", "progress")
    assert done.returncode == 0
    names = {path.name for path in tmp_path.iterdir()}
    assert {"margins_R1.png", "progress_R1.png", "progress_R2.png"} <= names
    assert names == {f"{path}" for path in names if path.startswith(("margins_", "progress_"))}
    unknown = dse("figure", str(explored), "-o", str(tmp_path), "--only", "margin")
    assert unknown.returncode == 1
    assert "unknown figure 'margin'" in unknown.stderr
    assert "did you mean 'margins'?" in unknown.stderr


@pytest.mark.thorough
def test_metric_functions_of_another_package_are_computed_in_workers(dse_in, example, others, tmp_path):
    folder = tmp_path / "work"
    shutil.copytree(example, folder)
    bench = folder / "testbenches" / "acc_following.yaml"
    text = bench.read_text(encoding="utf-8")
    added = "metrics:\n  swing: peak_to_peak(world.gap)\n  odd: careless(world.gap, from = 161.1 m)\n"
    bench.write_text(text.replace("metrics:\n", added, 1), encoding="utf-8")
    done = dse_in(folder, "explore", "small", "-o", "out", "--workers", "1")
    runs = json.loads(dse_in(folder, "results", "out", "--format", "json").stdout)["runs"]
    assert len(runs) == 20
    failed = [run for run in runs if run["outcome"] == "failed"]
    assert done.returncode == (3 if failed else 0)
    assert all("metric function careless: ValueError: a swing of" in run["problem"] for run in failed)
    assert len(failed) == 1
    assert all(50 < run["metrics"]["swing"] <= 161.1 for run in runs if run not in failed)
