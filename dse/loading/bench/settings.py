"""Values that a bench gives to parameters and inputs: single ones, and those of a whole array."""

from __future__ import annotations

from math import prod

from dse.domain.component import Component, Value
from dse.domain.labels import array_of, element_names, shapes, spelled, tightened
from dse.errors import Location, fail
from dse.formats import Entry
from dse.loading.bench.candidates import Candidates, settable, split_name
from dse.loading.values import Elements, Raw, read_elements, read_value


def read_settings(name: str, raw: Raw | Elements, components: Candidates, entry: Entry) -> dict[str, Value]:
    """What stands at *entry* for ``part.parameter`` (or an input), by name: of an array a value for each element.

    A single value is for all elements. Raises DseError, also for another shape than the array has.
    """
    name = tightened(name)
    place, own = split_name(name, components, entry.key)
    named = [(*(p.name for p in c.parameters), *(p.name for p in c.interface.ports)) for c in components[place]]
    arrays = [[label.removeprefix(own) for label in labels if array_of(label) == own] for labels in named]
    wanted = {shapes(labels)[""] for labels in arrays if labels}
    if not wanted and isinstance(raw, list):
        raise fail(f"'{name}' is not an array, but is given a list", entry.where, "write one value")
    shape, values = read_elements(raw, entry)
    if wanted and not shape:
        shape = max(wanted)
        values *= prod(shape)
    if wanted and wanted != {shape}:
        theirs = " or ".join(map(spelled, sorted(wanted)))
        raise fail(f"'{name}' is given {spelled(shape)}, but is {theirs}", entry.where, "give a value for each element")
    return {
        label: read_setting(label, value, components, entry.key, where)
        for label, (value, where) in zip(element_names(name, shape), values, strict=True)
    }


def read_setting(name: str, raw: Raw, components: Candidates, key: Location, where: Location) -> Value:
    """The value *raw* for ``part.parameter`` (or an input): SI, checked against type and range. Raises DseError."""
    found = settable(name, components, key)
    values = {read_value(raw, type_, where) for _, type_ in found}
    if len(values) > 1:
        raise fail(f"'{raw}' means different values in the alternatives of '{name}'", where, "add a unit")
    (value,) = values
    port = split_name(name, components, key)[1]
    for component, _ in found:
        _check_range(component, port, value, where)
    return value


def _check_range(component: Component, port: str, value: Value, where: Location) -> None:
    """Raise DseError if *value* (SI) is outside the range of the component's parameter."""
    parameter = component.parameter(port)
    if parameter is None or isinstance(value, str | bool):
        return
    low, high, unit = parameter.minimum, parameter.maximum, parameter.type.unit
    if (low is not None and value < low) or (high is not None and value > high):
        shown = " … ".join("∞" if bound is None else f"{unit.from_si(bound):g}" for bound in (low, high))
        what = f"{port} = {unit.from_si(value):g} is outside its range {shown} {unit}".rstrip()
        raise fail(what, where, f"the range is set by component {component.name}")
