"""What is known of how exactly the FMUs of a system compute; what is not known yet is found out, and kept."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.cache import cache_folder, content_key, keep_content, try_to_put
from dse.domain.bench import Simulation
from dse.domain.component import Component
from dse.domain.facts import PROBE_VERSION, FmuNumerics, Lever
from dse.domain.fmu import FmiInterface, FmuModel
from dse.domain.system import Element, SystemStructure
from dse.errors import DseError
from dse.fmu import in_parallel, open_fmu, this_platform

if TYPE_CHECKING:
    from dse.cosim import ProbeLimits

Say = Callable[[str], None]
"""Is told what is being waited for."""

_SAYS_SO = "its source declares it"


def numerics_of(
    system: SystemStructure,
    simulation: Simulation,
    parts: Mapping[str, Component],
    *,
    cache: Path | None = None,
    say: Say = lambda _: None,
    sandboxed: bool = False,
) -> dict[str, FmuNumerics]:
    """How exact the elements of *system* are, by their names, in the steps of *simulation*.

    *parts* are the components by element. Nothing is tried of one that samples or that its component calls exact.
    """
    found: dict[str, FmuNumerics] = {}
    asked: dict[str, tuple[Element, float, bool]] = {}
    for element in system.elements:
        component = parts.get(element.name)
        source = component.source if component is not None else None
        step = simulation.method.steps.get(element.name, simulation.step)
        if source is not None and source.sample_time is not None:
            found[element.name] = FmuNumerics(step, exact=f"it samples every {source.sample_time:g} s")
        elif not any(variable.kind is not None for variable in element.outputs):
            found[element.name] = FmuNumerics(step, exact="no number of it is used")
        elif source is not None and source.is_exact:
            found[element.name] = FmuNumerics(step, exact=_SAYS_SO)
        else:
            asked[element.name] = element, step, source is not None and not source.is_finished

    def kept(name: str) -> FmuNumerics:
        element, step, is_ours = asked[name]
        return numerics_of_element(
            element, (step, simulation.stop), is_ours=is_ours, cache=cache, sandboxed=sandboxed, say=say
        )

    return found | in_parallel(asked, kept)


def numerics_of_element(
    element: Element,
    times: tuple[float, float] | None = None,
    *,
    is_ours: bool = False,
    limits: ProbeLimits | None = None,
    again: bool = False,
    cache: Path | None = None,
    sandboxed: bool = False,
    say: Say = lambda _: None,
) -> FmuNumerics:
    """What `probe_numerics` finds, or found before of the same unless *again*: kept in the cache by what decides it."""

    def make() -> bytes:
        say(f"finding out how exact {element.model.identifier} is")
        exchange = None if is_ours else exchange_of(element.model, cache=cache)
        from dse.cosim import probe_numerics

        found = probe_numerics(element, times, exchange=exchange, is_ours=is_ours, limits=limits, sandboxed=sandboxed)
        return json.dumps(asdict(found), indent=1, sort_keys=True).encode()

    model = element.model
    if not model.content_hash:
        return _read(make())
    platform, inputs, outputs = (
        this_platform().name,
        *(sorted(v.name for v in e) for e in (element.inputs, element.outputs)),
    )
    decides = (PROBE_VERSION, platform, model.manner, model.experiment.tolerance, times, is_ours)
    given = sorted(element.start.items()), sorted((name, repr(text)) for name, text in element.texts.items())
    key = content_key([("numerics", json.dumps([decides, inputs, outputs, given]).encode())])
    file = cache_folder(cache) / "numerics" / f"{model.content_hash[:32]}-{key[:32]}.json"
    if not again:
        return _read(keep_content(file, make))
    content = make()
    try_to_put(file, content)
    return _read(content)


def numerics_as_data(numerics: FmuNumerics) -> dict[str, Any]:
    """*numerics* as JSON data; what there is none of is null."""
    data = asdict(numerics)
    data |= {name: None for name, value in data.items() if isinstance(value, float) and math.isnan(value)}
    return data | {"changes": {str(lever): change for lever, change in numerics.changes.items()}}


def exchange_of(model: FmuModel, *, cache: Path | None = None) -> FmuModel | None:
    """The same FMU for model exchange, if *model* is for co-simulation and it has both and a library of each."""
    if model.interface is FmiInterface.MODEL_EXCHANGE:
        return None
    exchange = _opened(model.archive, model.content_hash, cache)
    if exchange is None:
        return None
    experiment = replace(exchange.experiment, tolerance=model.experiment.tolerance)
    return replace(exchange, variables=model.variables, experiment=experiment)


@lru_cache(maxsize=100)
def _opened(archive: Path, _: str, cache: Path | None) -> FmuModel | None:
    """The FMU of that content for model exchange; asked for by every configuration that has it."""
    try:
        return open_fmu(archive, cache=cache, interface=FmiInterface.MODEL_EXCHANGE)
    except DseError:
        return None  # co-simulation only: nothing is wrong with that


def _read(content: bytes) -> FmuNumerics:
    data: dict[str, Any] = json.loads(content)
    return FmuNumerics(**{**data, "changes": {Lever(name): change for name, change in data["changes"].items()}})
