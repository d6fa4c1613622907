"""What can only go wrong while a model runs is told by name and in time; nothing is computed beyond it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from modelica_components import Built
from slaves import Slave, instance

FOLDER = Path(__file__).parent / "failing"


def wanted(file: Path) -> tuple[bool, str]:
    first = re.match(r"// fails( at the start)?: (.*)", file.read_text(encoding="utf-8"))
    assert first, f"{file.name} does not say how it fails"
    return bool(first[1]), first[2]


def run(slave: Slave) -> None:
    for k in range(20):
        slave.fmu.doStep(k * 0.05, 0.05)
        slave.get("y")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("file", sorted(FOLDER.glob("*.mo")), ids=lambda file: file.stem)
@pytest.mark.parametrize("version", [2, pytest.param(3, marks=pytest.mark.thorough)], ids=["fmi2", "fmi3"])
def test_the_failure_is_named(file: Path, version: int, built: Built) -> None:
    from fmpy.fmi1 import FMICallException

    at_start, word = wanted(file)
    with instance(built(file, version)) as slave:
        if at_start:
            with pytest.raises(FMICallException, match="InitializationMode"):
                slave.start({}, 1e-8)
        else:
            slave.start({}, 1e-8)
            with pytest.raises(FMICallException):
                run(slave)
        assert any(word in message for message in slave.messages), slave.messages


ENDED = """model Ended
  Real x(start = 0, fixed = true);
  output Real y;
equation
  der(x) = 1;
  when x > 0.5 then
    terminate("that is enough");
  end when;
  y = x;
end Ended;
"""


@pytest.mark.thorough
def test_terminate_ends_the_run_at_its_time_and_says_why(tmp_path: Path, built: Built) -> None:
    from fmpy.fmi1 import FMICallException

    file = tmp_path / "Ended.mo"
    file.write_text(ENDED, encoding="utf-8")
    with instance(built(file, 2)) as slave:
        slave.start({}, 1e-8)
        with pytest.raises(FMICallException, match="discard"):
            slave.fmu.doStep(0.0, 0.7)
        assert "at 0.5 s: that is enough" in slave.messages[0]
        assert slave.get("y") == pytest.approx(0.5, abs=1e-9)
    with instance(built(file, 3)) as slave:
        slave.start({}, 1e-8)
        _, is_ended, _, time = slave.fmu.doStep(0.0, 0.7)
        assert is_ended
        assert time == pytest.approx(0.5, abs=1e-9)


@pytest.mark.thorough
def test_a_warning_is_told_once_and_the_run_goes_on(built: Built) -> None:
    file = FOLDER.parent / "cases" / "AssertsAndWarnings.mo"
    for version in (2, 3):
        with instance(built(file, version)) as slave:
            slave.start({}, 1e-8)
            for k in range(10):
                slave.fmu.doStep(k * 0.1, 0.1)
            assert slave.get("y") == pytest.approx(1.0, abs=1e-9)
            assert sum("x is beyond 0.5" in message for message in slave.messages) == 1
