"""Who says how long a package is simulated, and how finely."""

from __future__ import annotations

from dataclasses import replace

import pytest
from ssp_packages import model, variable

from dse.domain.fmu import Experiment
from dse.errors import DseError, Location
from dse.interchange.prepared import timing_of
from dse.interchange.structure import ExperimentSettings

HERE = Location("x.ssp")
SILENT = model("silent", variable("y", "output"))
SLOW = replace(SILENT, experiment=Experiment(0.0, 10.0, 0.5))
FAST = replace(SILENT, experiment=Experiment(1.0, 5.0, 0.01))


@pytest.mark.parametrize(
    ("said", "models", "stop", "step", "expected"),
    [
        (ExperimentSettings(0.0, 2.0, 0.1), [SLOW], 3.0, 0.2, (3.0, 0.2, "asked for", "asked for")),
        (ExperimentSettings(0.0, 2.0, 0.1), [SLOW], None, None, (2.0, 0.1, "the package", "the package")),
        (ExperimentSettings(), [SLOW, FAST], None, None, (10.0, 0.01, "its FMUs", "its FMUs")),
        (
            ExperimentSettings(stop=3.0),
            [SILENT],
            None,
            None,
            (3.0, 0.003, "the package", "1/1000 of the time, as none is given"),
        ),
        # The FMUs' step does not divide the time that is asked for.
        (ExperimentSettings(), [SLOW], 0.7, None, (0.7, 0.0007, "asked for", "1/1000 of the time, as none is given")),
        # From 0 s on, as long as the FMU's experiment takes.
        (ExperimentSettings(), [FAST], None, None, (4.0, 0.01, "its FMUs", "its FMUs")),
        (ExperimentSettings(start=5.0), [SLOW], 1.0, None, (1.0, 0.5, "asked for", "its FMUs")),
    ],
)
def test_what_is_asked_for_comes_first_then_the_package_then_its_fmus(said, models, stop, step, expected):
    timing = timing_of(said, models, stop, step, HERE)
    assert (timing.stop, timing.stop_said_by, timing.step_said_by) == (expected[0], expected[2], expected[3])
    assert timing.step == pytest.approx(expected[1])


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (ExperimentSettings(), "it does not define how long to simulate"),
        (
            ExperimentSettings(start=5.0, stop=9.0),
            "the experiment starts at 5 s; simulations start at 0 s in this version",
        ),
    ],
)
def test_what_nobody_says_or_nobody_can_do_is_refused(said, expected):
    with pytest.raises(DseError, match=expected):
        timing_of(said, [SILENT], None, None, HERE)
