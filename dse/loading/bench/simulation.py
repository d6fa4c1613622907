"""Reads how long, how finely and what a test bench simulates."""

from __future__ import annotations

from collections.abc import Mapping

from dse.domain.bench import Simulation
from dse.domain.method import PLAIN
from dse.errors import DseError, Problems
from dse.formats import Entry
from dse.loading.bench.candidates import Candidates
from dse.loading.bench.method import SimulationSection, is_multiple, read_method, read_positive, read_tolerance
from dse.loading.values import Raw, read_number, read_unit

_MAX_STEPS = 10_000_000
_MAX_TIMEOUT = 10_000_000.0
_LEAST_MEMORY = 256e6


def read_simulation(
    entry: Entry, section: SimulationSection, components: Candidates | None, problems: Problems
) -> Simulation:
    """The section ``simulation``; what is wrong with it is added to *problems*, and the result is then of no use.

    *components* are what can stand at each place; None, if that is not known, leaves out the algorithm.
    """
    raw: dict[str, Raw] = {"stop": section.stop, "step": section.step}
    if section.record_every is not None:
        raw["record_every"] = section.record_every
    found = {key: read_positive(entry[key], text, "s", problems) for key, text in raw.items()}
    times = {key: value for key, value in found.items() if value is not None}
    timeout = read_positive(entry["timeout"], section.timeout, "s", problems) or 1.0
    if timeout > _MAX_TIMEOUT:
        problems.add(f"'timeout' is longer than {_MAX_TIMEOUT:.0f} s", entry["timeout"].where, "use a shorter one")
    stop, step = times.get("stop", 1.0), times.get("step", 1.0)
    if "stop" in times and "step" in times and stop > _MAX_STEPS * step:
        what = f"'stop' ({section.stop}) takes more than {_MAX_STEPS:,} steps of {section.step}"
        problems.add(what, entry["stop"].where, "use a longer step or an earlier stop")
    else:
        _require_multiples(entry, raw, times, problems)
    for number, name in enumerate(section.record):
        if name in section.record[:number]:
            problems.add(f"'{name}' is recorded twice", entry["record"][number].where, "remove one")
    return Simulation(
        stop,
        step,
        tuple(section.record),
        times.get("record_every", step),
        timeout,
        entry.key,
        PLAIN if components is None else read_method(entry, section, step, components, problems),
        section.check_step,
        _memory(entry["memory"], section.memory, problems),
        None if section.tolerance is None else read_tolerance(entry["tolerance"], section.tolerance, problems),
    )


def _require_multiples(entry: Entry, raw: Mapping[str, Raw], times: Mapping[str, float], problems: Problems) -> None:
    for whole, part in (("stop", "step"), ("record_every", "step"), ("stop", "record_every")):
        if whole in times and part in times and not is_multiple(times[whole], times[part]):
            what = f"'{whole}' ({raw[whole]}) is not a multiple of '{part}' ({raw[part]})"
            problems.add(what, entry[whole].where, "runs have a fixed number of equal steps")


def _memory(entry: Entry, raw: Raw, problems: Problems) -> float:
    """How much memory a simulation may use, in bytes."""
    byte = read_unit("B", entry.where)
    try:
        value = read_number(raw, byte, entry.where) / float(byte.factor)  # the registry counts in bits
    except DseError:
        problems.add(f"'memory' is not an amount of memory: '{raw}'", entry.where, "write it as '4 GB'")
        return _LEAST_MEMORY
    if value < _LEAST_MEMORY:
        shown = raw if isinstance(raw, str) and not raw[-1:].isdigit() else f"{raw} B"
        what = f"'memory' is {shown}, less than a simulating process needs by itself"
        problems.add(what, entry.where, "write it as '4 GB'; at least 256 MB")
    return value
