"""Modelica texts to flat models, and their values by plain substitution: an oracle that knows nothing of sorting."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping

import rumoca

from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import FlatModel, Role
from dse.modelica.flatten.flattening import flatten
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.source_text import SourceText


def compiled(text: str, structural: frozenset[str] = frozenset()) -> FrontEndResult:
    """What the front-end gives for model ``M`` of *text*; the file is called ``m.mo`` and begins with the text."""
    whole = f"{text}\n"
    package = f"package T\n{whole}end T;"
    model = rumoca.Session().loads(package, model="T.M")
    dae = copy.deepcopy(model.to_dict("dae"))
    sources = {number: SourceText("m.mo", content) for number, _, content in dae["source_map"]["files"]}
    return FrontEndResult("T.M", dae, model.to_dict("flat"), sources, structural)


def flattened(text: str) -> FlatModel:
    """The flat model of model ``M`` in *text*. Line 2 of ``m.mo`` is the first of *text*."""
    return flatten(compiled(text))


def values(flat: FlatModel, given: Mapping[str, float] | None = None, time: float = 0.0) -> dict[str, float]:
    """Every variable's value where inputs and states are *given*, relations are true as they are, nothing is initial.

    Equations are solved one after the other for a single unknown in which they are affine; a derivative is called
    ``der(x)``. Discrete variables that no assignment without trigger gives have the value given, else 0.
    """
    known: dict[Symbol, float] = {Symbol(referent=Referent.TIME): time, Symbol(referent=Referent.INITIAL): 0.0}
    known[Symbol(referent=Referent.CONTINUED)] = 1.0
    for name, value in (given or {}).items():
        known[Symbol(name)] = value
        known[Symbol(name, referent=Referent.PRE)] = value
    left = [equation.residual for equation in flat.equations]
    always = {item.target: item.value for item in flat.assignments if item.trigger is None}
    for variable in flat.variables.values():
        symbol = Symbol(variable.name)
        if symbol in known:
            continue
        if variable.role is Role.PARAMETER:
            left += [flat.graph.variable(variable.name) - (variable.binding or variable.start or 0.0)]
        elif variable.role is Role.DISCRETE and variable.name not in always:
            known[symbol] = known[Symbol(variable.name, referent=Referent.PRE)] = 0.0
    pending = {**always}
    held = {Symbol(str(place), referent=Referent.HELD): relation.truth for place, relation in enumerate(flat.relations)}
    while True:
        before = len(known)
        for symbol, truth in held.items():
            if symbol not in known and symbols(truth).keys() <= known.keys():
                known[symbol] = evaluate([truth], known)[0]
        for name, assigned in list(pending.items()):
            if symbols(assigned).keys() <= known.keys():
                known[Symbol(name)] = evaluate([assigned], known)[0]
                del pending[name]
        for residual in list(left):
            unknown = symbols(residual).keys() - known.keys()
            if len(unknown) == 1:
                (symbol,) = unknown
                known[symbol] = _root(residual, symbol, known)
                left.remove(residual)
        if len(known) == before:
            break
    return {str(symbol): value for symbol, value in known.items() if symbol.is_variable}


def _root(residual: Expression, symbol: Symbol, known: Mapping[Symbol, float]) -> float:
    at_zero, at_one = (evaluate([residual], {**known, symbol: value})[0] for value in (0.0, 1.0))
    slope = at_one - at_zero
    if math.isfinite(at_zero) and slope in (1.0, -1.0):
        return -at_zero / slope
    return -at_zero / slope if slope else math.nan
