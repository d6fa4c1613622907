"""What the names in an expression stand for: places, what can stand there, and properties."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from dse.domain.component import Component
from dse.domain.design import DesignSpace
from dse.domain.expression import Call, Chosen, Expression, Name, Node, Span
from dse.errors import closest
from dse.loading.expression_sorts import PLAIN, Form, Sort, error_in
from dse.space.decisions import Condition, Site, sites
from dse.units import Dimension, describe

Entries = list[tuple[Condition, Fraction]]


class Places:
    """The places of a design space by path. All methods raise DseError at the name that means nothing."""

    def __init__(self, space: DesignSpace) -> None:
        self._sites: dict[str, list[Site]] = {}
        for site in sites(space):
            self._sites.setdefault(site.path, []).append(site)
        components = (site.component for found in self._sites.values() for site in found)
        self.properties = frozenset(name for component in components if component for name in component.properties)

    def at(self, expression: Expression, path: str, span: Span) -> list[Site]:
        """Everything that can stand at *path*."""
        if path not in self._sites:
            raise error_in(expression, span, f"unknown place '{path}'", closest(path, self._sites))
        return self._sites[path]

    def check_options(self, expression: Expression, node: Chosen) -> None:
        """Raise DseError if one of the options can never stand at the place."""
        known = [site.name for site in self._sites[node.place]]
        for option in node.options:
            if option not in (*known, "absent", "present"):
                what = f"'{option}' cannot be chosen for '{node.place}'"
                raise error_in(expression, node.span, what, closest(option, known))

    def property_at(self, expression: Expression, node: Name) -> tuple[Sort, Entries]:
        """The values of ``place.property``, each under its condition; every choice must state the property."""
        place, _, name = node.path.rpartition(".")
        if node.path in self._sites:
            advice = f"write {node.path} is …, or one of its properties"
            raise error_in(expression, node.span, f"'{node.path}' is a place, not a value", advice)
        if not place:
            raise error_in(expression, node.span, f"unknown name '{name}'", closest(name, self._names()))
        found = self.at(expression, place, node.span)
        components = [(site, site.component) for site in found if site.component]
        if len(components) < len(found):
            what = f"'{place}' can be several parts, so it has no '{name}' of its own"
            raise error_in(expression, node.span, what, f"write sum({name}, {place})")
        stated = {known for _, component in components for known in component.properties}
        if name not in stated:
            raise error_in(expression, node.span, f"nothing at '{place}' states '{name}'", closest(name, stated))
        for site, component in components:
            if name not in component.properties:
                what = f"'{site.name}', which can stand at '{place}', does not state '{name}'"
                at = f" in {component.where.file}" if component.where else ""
                raise error_in(expression, node.span, what, f"add it to the properties{at}")
        return self._with_sort(expression, node, components, name)

    def properties_below(self, expression: Expression, node: Call) -> tuple[Sort, Entries]:
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
        self, expression: Expression, node: Node, components: list[tuple[Site, Component]], name: str
    ) -> tuple[Sort, Entries]:
        dimensions: dict[Dimension, Component] = {}
        for _, component in components:
            dimensions.setdefault(component.properties[name].unit.dimension, component)
        if len(dimensions) > 1:
            shown = " and ".join(f"{describe(d)} in '{c.name}'" for d, c in list(dimensions.items())[:2])
            raise error_in(expression, node.span, f"'{name}' is {shown}", "give both the same kind of unit")
        (dimension,) = dimensions
        entries = [(site.condition, component.properties[name].si) for site, component in components]
        return Sort(Form.NUMBER, dimension), entries

    def _names(self) -> Iterable[str]:
        return (*self._sites, *self.properties)


def _plain_name(expression: Expression, node: Node, form: str) -> str:
    if not isinstance(node, Name):
        raise error_in(expression, node.span, "a roll-up takes names, not values", f"the form is {form}")
    return node.path
