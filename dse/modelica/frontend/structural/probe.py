"""Which parameters are structural: those whose values the front-end itself uses.

No list of uses would be complete, so it is tried: the model is compiled again with other values, and if anything but
the values changes (an array's size, a clock's period, which branch is taken), the parameter is structural. So is what
stands where a model gets its shape, as a trial may not cross a threshold (`shaping`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from dse.errors import Problem, raise_if_any
from dse.modelica.frontend.compile import Session, in_other_words, opened
from dse.modelica.frontend.literal import Value, literal
from dse.modelica.frontend.process import FrontEndDied, FrontEndRefusal
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.sources import ModelSources
from dse.modelica.frontend.structural.alterations import Alteration, alterations, number, refers_to
from dse.modelica.frontend.structural.shape import shaping


def compile_probed(sources: ModelSources, structural: Mapping[str, Value] | None = None) -> FrontEndResult:
    """As `compile_model`, and the result's *structural* is known. Raises DseError."""
    return in_other_words(sources, lambda others: _compiled(others, structural or {}))


def _compiled(sources: ModelSources, structural: Mapping[str, Value]) -> FrontEndResult:
    changes = {name: literal(value) for name, value in structural.items()}
    with opened(sources) as session:
        result = session.compiled(changes)
        raise_if_any(_ineffective(result, sources, structural))
        return replace(result, structural=_Probe(session, result, changes).structural())


def _ineffective(result: FrontEndResult, sources: ModelSources, structural: Mapping[str, Value]) -> Iterator[Problem]:
    """Changes that the front-end took without making them, as it does of names it does not know."""
    for name, value in structural.items():
        variable = result.flat["variables"].get(name)
        binding = variable["binding"] if variable is not None else None
        if isinstance(value, bool):
            is_made = isinstance(binding, dict) and binding.get("Literal", {}).get("value") == {"Boolean": value}
        elif isinstance(value, str):
            last = binding["VarRef"]["name"]["name"] if isinstance(binding, dict) and "VarRef" in binding else ""
            is_made = str(last).rpartition(".")[2] == value.rpartition(".")[2]
        else:
            is_made = number(binding) == value
        if not is_made:
            what = f"component '{sources.component}': '{name}' of {sources.model} cannot be given the value {value}"
            yield Problem(what, sources.where, "set it in a Modelica model that extends this one")


