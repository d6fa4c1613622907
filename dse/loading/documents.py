"""The shapes of the files a user writes; what they mean is decided by the readers beside this module."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field

from dse.loading.fields import Plain, Scalar, Section


class InterfaceSection(Section):
    """One interface: ports by name, groups of ports nested."""

    title: str = ""
    inputs: dict[str, Any] = {}
    outputs: dict[str, Any] = {}


class InterfacesFile(Section):
    """``interfaces.yaml``."""

    interfaces: dict[str, InterfaceSection]


class ParameterSection(Section):
    """One parameter of a component."""

    start: Scalar
    min: Plain | None = None
    max: Plain | None = None
    unit: str | None = None
    enum: list[str] | None = None
    type: str | None = None
    tunable: bool = True
    title: str = ""


class FactsSection(Section):
    """A component without a source, as one of many in a file."""

    title: str = ""
    implements: str | None = None
    parameters: dict[str, ParameterSection] = {}
    properties: dict[str, Plain] = {}


class ComponentFile(FactsSection):
    """``component.yaml``. What stands below *source* is read by its kind."""

    component: str
    source: dict[str, Any] | None = None
    map: dict[str, str] = {}


class CollectionFile(Section):
    """Any other file below ``components/``: many components in one."""

    components: dict[str, FactsSection]


class ConstraintSection(Section):
    """One static constraint: exactly one of the keys before *because*."""

    require: str | None = None
    forbid: list[str] | None = None
    require_with: dict[str, str | list[str]] | None = None
    same_choice: list[str] | None = None
    at_least: dict[str, list[str]] | None = None
    at_most: dict[str, list[str]] | None = None
    exactly: dict[str, list[str]] | None = None
    range: dict[str, list[Plain]] | None = None
    because: str = ""
    set: str | None = None


class ConstraintSetSection(Section):
    """A set of constraints that is switched on and off as one."""

    on: bool = True
    title: str = ""


class DesignFile(Section):
    """``designs/*.yaml``. The tree below *root* is read by hand: its shape depends on what it says."""

    design: str
    title: str = ""
    root: dict[str, Any]
    constraints: dict[str, ConstraintSection] = {}
    constraint_sets: dict[str, ConstraintSetSection] = {}


class TestComponentSection(Section):
    """A part of the bench."""

    component: str
    parameters: dict[str, Scalar] = {}


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


class MetricSection(Section):
    """A metric with a title or display unit; plain text is the expression alone."""

    expression: str
    unit: str | None = None
    title: str = ""


class RequirementSection(Section):
    """A bound on a metric."""

    metric: str
    title: str = ""
    at_most: Plain | None = None
    at_least: Plain | None = None
    exercised_when: str | None = None


class FigureSection(Section):
    """A waveform against its target."""

    current: str
    target: str | None = None
    unit: str | None = None
    title: str = ""


class BenchFile(Section):
    """``testbenches/*.yaml``."""

    testbench: str
    title: str = ""
    design: str
    test_components: dict[str, TestComponentSection] = {}
    connections: list[str] = []
    parameters: dict[str, Scalar] = {}
    simulation: SimulationSection
    metrics: dict[str, str | MetricSection] = {}
    requirements: dict[str, RequirementSection] = {}
    figures: dict[str, FigureSection] = {}


class VariableSection(Section):
    """One design variable."""

    range: list[Plain] = Field(min_length=2, max_length=2)
    levels: int | None = None
    nominal: Plain | None = None
    title: str = ""


class SelectionSection(Section):
    """Configurations by condition."""

    later: ClassVar[frozenset[str]] = frozenset({"sample"})

    where: str


class StudyFile(Section):
    """``*.pet.yaml``."""

    later: ClassVar[frozenset[str]] = frozenset({"objectives", "uncertain"})

    study: str
    title: str = ""
    testbench: str
    configurations: str | list[str] | SelectionSection = "all"
    design_variables: dict[str, VariableSection]
    sampler: str | dict[str, Any] = "full_factorial"
    executor: str | dict[str, Any] = "local"
    keep_waveforms: str = "near_boundary"
    seed: int = 0
