"""What every kind of component has to do, as tests over an example of it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from dse.cache import content_key
from dse.cosim import Simulator
from dse.domain.component import Causality, Component, Kind, Parameter, Port, Value
from dse.domain.labels import array_of
from dse.errors import DseError
from dse.fmu import build, open_fmu
from dse.formats import read_yaml
from dse.loading import KINDS, Workspace, kind_of
from dse.system import WiredParts, assemble, check_fmu

Files = Mapping[str, str | bytes]
"""Texts and contents by path below ``components/`` of a workspace: interfaces.yaml, NAME/component.yaml, …"""


class KindSuite:
    """Derive a class ``TestMine`` from this, with the fixture `example`, and pytest runs what is here.

    The example has one component, with a port and a parameter. Another start of the first parameter changes an output
    within a second, if all inputs are held at 1.
    """

    versions: tuple[int, ...] = (2, 3)
    """Versions of FMI the kind builds for."""

    @pytest.fixture
    def example(self) -> Files:
        raise NotImplementedError("let the fixture 'example' return the files of one component of the kind")

    @pytest.fixture
    def root(self, example: Files, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        """A workspace with the example in it."""
        monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
        return lay_out(example, tmp_path / "workspace")

    @pytest.fixture
    def component(self, root: Path) -> Component:
        return the_component(root)

    @pytest.fixture
    def cache(self, example: Files, tmp_path_factory: pytest.TempPathFactory) -> Path:
        """A cache folder that the tests of the example share, so that its FMU is built once."""
        contents = ((name, text if isinstance(text, bytes) else text.encode()) for name, text in example.items())
        return tmp_path_factory.getbasetemp() / f"kind-{content_key(contents)}"

    def test_the_example_is_read_as_this_kind(self, root: Path, component: Component) -> None:
        word = read_yaml(component_file(root)).data["source"]["kind"]
        assert component.source is not None
        assert component.source.kind == word
        assert kind_of(component) is KINDS.get(word)
        assert component.source.label
        assert component.interface.ports
        assert component.parameters

    def test_it_is_the_same_when_it_is_read_again(self, root: Path, component: Component) -> None:
        assert the_component(root) == component
        assert hash(the_component(root).source) == hash(component.source)

    def test_an_unknown_key_is_refused_where_it_stands(self, root: Path) -> None:
        file = component_file(root)
        text = file.read_text(encoding="utf-8")
        start = re.search(r"^source:\s*(?:\{\s*|\n(?P<indent>\s+))", text, re.MULTILINE)
        assert start is not None, f"there is no mapping 'source' in {file}"
        end = ", " if start["indent"] is None else f"\n{start['indent']}"
        file.write_text(f"{text[: start.end()]}no_such_key: 1{end}{text[start.end() :]}", encoding="utf-8")
        with pytest.raises(DseError) as caught:
            the_component(root)
        (problem,) = caught.value.problems
        assert problem.what == "unknown key 'no_such_key'"
        assert problem.where is not None
        assert Path(problem.where.file).name == file.name
        assert problem.where.line == text.count("\n", 0, start.end()) + 1

    def test_dse_check_has_nothing_against_it(self, component: Component) -> None:
        kind = kind_of(component)
        assert kind is not None
        kind.check(component, component.source)

    def test_its_fmu_has_the_ports_and_parameters(self, component: Component, cache: Path) -> None:
        for version in self.versions:
            model = open_fmu(build(component, version=version, cache=cache), cache=cache)
            check_fmu(component, model)
            for port in component.interface.ports:
                name = component.variable(port.name)  # in FMI 3, an array is one variable
                variable = model.variables.get(name) or model.variables[array_of(name) or name]
                assert variable.causality == str(port.causality)

    def test_its_fmu_is_the_same_bytes_in_any_folder(
        self, example: Files, component: Component, cache: Path, tmp_path: Path
    ) -> None:
        elsewhere = the_component(lay_out(example, tmp_path / "another workspace"))
        for version in self.versions:
            first = build(component, version=version, cache=cache)
            second = build(elsewhere, version=version, cache=tmp_path / "another cache")
            assert first != second
            assert first.name == second.name
            assert first.read_bytes() == second.read_bytes()

    def test_a_start_of_a_parameter_reaches_the_simulation(self, component: Component, cache: Path) -> None:
        first = component.parameters[0]
        other = replace(first, start=another(first))
        changed = replace(component, parameters=(other, *component.parameters[1:]))
        plain, started = simulated(component, cache), simulated(changed, cache)
        assert np.isfinite(plain).all()
        assert not np.array_equal(plain, started), f"no output changes with '{first.name}'"
        if first.tunable:
            given = simulated(component, cache, {f"part.{first.name}": other.start})
            assert np.array_equal(given, started), f"a start of '{first.name}' is not what a run is given"


def lay_out(example: Files, root: Path) -> Path:
    """Write *example* into the workspace *root*; returns *root*."""
    for name, content in example.items():
        path = root / "components" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return root


def component_file(root: Path) -> Path:
    """The one component.yaml of the workspace *root*."""
    (file,) = (root / "components").rglob("component.yaml")
    return file


def the_component(root: Path) -> Component:
    """The component of the workspace *root*, read anew."""
    return Workspace(root).component(component_file(root).parent.name)


def another(parameter: Parameter) -> Value:
    """A value *parameter* can have that is not its start."""
    start, kind = parameter.start, parameter.type.kind
    if kind is Kind.BOOLEAN:
        return not start
    if kind is Kind.ENUMERATION:
        return next(item for item in parameter.type.items if item != start)
    assert isinstance(start, int | float), "let the first parameter be no text"
    low = -np.inf if parameter.minimum is None else parameter.minimum
    high = np.inf if parameter.maximum is None else parameter.maximum
    return next(value for value in (start + 1, start - 1, high, low) if value != start and low <= value <= high)


def simulated(component: Component, cache: Path, values: Mapping[str, Value] | None = None) -> NDArray[Any]:
    """All outputs of *component*, as the part ``part``, over a second with all inputs at 1."""
    model = open_fmu(build(component, cache=cache), cache=cache)
    ports = component.interface.ports
    held = {f"part.{port.name}": _one(port) for port in ports if port.causality is Causality.INPUT}
    outputs = [port.name for port in ports if port.causality is Causality.OUTPUT]
    wired = WiredParts({"part": component}, values={**held, **(values or {})})
    system = assemble("tested", wired, {component.name: model}, [f"part.{name}" for name in outputs])
    sample_time = component.source.sample_time if component.source is not None else None
    with Simulator(system, [f"part.{component.variable(name)}" for name in outputs]) as simulator:
        return simulator.run(stop=1.0, step=sample_time or 0.01)


def _one(port: Port) -> Value:
    if port.type.kind is Kind.ENUMERATION:
        return port.type.items[-1]
    return True if port.type.kind is Kind.BOOLEAN else 1