class _Probe:
    def __init__(self, session: Session, result: FrontEndResult, changes: Mapping[str, str]) -> None:
        self._session, self._result, self._changes = session, result, changes
        relative = {session.sources.origins[name]: name for name in session.sources.contents}
        self._files = {
            number: relative[source.path] for number, source in result.sources.items() if source.path in relative
        }
        self._base: Mapping[str, Any] = result.dae

    def structural(self) -> frozenset[str]:
        """The names of the structural parameters."""
        found, without = alterations(self._result, frozenset(self._files))
        used = self._declared_used() | without
        trial = [alteration for alteration in found if not alteration.names <= used]
        modified = [alteration for alteration in trial if not alteration.patches]
        if modified:
            # What is compared must differ in the values only, so both sides have to name them.
            base = self._compiled(
                (), {name: alteration.texts[0] for alteration in modified for name in alteration.names}
            )
            if base is None:
                used |= {name for alteration in modified for name in alteration.names}
                trial = [alteration for alteration in trial if alteration.patches]
            else:
                self._base = base
        # Halves of what shows a difference are tried until single alterations remain.
        stack = [trial] if trial else []
        while stack:
            tried = stack.pop()
            unsure = self._unsure(tried, modified if self._base is not self._result.dae else [])
            if unsure is None and len(tried) > 1:
                stack += [tried[: len(tried) // 2], tried[len(tried) // 2 :]]
            else:
                used |= unsure if unsure is not None else {name for alteration in tried for name in alteration.names}
        return frozenset(used)

    def _unsure(self, tried: Iterable[Alteration], modified: Iterable[Alteration]) -> frozenset[str] | None:
        """Parameters that did not take their other value, or gave it to others; None if more than values changed."""
        wanted = set(tried)
        names = frozenset(name for alteration in wanted for name in alteration.names)
        texts = {name: alteration.texts[alteration in wanted] for alteration in modified for name in alteration.names}
        dae = self._compiled(wanted, texts)
        found = changed_parameters(self._base, dae, names) if dae is not None else None
        if found is None:
            return None
        changed, others = found
        guilty: set[str] = set()
        for value in others:
            of = [alteration for alteration in wanted if alteration.gives(value)]
            if len(of) != 1:
                return None
            guilty |= of[0].names
        return (names - changed) | guilty

    def _compiled(self, tried: Iterable[Alteration], texts: Mapping[str, str]) -> Mapping[str, Any] | None:
        patches = {patch for alteration in tried for patch in alteration.patches}
        overlay: dict[str, bytes] = {}
        for patch in sorted(patches, key=lambda patch: (patch.source, -patch.start)):
            name = self._files[patch.source]
            content = overlay.get(name, self._session.sources.contents[name])
            overlay[name] = content[: patch.start] + patch.text.encode() + content[patch.end :]
        try:
            return self._session.trial(overlay, {**self._changes, **texts})["dae"]  # type: ignore[no-any-return]  # JSON
        except (FrontEndDied, FrontEndRefusal, ValueError, TypeError):
            return None

    def _declared_used(self) -> set[str]:
        """What the front-end itself says it used, and what that was made of."""
        variables = {variable["name"]: variable for variable in self._result.dae["storage"]["variables"]}
        finals = self._result.flat["variable_final_flags"]
        used = {
            name
            for name, variable in variables.items()
            if variable["role"] == "parameter"
            and not finals.get(name)
            and (variable["attributes"]["evaluable"] or not variable["attributes"]["is_tunable"])
        }
        for selection in self._result.flat.get("parameter_branch_selections") or ():
            used |= {reference[0] for reference in selection["references"] if reference[0] in variables}
        used |= {name for name in shaping(self._result) if not finals.get(name)}
        pending = list(used)
        while pending:
            made_of = {name for name in refers_to(self._result, pending.pop()) if name in variables}
            pending += made_of - used
            used |= made_of
        return used


# Whether two flat systems differ in nothing but the values of some parameters.


# Where something stands, and what is derived from the rest with the parameters' present values.
_IGNORED = frozenset({"provenance", "span", "declaration", "component_ref", "value_type_provenance"})
_DERIVED = frozenset({"roots", "structured_roots", "time_events", "conditions", "relations"})
_QUOTIENT_OPERANDS = 7


def changed_parameters(
    one: Mapping[str, Any], other: Mapping[str, Any], names: Iterable[str]
) -> tuple[frozenset[str], frozenset[float]] | None:
    """Those of the parameters *names* whose own values differ, and the numbers that differ elsewhere; None if anything
    else differs.

    *one* and *other* are flat systems as the front-end writes them.
    """
    first, second = one["storage"], other["storage"]
    conditions = _conditions(first), _conditions(second)
    for key in first.keys() | second.keys():
        if key in _DERIVED or key in _IGNORED or key == "expressions":
            continue
        if _bare(first.get(key), conditions[0]) != _bare(second.get(key), conditions[1]):
            return None
    for key in ("operands", "subscripts"):
        if _bare(first["expressions"][key]) != _bare(second["expressions"][key]):
            return None
    nodes, others = first["expressions"]["nodes"], second["expressions"]["nodes"]
    if len(nodes) != len(others):
        return None
    differing = {
        number
        for number, (a, b) in enumerate(zip(nodes, others, strict=True))
        if a != b and _bare(a, conditions[0]) != _bare(b, conditions[1])
    }
    if not all(_is_literal(nodes[number]) and _is_literal(others[number]) for number in differing):
        return None
    return _owners(first, differing, frozenset(names), others)


def _conditions(storage: Mapping[str, Any]) -> list[Any]:
    """What each condition is made of, whatever its number: the front-end lists relations that nothing refers to."""
    found: list[Any] = []
    relations = storage.get("relations") or ()
    for record in storage.get("conditions") or ():
        node = record["node"]
        kind: str = next(iter(node)) if isinstance(node, dict) else node
        data: Any = node[kind] if isinstance(node, dict) else None
        places: list[int] = []
        if isinstance(data, dict):
            places = [data[side] for side in ("lhs", "rhs") if side in data]
        elif kind == "not":
            places = [data]
        if any(place >= len(found) for place in places):  # made of a later one: told apart by its number
            found.append([len(found), node])
        elif places:
            found.append([kind, *(found[place] for place in places)])
        else:
            found.append([kind, _bare(relations[data]) if kind == "relation" else _bare(data)])
    return found


def _owners(
    storage: Mapping[str, Any], differing: set[int], names: frozenset[str], others: Sequence[Any]
) -> tuple[frozenset[str], frozenset[float]] | None:
    """The parameters to whose values the nodes *differing* belong, and the numbers among *others* of the rest; None if
    one of those is no number."""
    below = _operands(storage["expressions"])
    if below is None:
        return None
    owner: dict[int, str] = {}
    for variable in storage["variables"]:
        if variable["role"] not in ("parameter", "constant"):
            continue
        attributes = variable["attributes"]
        for key in ("binding", "start"):
            if attributes[key] is None:
                continue
            # A start that stands beside a binding is derived from it; whose it is does not matter.
            is_derived = key == "start" and attributes["binding"] is not None
            if variable["name"] in names or is_derived:
                stack = [attributes[key]]
                while stack:
                    number = stack.pop()
                    owner[number] = "" if is_derived else variable["name"]
                    stack.extend(below[number])
    foreign = {number for number in differing if number not in owner}
    for number, operands in enumerate(below):
        if number not in owner:
            foreign |= differing.intersection(operands)
    values = set()
    for number in foreign:
        literal_ = others[number]["literal"]
        value = literal_.get("real", literal_.get("integer")) if isinstance(literal_, dict) else None
        if not isinstance(value, (int, float)):
            return None
        values.add(abs(float(value)))
    return frozenset(owner[number] for number in differing - foreign) - {""}, frozenset(values)


def _operands(expressions: Mapping[str, Any]) -> list[list[int]] | None:
    """The operands of every node; None if they do not add up."""
    operands = expressions["operands"]
    found: list[list[int]] = []
    taken = 0
    for node in expressions["nodes"]:
        (kind, inside), *_ = node.items() if isinstance(node, dict) else ((node, None),)
        count = 0
        below: list[int] = []
        if isinstance(inside, dict):
            count = _QUOTIENT_OPERANDS if kind == "runtime_quotient_owner" else int(inside.get("operand_count") or 0)
            below = [inside[key] for key in ("operand", "lhs", "rhs", "base") if isinstance(inside.get(key), int)]
        found.append([*below, *operands[taken : taken + count]])
        taken += count
    return found if taken == len(operands) else None


def _is_literal(node: Any) -> bool:
    return isinstance(node, dict) and "literal" in node


def _bare(tree: Any, conditions: Sequence[Any] | None = None) -> Any:
    """*tree* without what says where it stands, and with *conditions*, if given, in place of their numbers.

    As deep as the front-end nests, which JSON could be read to.
    """
    if isinstance(tree, dict):
        # Elsewhere, under the key `condition`, there are expressions.
        numbered = ("condition",) if tree.keys() == {"condition"} else ("guard", "trigger")
        return {
            key: conditions[inside]
            if conditions is not None and key in numbered and isinstance(inside, int)
            else _bare(inside, conditions)
            for key, inside in tree.items()
            if key not in _IGNORED
        }
    if isinstance(tree, list):
        return [_bare(inside, conditions) for inside in tree]
    return tree
