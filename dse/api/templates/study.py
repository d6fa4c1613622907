"""The start of a study: two parameters of a bench's first configuration, on a grid over their ranges."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from dse.api.templates.write import headed
from dse.domain.component import Kind, Parameter
from dse.errors import fail
from dse.formats import write_value

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.design import Configuration
    from dse.loading import Workspace

_VARIED, _LEVELS = 2, 5


def new_study(workspace: Workspace, name: str, bench: str) -> dict[PurePosixPath, str]:
    """The file of a study *name* on *bench*. Raises DseError if nothing there has a range to be varied in."""
    from dse.testbench import one_configuration

    tested = workspace.bench(bench)
    configuration = one_configuration(tested.design, None)
    varied = list(_ranges(tested, configuration))[:_VARIED]
    if not varied:
        what = f"no parameter on '{tested.name}' has both min and max"
        raise fail(what, tested.where, "give a parameter both in its component.yaml: a study varies it between them")
    lines = []
    for path, parameter in varied:
        low, high = (_quantity(parameter, value) for value in (parameter.minimum, parameter.maximum))
        lines.append(f"  {path}: {{range: [{low}, {high}], levels: {_LEVELS}}}\n")
    runs = _LEVELS ** len(varied)
    text = (
        f"study: {name}\ntitle: {name}\ntestbench: {tested.name}\n"
        f"configurations: [{configuration.id}]    # the first; 'all', or {{where: PLACE is COMPONENT}}\n"
        f"design_variables:                # parameters, each over a range\n{''.join(lines)}"
        f"sampler: full_factorial          # {runs} runs for each one; or {{latin_hypercube: {{samples: 100}}}}, …\n"
        "keep_waveforms: all\nseed: 1\n"
    )
    return {PurePosixPath("testbenches", f"{name}.pet.yaml"): headed(text, 1, "study")}


def _ranges(bench: TestBench, configuration: Configuration) -> Iterator[tuple[str, Parameter]]:
    """Real parameters with a range that the bench leaves alone, those of the design first."""
    parts = {**configuration.parts, **{part.name: part.component for part in bench.test_components}}
    given = {f"{part.name}.{label}" for part in bench.test_components for label in part.parameters}
    given |= {*bench.parameters}
    for place, component in parts.items():
        for parameter in component.parameters:
            path = f"{place}.{parameter.name}"
            bounds = (parameter.minimum, parameter.maximum)
            if parameter.type.kind is Kind.REAL and None not in bounds and path not in given and "[" not in path:
                yield path, parameter


def _quantity(parameter: Parameter, value: float | None) -> str:
    unit = parameter.type.unit
    number = write_value(value or 0.0, unit, parameter.where).removesuffix(".0")
    return f"{number} {unit}".rstrip()
