"""The address of a configuration's runs: what decides their results, taken from what is simulated.

No path, no title and no order that does not matter goes into it, nor how a configuration is called; neither do facts of
FMUs, threads and fused libraries, as none of these changes a bit of a result.
"""

from __future__ import annotations

import json
import math
import platform
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from functools import cache
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from dse import __version__
from dse.cache import content_key
from dse.domain.address import NOT_GIVEN, Address
from dse.domain.facts import Question
from dse.domain.fmu import FmuModel
from dse.domain.run import TESTBENCH
from dse.domain.system import Element
from dse.metrics import MetricProgram
from dse.testbench.multi_bench import Prepared, singly
from dse.testbench.prepared_bench import PreparedBench
from dse.testbench.variations import Variation

_CODE = ("cosim", "csolve", "metrics", "testbench/runner.py", "testbench/multi_bench.py", "testbench/comparison.py")
"""What of dse makes a run's numbers from FMUs, which hold their own code."""

_KERNEL = "cosim/_kernel.so"


def address_of(prepared: Prepared) -> Address | None:
    """What names the runs of *prepared*; None if nothing does.

    The result of an FMU that needs another program, or was seen to differ from process to process, does not follow
    from what is known here.
    """
    addresses = [address for bench in singly(prepared) if (address := _address(bench))]
    if len(addresses) < len(singly(prepared)):
        return None
    return addresses[0] if len(addresses) == 1 else _joint(addresses)


def _joint(addresses: Sequence[Address]) -> Address:
    """What names the runs of a configuration on several benches, each of which has one of *addresses*."""
    starts = np.cumsum([1, *(len(each.names) for each in addresses)]).tolist()
    places: dict[str, tuple[int, ...]] = {TESTBENCH: (0,)}
    for start, each in zip(starts, addresses, strict=False):
        for name, at in each.places.items():
            places[name] = (*places.get(name, ()), *(start + position for position in at))
    return Address(
        content_key([(f"bench {number}", each.key.encode()) for number, each in enumerate(addresses)]),
        (TESTBENCH, *(f"{number} {name}" for number, each in enumerate(addresses) for name in each.names)),
        np.zeros(1, dtype="<f8").tobytes() + b"".join(each.values for each in addresses),
        places,
        addresses[0].machine,
    )


def _address(prepared: PreparedBench) -> Address | None:
    elements = prepared.system.elements
    if any(_is_open(element, prepared) for element in elements):
        return None
    used = set(prepared.program.constants)
    given = {f"{element.name}.{name}": value for element in elements for name, value in element.start.items()}
    given |= {s.target: float(NOT_GIVEN[0]) for s in prepared.settings.values() if s.target not in given}
    # Two kinds of names share no space: what is given to FMUs, and what metrics are computed with.
    given |= {f"= {name}": s.value for name, s in prepared.settings.items() if name in used}
    names = tuple(sorted(given))
    position = {name: number for number, name in enumerate(names)}
    places = {
        name: tuple(position[end] for end in (setting.target, f"= {name}") if end in position)
        for name, setting in prepared.settings.items()
    }
    values = np.array([given[name] for name in names], dtype="<f8").tobytes()
    return Address(_key(prepared), names, values, places, machine_key())


@cache
def machine_key() -> str:
    """What names the arithmetic of this machine: where it is the same, an FMU gives the same bits.

    The C library chooses its functions by the processor, so that two machines with the same programs may differ in a
    last bit: what sine, power and the like come to here is part of it.
    """
    x = np.linspace(0.01, 20.0, 1999)
    functions = (math.sin, math.cos, math.tan, math.atan, math.exp, math.log, math.tanh, math.sqrt, math.cbrt)
    scalars = np.array([[f(value) for value in x.tolist()] for f in functions])
    powers = np.array([math.pow(value, 0.3 + value / 7) for value in x.tolist()])
    arrays = np.array([np.sin(x), np.exp(x), np.log(x), np.sqrt(x), np.cumsum(x), np.tanh(x)])
    kernel = Path(__file__).parents[1] / _KERNEL
    return content_key([
        ("machine", repr((sys.platform, platform.machine(), platform.libc_ver(), np.__version__)).encode()),
        ("numbers", scalars.tobytes() + powers.tobytes() + arrays.tobytes()),
        ("kernel", kernel.read_bytes() if kernel.is_file() else b""),
    ])  # fmt: skip


def _is_open(element: Element, prepared: PreparedBench) -> bool:
    facts = prepared.facts.get(element.name)
    needs = element.model.capabilities.needs_tool or not element.model.content_hash
    return needs or (facts is not None and facts.denies(Question.REPEATS))


