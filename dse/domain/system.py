"""A configuration on a test bench, ready to be simulated: FMUs and the wires between them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from dse.domain.fmu import FmuModel, Variable


@dataclass(frozen=True, slots=True)
class Conversion:
    """From a value inside an FMU to the same value outside of it: ``outside = factor * inside + offset``.

    With *items*, pairs (inside, outside), the values are those of an enumeration: one that is not among them is an
    error, and factor and offset are not used.
    """

    factor: float = 1.0
    offset: float = 0.0
    items: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Element:
    """One FMU instance in a system.

    *inputs* are the connected inputs and tunable parameters, *outputs* those that are wired or recorded. *start*
    sets unconnected inputs and parameters before initialization, by the label of one value (``name`` or
    ``name[2]``): numbers as they are outside of the FMU (SI), 0/1 for Booleans, the number of an enumeration's
    item. *texts* does so for strings and binaries. *conversions* are by variable name; a variable without one has
    the same value inside and outside. Structural parameters in *start* have gone into the shapes of *model*'s
    variables already (``dse.system.assembly.resized``).
    """

    name: str
    model: FmuModel
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    start: Mapping[str, float]
    texts: Mapping[str, str | bytes] = field(default_factory=dict)
    conversions: Mapping[str, Conversion] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Wire:
    """From output *source_variable* of element *source* to input *target_variable* of element *target*.

    The target may be a tunable parameter instead, which is given its value as an input is.

    Both ends are labels of one value (``name``, ``name[2]``), or both are whole arrays of equal shape, by name. The
    target is given ``factor * source + offset``, both in outside values; with *items*, pairs (source, target).
    Strings and binaries go over wires of their own kind, without any change.
    """

    source: str
    source_variable: str
    target: str
    target_variable: str
    factor: float = 1.0
    offset: float = 0.0
    items: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class SystemStructure:
    """Elements in stepping order and the wires between them; names are unique, every wire is type-checked."""

    name: str
    elements: tuple[Element, ...]
    wires: tuple[Wire, ...]

    def with_tolerance(self, tolerance: float | None) -> SystemStructure:
        """The system with all FMUs told this *tolerance* in place of their own; None leaves them theirs."""
        if tolerance is None:
            return self
        models = (replace(e.model, experiment=replace(e.model.experiment, tolerance=tolerance)) for e in self.elements)
        elements = (replace(element, model=model) for element, model in zip(self.elements, models, strict=True))
        return replace(self, elements=tuple(elements))

    def element(self, name: str) -> Element:
        """The element called *name*; KeyError if there is none."""
        for element in self.elements:
            if element.name == name:
                return element
        raise KeyError(name)
