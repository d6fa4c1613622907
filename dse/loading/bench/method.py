"""Reads by which co-simulation algorithm a test bench is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import ClassVar, TypeVar

from dse.domain.bench import Simulation, is_multiple
from dse.domain.component import Type
from dse.domain.method import PLAIN, Adaptive, Algorithm, Bond, Coupling, Extrapolation, Method
from dse.errors import DseError, Location, Problems, closest, fail
from dse.formats import Entry
from dse.loading.bench.candidates import Candidates, outputs, split_name, types_of
from dse.loading.names import check_name
from dse.loading.sections import Plain, Section
from dse.loading.values import Raw, read_number, read_unit
from dse.units import DIMENSIONLESS, describe, multiply

_MOST_TIMES = 1e9

E = TypeVar("E", bound=StrEnum)


class AdaptiveSection(Section):
    """Error control of the communication step."""

    tolerance: Plain = 1e-4
    absolute: Plain = 1e-6
    smallest: Plain = "1 us"


class BondSection(Section):
    """A power bond: two ports whose product is a power."""

    effort: str
    flow: str


class SimulationSection(Section):
    """How long, how fine, by what algorithm, what is kept."""

    hints: ClassVar[Mapping[str, str]] = {
        "algorithm": "jacobi or gauss_seidel",
        "coupling": "none, propagate or solve",
        "extrapolation": "hold or linear; for single parts {part: linear}",
        "steps": "write it as {part: 1 ms}",
        "adaptive": "write it as {tolerance: 1e-4, absolute: 1e-6, smallest: 1 us}, or {} for these defaults",
        "bonds": "write it as {name: {effort: part.port, flow: other.port}}",
    }

    stop: Plain
    step: Plain
    record: list[str] = []
    record_every: Plain | None = None
    timeout: Plain = "60 s"
    memory: Plain = "4 GB"
    algorithm: str = "jacobi"
    coupling: str = "none"
    extrapolation: str | dict[str, str] = "hold"
    steps: dict[str, Plain] = {}
    adaptive: AdaptiveSection | None = None
    bonds: dict[str, BondSection] = {}
    check_step: bool = False
    tolerance: Plain | None = None


def read_method(
    entry: Entry, section: SimulationSection, step: float, components: Candidates, problems: Problems
) -> Method:
    """The keys of ``simulation`` that choose the algorithm; *step* is the bench's, in seconds.

    *components* are what can stand at each place. What is wrong is added to *problems*; the result is then of no use.
    """
    places = _places(components)
    own: dict[str, Extrapolation] = {}
    everywhere = Extrapolation.HOLD
    written = entry["extrapolation"]
    if isinstance(section.extrapolation, str):
        everywhere = _one_of(Extrapolation, section.extrapolation, written, problems)
    else:
        for part, word in section.extrapolation.items():
            _check_place(written[part], places, problems)
            own[part] = _one_of(Extrapolation, word, written[part], problems)
    return Method(
        algorithm=_one_of(Algorithm, section.algorithm, entry["algorithm"], problems),
        coupling=_one_of(Coupling, section.coupling, entry["coupling"], problems),
        extrapolation=everywhere,
        extrapolations=own,
        steps=_steps(entry["steps"], section, step, places, problems),
        adaptive=_adaptive(entry["adaptive"], section.adaptive, step, problems) if section.adaptive else None,
        bonds=tuple(_bond(entry["bonds"][name], bond, components, problems) for name, bond in section.bonds.items()),
    )


def read_positive(entry: Entry, raw: Raw, unit: str, problems: Problems) -> float | None:
    """An SI number above zero, which is in *unit* if it has none; None with what is wrong with it."""
    where = entry.where if entry.is_there else Entry(entry.document, entry.path[:-1]).key
    with problems:
        value = read_number(raw, read_unit(unit, where), where)
        if value > 0:
            return value
        problems.add(f"'{entry.name}' must be positive, not {raw}", where)
    return None


def read_tolerance(entry: Entry, raw: Raw, problems: Problems) -> float | None:
    """A relative tolerance; None with what is wrong with it."""
    tolerance = read_positive(entry, raw, "", problems)
    if tolerance is not None and tolerance >= 1.0:
        problems.add(f"'{entry.name}' must be below 1", entry.where, "as 1e-4")
        return None
    return tolerance


def _places(components: Candidates) -> set[str]:
    """Every path at which a part or an architecture with parts can stand."""
    steps = (path.split(".") for path in components)
    return {".".join(step[:length]) for step in steps for length in range(1, len(step) + 1)}


def _check_place(part: Entry, places: set[str], problems: Problems) -> None:
    if part.name not in places:
        problems.add(f"'{part.name}' names no part", part.key, closest(part.name, places))


def _one_of(words: type[E], word: str, entry: Entry, problems: Problems) -> E:
    known = {str(one): one for one in words}
    if word not in known:
        problems.add(f"'{word}' is none of {', '.join(known)}", entry.where, closest(word, known))
    return known.get(word, next(iter(words)))


def _steps(
    entry: Entry, section: SimulationSection, step: float, places: set[str], problems: Problems
) -> dict[str, float]:
    found: dict[str, float] = {}
    for part, raw in section.steps.items():
        _check_place(entry[part], places, problems)
        own = read_positive(entry[part], raw, "s", problems)
        if own is None:
            continue
        long, short = max(own, step), min(own, step)
        if not is_multiple(long, short) or long / short >= _MOST_TIMES:
            what = f"the step of '{part}' ({raw}) is neither a multiple nor a fraction of 'step' ({section.step})"
            problems.add(what, entry[part].where, "parts exchange values on one grid of time")
        elif own > step and section.adaptive:
            what = f"'{part}' cannot have a longer step than the others where steps are adaptive"
            problems.add(what, entry[part].where, "leave out 'adaptive' or this step")
        found[part] = own
    return found


def _adaptive(entry: Entry, section: AdaptiveSection, step: float, problems: Problems) -> Adaptive:
    tolerance = read_tolerance(entry["tolerance"], section.tolerance, problems)
    absolute = read_positive(entry["absolute"], section.absolute, "", problems)
    smallest = read_positive(entry["smallest"], section.smallest, "s", problems)
    if smallest is not None and smallest > step:
        what = f"'smallest' ({section.smallest}) is longer than the step"
        problems.add(what, entry["smallest"].where, "the step is what adaptive steps begin with")
    return Adaptive(tolerance or 1.0, absolute or 1.0, smallest or 1.0)


def _bond(entry: Entry, section: BondSection, components: Candidates, problems: Problems) -> Bond:
    check_name(entry.name, entry.key, problems)
    dimensions = []
    for key, signal in (("effort", section.effort), ("flow", section.flow)):
        with problems:
            dimensions.append(_output(signal, components, entry[key].where).unit.dimension)
    if len(dimensions) == 2 and multiply(*dimensions) != read_unit("W", entry.key).dimension:
        found = describe(multiply(*dimensions)) if multiply(*dimensions) != DIMENSIONLESS.dimension else "no unit"
        what = f"'{section.effort}' times '{section.flow}' is not a power: it is {found}"
        problems.add(what, entry.key, "name an effort and the flow that goes with it")
    return Bond(entry.name, section.effort, section.flow)


def _output(signal: str, components: Candidates, where: Location) -> Type:
    place, port = split_name(signal, components, where)
    types_of(signal, components, where)
    known = outputs(components[place])
    if port not in known:
        raise fail(f"'{signal}' is not an output", where, closest(port, known))
    return known[port]


# Reads how long, how finely and what a test bench simulates.


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
