"""What the names in an expression stand for: places, what can stand there, properties and ranges of parameters."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

from dse.domain.component import Component, Kind, Parameter
from dse.domain.design import DesignSpace, split_path
from dse.domain.expression import Call, Chosen, Expression, Name, Node, Span
from dse.errors import closest
from dse.expression import PLAIN, Form, Sort, error_in
from dse.loading import Instances
from dse.space.decisions import Site, sites
from dse.space.language.terms import Entries
from dse.units import Dimension, Unit, describe

RANGE = ("min", "max", "start")
"""What can be asked of a parameter: ``controller.kp_speed.max``."""


class Places:
    """The places of a design space by path. All methods raise DseError at the name that means nothing."""

    def __init__(self, space: DesignSpace) -> None:
        self.instances = Instances(space.root)
        found: dict[str, list[Site]] = {}
        for site in sites(space):
            found.setdefault(site.path, []).append(site)
        self._sites = {path: tuple(there) for path, there in found.items()}
        self._names = {path: frozenset(site.name for site in there) for path, there in found.items()}
        components = (site.component for there in found.values() for site in there)
        self.properties = frozenset(name for component in components if component for name in component.properties)

    def at(self, expression: Expression, path: str, span: Span) -> tuple[Site, ...]:
        """Everything that can stand at *path*."""
        if path not in self._sites:
            known = max((len(place) + 1 for place in self._sites if path.startswith(f"{place}.")), default=0)
            here = (span[0] + known, span[1])
            raise error_in(expression, here, f"unknown place '{path}'", closest(path, self._sites))
        return self._sites[path]

    def names_at(self, path: str) -> frozenset[str]:
        """The names of what can stand at the place *path*."""
        return self._names[path]

    def check_options(self, expression: Expression, node: Chosen) -> None:
        """Raise DseError if one of the options can never stand at the place."""
        known = self._names[node.place]
        for number, option in enumerate(node.options):
            if option not in known and option not in ("absent", "present"):
                what = f"'{option}' cannot be chosen for '{node.place}'"
                raise error_in(expression, node.option_span(number), what, closest(option, known))

    def value_at(self, expression: Expression, node: Name) -> tuple[Sort, Entries]:
        """The values of ``place.property`` or ``place.parameter.max``; every choice must state them."""
        place, _, name = node.path.rpartition(".")
        if node.path in self._sites:
            advice = f"write {node.path} is …, or one of its properties"
            raise error_in(expression, node.span, f"'{node.path}' is a place, not a value", advice)
        if not place:
            raise error_in(expression, node.span, f"unknown name '{name}'", closest(name, self._known()))
        split = None if place in self._sites or name not in RANGE else split_path(place, self._sites)
        if split:
            return self._range_of(expression, node, split[0], split[1], name)
        components = self._components_at(expression, node, place, name, f"write sum({name}, {place})")
        stated = {known for _, component in components for known in component.properties}
        if name not in stated:
            what = f"nothing at '{place}' states '{name}'"
            raise error_in(expression, _last(node.span, name), what, closest(name, stated))
        for site, component in components:
            if name not in component.properties:
                what = f"'{site.name}', which can be at '{place}', does not state '{name}'"
                raise error_in(expression, node.span, what, f"add it to the properties{_file_of(component)}")
        return self._with_sort(expression, node, components, name)

    def values_below(self, expression: Expression, node: Call) -> tuple[Sort, Entries]:
        """The values a roll-up ``function(property, place)`` runs over, and the sort of its result."""
        name, place = self._rollup_arguments(expression, node)
        if name not in self.properties:
            raise error_in(
                expression, node.arguments[0].span, f"no component states '{name}'", closest(name, self.properties)
            )
        components = [
            (site, site.component)
            for path, found in self._sites.items()
            if not place or path == place or path.startswith(f"{place}.")
            for site in found
            if site.component and name in site.component.properties
        ]
        if not components:
            raise error_in(expression, node.span, f"nothing at '{place}' states '{name}'", "leave out the place")
        sort, entries = self._with_sort(expression, node, components, name)
        if node.function == "count":
            return PLAIN, entries
        if node.function == "product" and sort.dimension:
            advice = "its unit would depend on the number of parts"
            raise error_in(expression, node.span, f"cannot multiply up '{name}', which is {sort}", advice)
        return sort, entries

    def _components_at(
        self, expression: Expression, node: Name, place: str, name: str, advice: str
    ) -> list[tuple[Site, Component]]:
        found = self.at(expression, place, node.span)
        components = [(site, site.component) for site in found if site.component]
        if len(components) < len(found):
            what = f"'{place}' can be several parts, so it has no '{name}' of its own"
            raise error_in(expression, node.span, what, advice)
        return components

    def _range_of(self, expression: Expression, node: Name, place: str, name: str, end: str) -> tuple[Sort, Entries]:
        components = self._components_at(expression, node, place, name, "ask for the parameter of one of its parts")
        known = {parameter.name for _, component in components for parameter in component.parameters}
        if name not in known:
            what = f"nothing at '{place}' has a parameter '{name}'"
            raise error_in(expression, _last(node.span, f"{name}.{end}"), what, closest(name, known))
        units: dict[Dimension, Component] = {}
        entries = []
        for site, component in components:
            parameter = component.parameter(name)
            value = _end_of(parameter, end) if parameter else None
            if parameter is None or value is None:
                lacks = f"number '{name}.{end}'" if parameter else f"parameter '{name}'"
                what = f"'{site.name}', which can be at '{place}', has no {lacks}"
                raise error_in(expression, node.span, what, f"add it to the parameters{_file_of(component)}")
            units.setdefault(parameter.type.unit.dimension, component)
            entries.append((site, value))
        return _common_sort(expression, node, f"{name}.{end}", units), tuple(entries)

    def _rollup_arguments(self, expression: Expression, node: Call) -> tuple[str, str]:
        form = f"{node.function}(property) or {node.function}(property, place)"
        if not 1 <= len(node.arguments) <= 2:
            raise error_in(expression, node.span, f"'{node.function}' needs a property", f"the form is {form}")
        names = [_plain_name(expression, argument, form) for argument in node.arguments]
        if "." in names[0]:
            raise error_in(expression, node.arguments[0].span, "a roll-up takes a bare property", f"the form is {form}")
        if len(names) == 1:
            return names[0], ""
        self.at(expression, names[1], node.arguments[1].span)
        return names[0], names[1]

    def _with_sort(
        self, expression: Expression, node: Node, components: Sequence[tuple[Site, Component]], name: str
    ) -> tuple[Sort, Entries]:
        dimensions: dict[Dimension, Component] = {}
        for _, component in components:
            dimensions.setdefault(component.properties[name].unit.dimension, component)
        sort = _common_sort(expression, node, name, dimensions)
        return sort, tuple((site, component.properties[name].si) for site, component in components)

    def _known(self) -> Iterable[str]:
        return (*self._sites, *self.properties)


def _last(span: Span, name: str) -> Span:
    """Where *name* stands, which is the end of a path."""
    return span[1] - len(name), span[1]


def _common_sort(expression: Expression, node: Node, name: str, dimensions: Mapping[Dimension, Component]) -> Sort:
    if len(dimensions) > 1:
        shown = " and ".join(f"{describe(d)} in '{c.name}'" for d, c in list(dimensions.items())[:2])
        raise error_in(expression, node.span, f"'{name}' is {shown}", "give both the same kind of unit")
    (dimension,) = dimensions
    return Sort(Form.NUMBER, dimension)


def _end_of(parameter: Parameter, end: str) -> Fraction | None:
    value = {"min": parameter.minimum, "max": parameter.maximum, "start": parameter.start}[end]
    if value is None or parameter.type.kind not in (Kind.REAL, Kind.INTEGER) or isinstance(value, str):
        return None
    return _as_written(value, parameter.type.unit) if math.isfinite(value) else None


def _as_written(value: float, unit: Unit) -> Fraction:
    """The SI number that a person wrote in *unit*: 70 km/h is 175/9 m/s, not the float beside it."""
    written = Fraction(str(unit.from_si(value)))
    return written * unit.factor + unit.offset if unit.to_si(float(written)) == value else Fraction(value)


def _file_of(component: Component) -> str:
    return f" in {component.where.file}" if component.where else ""


def _plain_name(expression: Expression, node: Node, form: str) -> str:
    if not isinstance(node, Name):
        raise error_in(expression, node.span, "a roll-up takes names, not values", f"the form is {form}")
    return node.path
