"""Arrays whose size a structural parameter sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from dse.domain.fmu import FmuModel, Variable
from dse.errors import fail


def resized(model: FmuModel, values: Mapping[str, float]) -> FmuModel:
    """*model* with the shapes its arrays have if its structural parameters take these *values*.

    Raises DseError for a size that is no whole number, or less than none.
    """
    sizes = {name: values[name] for name, v in model.variables.items() if v.is_structural and name in values}
    if not sizes:
        return model
    for name, size in sizes.items():
        if size != int(size) or size < 0:
            raise fail(f"{model.identifier}: the structural parameter '{name}' cannot be {size:g}")
    return replace(model, variables={name: _resized(v, sizes) for name, v in model.variables.items()})


def _resized(variable: Variable, sizes: Mapping[str, float]) -> Variable:
    shape = tuple(int(sizes.get(name, size)) for size, name in zip(variable.shape, variable.sized_by, strict=True))
    if shape == variable.shape:
        return variable
    # Starts of another size would be those of other elements.
    return replace(variable, shape=shape, start=variable.start if len(variable.start) == 1 else ())
