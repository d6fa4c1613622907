"""Which configurations a study or a command means."""

from __future__ import annotations

import json
from hashlib import sha256

from dse.domain.design import Configuration, DesignSpace
from dse.domain.study import Selection, Study
from dse.errors import Location, fail
from dse.space import OpenedSpace, alternatives, open_space

MOST_LISTED = 20_000
"""Configurations that are prepared before a study begins."""


def selected(space: DesignSpace, selection: Selection, where: Location | None = None) -> list[Configuration]:
    """The valid configurations the selection names, each once, in its order. Raises DseError if there is none."""
    if selection.configurations:
        return list(selection.configurations)
    if selection.ids:
        opened = open_space(space)
        return list({(c := opened.configuration(name)).id: c for name in selection.ids}.values())
    condition = selection.where
    opened = open_space(space, where=condition)
    found = list(opened.configurations(MOST_LISTED + 1))
    if len(found) > MOST_LISTED:
        what = f"'{space.name}' has more than {MOST_LISTED:,} configurations, and each would be prepared"
        hint = "narrow them with 'configurations: {where: …}', or take a sampler that proposes them, as uniform"
        raise fail(what, condition.where if condition else where or space.where, hint)
    if not found:
        what = "no configuration meets the condition" if condition else f"'{space.name}' has no valid configuration"
        place = condition.where if condition else where or space.where
        raise fail(what, place, f"list what there is: dse enumerate {space.name}")
    return found


def proposing(study: Study) -> OpenedSpace:
    """The design space that the sampler of *study* proposes configurations from. Raises DseError."""
    if study.selection.ids:
        what = f"the sampler '{study.sampler.name}' proposes configurations itself, from all or a part of them"
        raise fail(what, study.where, "narrow them with 'configurations: {where: …}'")
    return open_space(study.bench.design, where=study.selection.where)


def digest_of(study: Study) -> str:
    """What names the part of the design space that *study* is over: its choices and constraints, not its components."""
    space, condition = study.bench.design, study.selection.where
    rules = [constraint.rule.text for constraint in space.constraints]
    named = {"alternatives": alternatives(space), "rules": rules, "where": condition.text if condition else ""}
    return sha256(json.dumps(named).encode()).hexdigest()[:16]


def one_configuration(space: DesignSpace, wanted: str | None) -> Configuration:
    """The valid configuration whose id starts with *wanted*; the first of all if it is None. Raises DseError."""
    if wanted is not None:
        return open_space(space).configuration(wanted)
    first = next(open_space(space).configurations(), None)
    if first is None:
        raise fail(f"'{space.name}' has no valid configuration", space.where, "relax its constraints")
    return first