def _key(prepared: PreparedBench) -> str:
    simulation, recording = prepared.simulation, prepared.recording
    decides = {
        "dse": (__version__, _own_code()),
        "elements": [_element(element) for element in prepared.system.elements],
        "wires": sorted(map(repr, prepared.system.wires)),
        "settings": {name: (setting.target, str(setting.type.kind)) for name, setting in prepared.settings.items()},
        "times": (simulation.stop, simulation.step, simulation.record_every, simulation.check_step),
        "method": asdict(simulation.method),
        "tolerance": simulation.tolerance,
        "compared": [_variation(variation) for variation in prepared.checks.variations],
        "unmeasured": prepared.checks.unmeasured,
        "unless": prepared.checks.unless,
        "exact": sorted(prepared.checks.exact),
        "columns": sorted(zip(recording.columns, recording.variables, strict=True)),
        "kept": sorted(recording.kept),
        "measures": _measures(prepared.program),
        "requirements": sorted(requirement.name for requirement in prepared.requirements),
    }
    if prepared.derived:
        decides["derived"] = {name: _measures(follows.program) for name, follows in prepared.derived.items()}
    return content_key([("decides", json.dumps(decides, sort_keys=True, default=_plain).encode())])


def _variation(variation: Variation) -> dict[str, Any]:
    parts = [(e.name, str(e.model.interface), e.model.experiment.tolerance) for e in variation.system.elements]
    return {"what": variation.what, "step": variation.step, "method": asdict(variation.method), "parts": parts}


def _element(element: Element) -> dict[str, Any]:
    return {
        "name": element.name,
        "fmu": (element.model.content_hash, element.model.manner, _compiled(element.model)),
        "inputs": sorted(variable.name for variable in element.inputs),
        "outputs": sorted(variable.name for variable in element.outputs),
        "texts": {name: _content_of(text) for name, text in element.texts.items()},
        "conversions": {name: repr(conversion) for name, conversion in element.conversions.items()},
    }


def _content_of(text: str | bytes) -> object:
    """What a text tells an FMU: of a file its content, wherever it lies."""
    if isinstance(text, bytes):
        return ("bytes", text.hex())
    if not Path(text).is_absolute():
        return text
    try:
        return ("file", sha256(Path(text).read_bytes()).hexdigest())
    except (OSError, ValueError):
        return text


def _compiled(model: FmuModel) -> str:
    """The digest of a library that does not come with the FMU, but is compiled here from its sources."""
    return "" if model.library.is_relative_to(model.folder) else _digest_of([model.library])


def _measures(program: MetricProgram) -> dict[str, Any]:
    """Every metric and requirement by what is computed for it: how that is written, and in which order, is left out."""
    terms: dict[int, str] = {0: "time"} | {register: value.hex() for register, value in program.literals}
    for name, register in program.inputs.items():
        terms[register] = f"{'waveform' if name in program.signals else 'value'} {name}"
    for step in program.instructions:
        arguments = [terms[register] for register in step.arguments]
        terms[step.target] = content_key([("call", json.dumps([_named(step.function), *arguments]).encode())])
    checks = {
        check.requirement: (
            check.at_most,
            check.at_least,
            terms[check.metric],
            None if check.exercised is None else terms[check.exercised],
            sorted(terms[register] for register in check.condition_metrics),
        )
        for check in program.checks
    }
    return {"metrics": {name: terms[register] for name, register in program.metrics.items()}, "checks": checks}


def _named(function: Callable[..., Any]) -> tuple[str, str, str]:
    module = getattr(function, "__module__", None) or "numpy"  # as universal functions have none
    return module, function.__name__, _code_of(module.partition(".")[0])


@cache
def _code_of(package: str) -> str:
    """What names the code of a top-level package that gives metric functions."""
    if package == "dse":
        return ""
    if package == "numpy":
        return np.__version__
    file = Path(getattr(import_module(package), "__file__", None) or "")
    return _digest_of(_sources(file.parent) if file.name == "__init__.py" else [file])


@cache
def _own_code() -> str:
    room = Path(__file__).parents[1]
    return _digest_of(file for name in _CODE for file in (_sources(room / name) if "." not in name else [room / name]))


def _sources(folder: Path) -> list[Path]:
    return sorted(file for file in folder.rglob("*") if file.suffix in (".py", ".c", ".h"))


def _digest_of(files: Iterable[Path]) -> str:
    digest = sha256()
    for file in files:
        digest.update(sha256(file.read_bytes()).digest() if file.is_file() else b"none")
    return digest.hexdigest()


def _plain(value: object) -> object:
    if isinstance(value, Mapping):
        return dict(value)
    return value.hex() if isinstance(value, bytes) else str(value)
