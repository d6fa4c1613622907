"""``source: {kind: scenario}``: the road users of an OpenSCENARIO file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.component import Component, Source
from dse.errors import Location, Problem, closest, raise_if_any
from dse.kinds._generated import build_generated
from dse.loading import ComponentKind, SourcePlace, SourceSection

if TYPE_CHECKING:
    from dse.world import Scenario

_INTERFACE = "scenario"


Values = dict[str, str | int | float | bool]
"""Of parameters of a scenario, as they are written."""


class ScenarioSection(SourceSection):
    """The keys of ``source``: the file, values of parameters that are decided at build time, and the host."""

    file: str
    values: Values = {}
    host: str | None = None


@dataclass(frozen=True, slots=True)
class ScenarioSource(Source):
    """The scenario of *file* with *values* of its parameters; the configuration under test is its entity *host*."""

    kind = "scenario"
    label = "OpenSCENARIO"

    file: Path
    inside: Path | None
    values: tuple[tuple[str, str], ...]
    host: str | None
    where: Location | None = None

    @property
    def is_exact(self) -> bool:
        """Road users advance by steps."""
        return False


class ScenarioKind(ComponentKind[ScenarioSection, ScenarioSource]):
    """The storyboard becomes tables that a core in C walks ('dse docs scenarios')."""

    section = ScenarioSection

    def read(self, section: ScenarioSection, place: SourcePlace) -> ScenarioSource:
        """The file is opened when it is needed."""
        file = place.file(section.file, (".xosc",), "file")
        return ScenarioSource(file, place.inside, written_values(section.values), section.host, place.at("file"))

    def build(self, component: Component, source: ScenarioSource, *, version: int, cache: Path | None) -> Path:
        """The FMU. Raises DseError with what is wrong in the scenario, or not supported."""
        from dse.world import SCENARIO, scenario_files

        files = scenario_files(_checked(component, source))
        return build_generated(component, files, SCENARIO, version=version, cache=cache)

    def check(self, component: Component, source: ScenarioSource) -> tuple[()]:
        """Raise DseError with what is wrong in the scenario, or not supported."""
        _checked(component, source)
        return ()

    def labels(self, component: Component, source: ScenarioSource) -> Mapping[str, tuple[str, ...]]:
        """The elements of the storyboard, for its states."""
        return {"states": tuple(element.name for element in scenario_of(source).elements)}


def scenario_of(source: ScenarioSource) -> Scenario:
    """The scenario. Raises DseError with what is wrong in it, or not supported."""
    from dse.world import read_scenario

    return read_scenario(source.file, dict(source.values), source.host, source.inside)


def _checked(component: Component, source: ScenarioSource) -> Scenario:
    from dse.world import OWN_PARAMETERS

    problems = []
    if component.interface.name != _INTERFACE:
        what = f"component '{component.name}': a scenario implements '{_INTERFACE}', not '{component.interface.name}'"
        problems.append(Problem(what, component.where, f"implements: {_INTERFACE}"))
    scenario = scenario_of(source)
    known = [each.name for each in scenario.parameters]
    named = {each.name for each in component.parameters}
    for each in component.parameters:
        if each.name in scenario.decided:
            hint = f"set it under 'source': values: {{{each.name}: …}}"
            problems.append(Problem(f"'{each.name}' is decided when the scenario is built", each.where, hint))
        elif each.name not in (*known, *OWN_PARAMETERS):
            problems.append(
                Problem(f"the scenario has no parameter '{each.name}'", each.where, closest(each.name, known))
            )
        elif each.tunable:
            problems.append(Problem(f"'{each.name}' must not be tunable: a scenario reads it at the start", each.where))
    if missing := [name for name in (*OWN_PARAMETERS, *known) if name not in named]:
        what = f"component '{component.name}': the scenario also needs {', '.join(map(repr, missing))}"
        problems.append(Problem(what, component.where, "'dse import scenario' writes them all"))
    raise_if_any(problems)
    return scenario


def written_values(values: Values) -> tuple[tuple[str, str], ...]:
    """*values* as an OpenSCENARIO file has them, by name."""
    texts = {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in values.items()}
    return tuple(sorted(texts.items()))


KIND = ScenarioKind()
