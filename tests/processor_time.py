"""What each test costs in processor time, all processes that it starts included, and the budget for it.

Time on the clock says how busy a machine is, processor time what a test costs. Machines differ by three, so a cost is
in seconds of a reference machine, a slow one: a fixed piece of work, done between the tests by each worker, says how
much longer this machine takes.

    a test took 0.3 s, the piece of work half of what it takes on the reference machine: the test costs 0.6 s

A test is charged with its set-up and its call, but not with fixtures of a wider scope and what the C compiler made for
all (compile_cache): any of the tests that share it may be first. A process's time counts its dead children's; that of
the living is read from the system, so that a server which tests share is charged to the test that it works for. Where
the system does not list processes, dead children alone count.

In CI, an everyday test above its budget fails the run, and so does a sum above the line in house.toml.
"""

from __future__ import annotations

import json
import os
import statistics
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Generator
from pathlib import Path
from typing import Any

import compile_cache
import pytest

BUDGET = 1.0
"""Seconds that an everyday test may cost. What takes longer is made cheaper, or thorough."""
_DOUBT = 4.0
"""A test fails the run beyond so many budgets: the first to use what others share, such as imports of the process that
commands are forked from, pays for it."""
_WORK = 200_000
_REFERENCE, _REFERENCE_RUNS = 10e-3, 620
"""The reference machine: seconds for the piece of work, and plain C runs of benchmarks/bench_kernel.py in a second."""
_EVERY = 60
_HOUSE = Path(__file__).parents[1] / "house.toml"
_CHARGED, _SHARED = "processor_time", "processor_time_shared"
_TICK = os.sysconf("SC_CLK_TCK") if sys.platform == "linux" else 1


def spent() -> float:
    """Seconds of processor time of this process and all that came of it, so far."""
    dead = os.times()
    own = time.process_time() + dead.children_user + dead.children_system
    return own + sum(_of_living(child) for child in _children("self"))


# By `open` and `os`, as tests have put other things in the place of pathlib's methods while this runs.
def _of_living(process: str) -> float:
    try:
        with open(f"/proc/{process}/stat", "rb") as file:
            fields = file.read().rpartition(b")")[2].split()
    except OSError:  # it ended meanwhile
        return 0.0
    ticks = sum(int(each) for each in fields[11:15])  # its own and its dead children's, in user and system mode
    return ticks / _TICK + sum(_of_living(child) for child in _children(process))


def _children(process: str) -> list[str]:
    found: list[str] = []
    try:
        for thread in os.listdir(f"/proc/{process}/task"):
            with open(f"/proc/{process}/task/{thread}/children", encoding="ascii") as file:
                found += file.read().split()
    except OSError:
        pass
    return found


def slowness() -> float:
    """How many times as long as the reference machine this one takes just now."""
    before = time.process_time()
    sum(number & 7 for number in range(_WORK))
    return (time.process_time() - before) / _REFERENCE


class ProcessorTime:
    """Charges tests, and shows at the end what was dear."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self._compilations = compile_cache.account()
        self._start = 0.0
        self._shared: Counter[str] = Counter()
        self._tests: dict[str, float] = {}
        self._fixtures: Counter[str] = Counter()
        self._slowness: list[float] = []
        self._count = 0
        self._failures: list[str] = []

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self) -> Generator[None, Any, Any]:
        if self._count % _EVERY == 0:
            self._slowness.append(slowness())
        self._count += 1
        self._start, self._shared = spent(), Counter()
        self._shared[_COMPILED] = -compile_cache.spent(self._compilations)
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Generator[None, Any, Any]:
        if fixturedef.scope == "function":
            return (yield)
        before = spent() - compile_cache.spent(self._compilations)
        try:
            return (yield)
        finally:
            cost = spent() - compile_cache.spent(self._compilations) - before
            self._shared[f"{fixturedef.baseid}::{fixturedef.argname}"] += cost

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, call: pytest.CallInfo[Any]) -> Generator[None, Any, Any]:
        report = yield
        if call.when == "call":
            self._shared[_COMPILED] += compile_cache.spent(self._compilations)
            cost = spent() - self._start - sum(self._shared.values())
            report.user_properties += [(_CHARGED, cost), (_SHARED, dict(self._shared))]
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call":
            told = dict(report.user_properties)
            self._tests[report.nodeid] = told.get(_CHARGED, 0.0)
            self._fixtures.update(told.get(_SHARED, {}))

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        self._slowness += getattr(node, "workeroutput", {}).get("slowness", [])

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if hasattr(self._config, "workeroutput"):
            self._config.workeroutput["slowness"] = self._slowness
            return
        target = self._config.getoption("--processor-time")
        if target:
            whole = {"whole": spent(), "slowness": self._slowness, "tests": self._tests, "fixtures": self._fixtures}
            Path(target).write_text(json.dumps(whole), encoding="utf-8")
        self._failures = self._too_dear()
        if session.exitstatus == pytest.ExitCode.OK and self._failures:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if not self._tests:
            return
        factor, whole = statistics.median(self._slowness or [1.0]), spent()
        runs = _REFERENCE_RUNS / factor
        terminalreporter.write_line(
            f"processor time: {whole:.0f} s at {runs:.0f} plain C runs/s: {whole * runs / 1e3:.0f} thousand runs"
        )
        for failure in self._failures:
            terminalreporter.write_line(f"processor time: {failure}", red=True)

    def _too_dear(self) -> list[str]:
        """What costs too much, in CI and if these are all everyday tests."""
        if not (os.environ.get("CI") and self._config.getoption("--budget")):
            return []
        factor = statistics.median(self._slowness or [1.0])
        costs = sorted(((cost / factor, name) for name, cost in self._tests.items()), reverse=True)
        wrong = [
            f"{cost:.1f} s of {name}, whose budget is {BUDGET:g} s: make it cheaper, or thorough"
            for cost, name in costs
            if cost > _DOUBT * BUDGET
        ]
        line = tomllib.loads(_HOUSE.read_text("utf-8"))["everyday"]["thousand_runs"]
        work = spent() * _REFERENCE_RUNS / factor / 1e3
        if work > line:
            wrong.append(f"{work:.0f} thousand runs, above the line of {line} in house.toml")
        return wrong


_COMPILED = "what the C compiler made for all tests"
