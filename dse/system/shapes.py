"""Arrays whose size a structural parameter sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite

from dse.domain.fmu import FmuModel, Variable
from dse.errors import fail

MOST_VALUES = 1_000_000
"""An array whose size is set has no more than that: each of its values has a name."""


def resized(model: FmuModel, values: Mapping[str, float]) -> FmuModel:
    """*model* with the shapes its arrays have if its structural parameters take these *values*.

    Raises DseError for a size that is no whole number, or less than none, or makes an array beyond all measure.
    """
    sizes = {name: values[name] for name, v in model.variables.items() if v.is_structural and name in values}
    if not sizes:
        return model
    for name, size in sizes.items():
        if not isfinite(size) or size != int(size) or size < 0:
            raise fail(f"{model.identifier}: the structural parameter '{name}' cannot be {size:g}")
    variables = {name: _resized(v, sizes) for name, v in model.variables.items()}
    for variable in variables.values():
        if variable.size > MOST_VALUES:
            said = ", ".join(
                f"{name} = {int(sizes[name])}" for name in dict.fromkeys(variable.sized_by) if name in sizes
            )
            what = f"{model.identifier}: with {said} the array '{variable.name}' has {variable.size:,} values"
            raise fail(what, hint=f"at most {MOST_VALUES:,} are supported")
    return replace(model, variables=variables)


def _resized(variable: Variable, sizes: Mapping[str, float]) -> Variable:
    shape = tuple(int(sizes.get(name, size)) for size, name in zip(variable.shape, variable.sized_by, strict=True))
    if shape == variable.shape:
        return variable
    # Starts of another size would be those of other elements.
    return replace(variable, shape=shape, start=variable.start if len(variable.start) == 1 else ())
