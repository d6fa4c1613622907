"""Which parameters are structural: those whose values the front-end itself uses.

No list of uses would be complete, so it is tried: the model is compiled again with other values, and if anything but
the values changes (an array's size, a clock's period, which branch is taken), the parameter is structural. So is what
stands where a model gets its shape, as a trial may not cross a threshold (`shaping`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from dse.errors import Problem, raise_if_any
from dse.modelica.frontend.compile import Session, opened
from dse.modelica.frontend.literal import Value, literal
from dse.modelica.frontend.process import FrontEndDied, FrontEndRefusal
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.sources import ModelSources
from dse.modelica.frontend.structural.alterations import Alteration, alterations, number, refers_to
from dse.modelica.frontend.structural.comparison import changed_parameters
from dse.modelica.frontend.structural.shape import shaping


def compile_probed(sources: ModelSources, structural: Mapping[str, Value] | None = None) -> FrontEndResult:
    """As `compile_model`, and the result's *structural* is known. Raises DseError."""
    changes = {name: literal(value) for name, value in (structural or {}).items()}
    with opened(sources) as session:
        result = session.compiled(changes)
        raise_if_any(_ineffective(result, sources, structural or {}))
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
        relative = {path: name for name, path in session.sources.origins.items()}
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
        """Parameters that did not take their other value; None if more than values changed."""
        wanted = set(tried)
        names = frozenset(name for alteration in wanted for name in alteration.names)
        texts = {name: alteration.texts[alteration in wanted] for alteration in modified for name in alteration.names}
        dae = self._compiled(wanted, texts)
        changed = changed_parameters(self._base, dae, names) if dae is not None else None
        return names - changed if changed is not None else None

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
