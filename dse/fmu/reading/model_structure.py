"""Which output depends on what, and the states and derivatives of a model (ModelStructure from FMI 2.0 on)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from dse.domain.component import Kind
from dse.domain.fmu import Exchange
from dse.errors import Problem
from dse.fmu.reading.variables import Listed
from dse.formats import XmlElement, whole_of

_MOST_INDICATORS = 10_000_000

_AT_ANY_TIME = ("input",)
# Before the end of initialization parameters may still be set, so that an output depends on them, too.
_INITIALLY = ("input", "parameter", "structuralParameter")

Dependencies = Mapping[str, tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class ModelDependencies:
    """What a description says of how its variables depend on each other; both mappings are those of FmuModel."""

    depends: Dependencies
    initially_depends: Dependencies


@dataclass(frozen=True, slots=True)
class Catalog:
    """Finds variables as ModelStructure names them: by position from 1 (FMI 2.0) or value reference (FMI 3.0).

    With FMI 3.0 a variable and its aliases are found together, the variable first.
    """

    version: int
    found: Mapping[int, tuple[Listed, ...]]

    @property
    def key(self) -> str:
        """The attribute that names a variable."""
        return "index" if self.version == 2 else "valueReference"

    def at(self, number: int) -> tuple[Listed, ...]:
        """The variables with this position or reference; none if there are none."""
        return self.found.get(number, ())


def catalog(listed: Sequence[Listed | None], version: int) -> Catalog:
    """The variables of a description of FMI 2.0 or 3.0, all of them without problems."""
    found: dict[int, tuple[Listed, ...]] = {}
    for position, one in enumerate(listed, start=1):
        if one is not None:
            key = position if version == 2 else one.variable.reference
            found[key] = (*found.get(key, ()), one)
    return Catalog(version, found)


def read_structure(root: XmlElement, variables: Catalog) -> ModelDependencies:
    """The dependencies of outputs.

    An output of which nothing is said, or what cannot be, is left out: it may depend on everything.
    """
    exact = (one for group in variables.found.values() for one in group if _keeps_its_start(one))
    return ModelDependencies(
        depends=_dependencies(root, "Outputs", "Output", _AT_ANY_TIME, variables),
        initially_depends={
            **_dependencies(root, "InitialUnknowns", "InitialUnknown", _INITIALLY, variables),
            **{one.variable.name: () for one in exact},
        },
    )


def direct_dependencies(listed: Sequence[Listed | None]) -> ModelDependencies:
    """The inputs each output of FMI 1.0 says it depends on directly; nothing is known of initialization.

    An output that names what is no variable is left out: it may depend on everything.
    """
    causalities = {one.variable.name: one.variable.causality for one in listed if one is not None}
    depends: dict[str, tuple[str, ...]] = {}
    for one in listed:
        told = one.element.child("DirectDependency") if one is not None else None
        if one is None or told is None or one.variable.causality != "output":
            continue
        sources = dict.fromkeys(name.text.strip() for name in told.all("Name"))
        if causalities.keys() >= sources.keys():
            depends[one.variable.name] = tuple(name for name in sources if causalities[name] == "input")
    return ModelDependencies(depends, {})


def read_exchange(
    root: XmlElement, variables: Catalog, *, needs_completed_step: bool, problems: list[Problem]
) -> Exchange:
    """States, derivatives and event indicators."""
    pairs = list(_states(root, variables, problems))
    # FMI 2.0 only says how many there are.
    indicators = list(_indicators(root, variables, problems)) if variables.version == 3 else []
    told = root.whole("numberOfEventIndicators", problems, least=0, most=_MOST_INDICATORS)
    return Exchange(
        states=tuple(state.variable.reference for state, _ in pairs),
        derivatives=tuple(derivative.variable.reference for _, derivative in pairs),
        n_states=sum(state.variable.size for state, _ in pairs),
        n_event_indicators=sum(one.variable.size for one in indicators) if variables.version == 3 else told or 0,
        needs_completed_step=needs_completed_step,
        event_indicators=tuple(one.variable.reference for one in indicators),
    )


def _keeps_its_start(one: Listed) -> bool:
    return one.variable.causality == "output" and (one.initial == "exact" or one.variable.variability == "constant")


def _unknowns(root: XmlElement, group: str, tag: str, version: int) -> Iterator[XmlElement]:
    """The elements of one list: FMI 2.0 has a *group* of ``Unknown``, FMI 3.0 elements of a *tag* of their own."""
    if version == 2:
        yield from root.below("ModelStructure", group, "Unknown")
    else:
        yield from root.below("ModelStructure", tag)


def _dependencies(
    root: XmlElement,
    group: str,
    tag: str,
    causalities: tuple[str, ...],
    variables: Catalog,
) -> Dependencies:
    told: dict[str, tuple[str, ...] | None] = {}
    for element in _unknowns(root, group, tag, variables.version):
        number = whole_of(element.get(variables.key))
        known = _known(element, variables)
        names = None
        if known is not None:
            names = tuple(dict.fromkeys(one.variable.name for one in known if one.variable.causality in causalities))
        for one in variables.at(number) if number is not None else ():
            name = one.variable.name
            # Some tools list an output several times; if that says different things, none of it is reliable.
            if one.variable.causality == "output":
                told[name] = names if told.get(name, names) == names else None
    return {name: names for name, names in told.items() if names is not None}


def _named(element: XmlElement, variables: Catalog, problems: list[Problem]) -> tuple[Listed, ...]:
    """The variable (and its aliases) an element stands for; a problem if there is none."""
    key = variables.key
    if key not in element.attributes:
        problems.append(Problem(f"<{element.tag}> has no '{key}'", element.where))
    number = element.whole(key, problems, least=0)
    found = variables.at(number) if number is not None else ()
    if number is not None and not found:
        problems.append(Problem(f"<{element.tag}>: there is no variable with the {key} {number}", element.where))
    return found


def _known(element: XmlElement, variables: Catalog) -> list[Listed] | None:
    """The variables an unknown depends on; None if nothing reliable is said, which means all."""
    text = element.attributes.get("dependencies")
    if text is None:
        return None
    numbers, kinds = text.split(), element.get("dependenciesKind").split()
    # Some tools write lists that do not fit together. Which kind of dependency it is does not matter here, but then
    # the other list may be the wrong one.
    if kinds and len(kinds) != len(numbers):
        return None
    known: list[Listed] = []
    for word in numbers:
        number = whole_of(word)
        found = variables.at(number) if number is not None else ()
        if not found:
            return None
        known += found
    return known


def _states(root: XmlElement, variables: Catalog, problems: list[Problem]) -> Iterator[tuple[Listed, Listed]]:
    """Each state with its derivative, in order."""
    for element in _unknowns(root, "Derivatives", "ContinuousStateDerivative", variables.version):
        found = _named(element, variables, problems)
        if not found:
            continue
        derivative = found[0]
        name = derivative.variable.name
        states = variables.at(derivative.derivative) if derivative.derivative is not None else ()
        if not states:
            what = f"'{name}' is listed as a derivative, but its 'derivative' names no state"
            problems.append(Problem(what, derivative.element.where))
            continue
        state = states[0]
        if state.variable.kind is not Kind.REAL or derivative.variable.kind is not Kind.REAL:
            what = f"'{name}' and its state '{state.variable.name}' are no real numbers"
            problems.append(Problem(what, derivative.element.where))
        elif state.variable.shape != derivative.variable.shape:
            what = f"'{name}' and its state '{state.variable.name}' are arrays of different sizes"
            problems.append(Problem(what, derivative.element.where))
        else:
            yield state, derivative


def _indicators(root: XmlElement, variables: Catalog, problems: list[Problem]) -> Iterator[Listed]:
    for element in _unknowns(root, "", "EventIndicator", variables.version):
        yield from _named(element, variables, problems)[:1]
