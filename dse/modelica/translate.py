"""From a component's Modelica model to the sorted equations, with the component's own values for its parameters."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from dse.domain.component import Component, Kind, Parameter
from dse.errors import DseError, fail
from dse.modelica.emit.variables import FmuVariable, Variability, variables
from dse.modelica.flatten.flattening import flatten
from dse.modelica.frontend.compile import read_answer
from dse.modelica.frontend.literal import Value, literal
from dse.modelica.frontend.process import VERSION
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.sources import Keep, ModelSources
from dse.modelica.frontend.structural.probe import compile_probed
from dse.modelica.interface import starts
from dse.modelica.solved_model import Solved
from dse.modelica.structure.solve import solve


@dataclass(frozen=True, slots=True)
class Translated:
    """A model ready to become C, with the component's values for its parameters; *files* are names, *names* by path."""

    solved: Solved
    variables: tuple[FmuVariable, ...]
    description: str
    files: tuple[str, ...]
    names: Mapping[str, str]


class TranslationError(DseError):
    """The model is not wrong, as far as is known, but cannot be translated."""


def translate(component: Component, sources: ModelSources, keep: Keep) -> Translated:
    """The model of *sources* with the values of *component*; *keep* keeps what the front-end answers.

    Raises TranslationError for what cannot be translated, and DseError for ports and parameters that do not fit.
    """
    try:
        result = _instantiated(component, sources, keep)
        flat = flatten(result)
    except DseError as error:
        raise TranslationError(*error.problems) from error
    given = starts(component, flat)
    try:
        solved = solve(flat)
        listed = tuple(_as_asked(component, variable) for variable in variables(solved, given))
    except DseError as error:
        raise TranslationError(*error.problems) from error
    names = {path: name for name, path in sources.origins.items()}
    solved = replace(solved, notes=tuple(_renamed(note, names) for note in solved.notes))
    return Translated(solved, listed, result.description, tuple(sorted(sources.contents)), names)


_MOST_ROUNDS = 10


def _instantiated(component: Component, sources: ModelSources, keep: Keep) -> FrontEndResult:
    """The flat system with the component's values for the structural parameters, of which each may bring others."""
    values: dict[str, Value] = {}
    for _ in range(_MOST_ROUNDS):
        result = answer(sources, values, keep)
        wanted = {
            component.variable(parameter.name): value
            for parameter in component.parameters
            if component.variable(parameter.name) in result.structural
            and (value := _literal(parameter, result, component.variable(parameter.name))) is not None
        }
        if wanted == values:
            return result
        values = wanted
    what = f"component '{component.name}': its parameters change which parameters {sources.model} has"
    raise fail(what, component.where, "give fewer of them that are structural")


def answer(sources: ModelSources, structural: Mapping[str, Value], keep: Keep) -> FrontEndResult:
    """As `compile_probed`, by what was answered before to the same. Only what is right is kept. Raises DseError."""

    def made() -> bytes:
        result = compile_probed(sources, structural)
        whole = {"dae": result.dae, "flat": result.flat, "structural": sorted(result.structural)}
        return json.dumps(whole, separators=(",", ":")).encode()

    given = [(name, literal(value)) for name, value in sorted(structural.items())]
    asked = [("asked", json.dumps([VERSION, sources.model, given]).encode())]
    asked += [(f"file/{name}", content) for name, content in sorted(sources.contents.items())]
    asked += [(f"library/{name}", content) for name, content in sorted(sources.parts.items())]
    whole = json.loads(keep(asked, made))
    return read_answer(sources, whole, frozenset(whole["structural"]))


def _literal(parameter: Parameter, result: FrontEndResult, name: str) -> Value | None:
    """The parameter's start for the front-end; None if it does not fit, which is told when all are compared."""
    storage, kind = result.dae["storage"], parameter.type.kind
    types = (each["value_type"] for each in storage["variables"] if each["name"] == name)
    if kind.name.lower() not in [storage["value_types"][number]["scalar"] for number in types]:
        return None
    if kind is Kind.ENUMERATION:
        return f"{result.flat['variable_type_names'][name]}.{parameter.start}"
    return _PLAIN[kind](parameter.start)


_PLAIN: Mapping[Kind, Callable[[Any], Value]] = {Kind.REAL: float, Kind.INTEGER: int, Kind.BOOLEAN: bool}


def _as_asked(component: Component, variable: FmuVariable) -> FmuVariable:
    """*variable* as the component declares it where it does: narrower bounds, and whether it is tunable."""
    found = next((p for p in component.parameters if component.variable(p.name) == variable.name), None)
    if found is None or variable.variability is Variability.CONSTANT:
        return variable
    return replace(
        variable,
        variability=Variability.TUNABLE if found.tunable else Variability.FIXED,
        minimum=variable.minimum if found.minimum is None else found.minimum,
        maximum=variable.maximum if found.maximum is None else found.maximum,
        description=found.title or variable.description,
    )


def _renamed(text: str, names: Mapping[str, str]) -> str:
    """*text* with the place it begins with renamed."""
    path, colon, rest = text.partition(":")
    return f"{names[path]}{colon}{rest}" if path in names else text
