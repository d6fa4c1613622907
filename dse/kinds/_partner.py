"""The C of components whose work a partner does, a process of its own: what they ask it, what it answers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

from dse.domain.component import Causality, Component, Kind
from dse.domain.labels import c_member

_C_TYPES = {Kind.REAL: "double", Kind.INTEGER: "int32_t", Kind.BOOLEAN: "bool", Kind.ENUMERATION: "int32_t"}


def partner_files(component: Component, struct: str, step: float | None = None) -> dict[str, str]:
    """Header and code by file name. All goes as doubles, enumerations as numbers of their items.

    With *step* (s) the code is sampled.

    Asked are the step (0 at the start) and the values of `asked_names`, answered those of `answered_names`.
    """
    asked, answered = members_of(component, ("par", "in")), members_of(component, ("out",))
    asks = "".join(f"    self->ask[{1 + n}] = self->{member};\n" for n, (member, _) in enumerate(asked))
    takes = "".join(
        f"    self->{member} = {'' if type_ == 'double' else f'({type_})'}self->answer[{n}];\n"
        for n, (member, type_) in enumerate(answered)
    )
    members = "\n".join(struct_lines([*asked, *answered]))
    header = f"""#pragma once
#include <stdbool.h>
#include <stdint.h>

typedef struct {{
{members}
    double ask[{1 + len(asked)}], answer[{len(answered)}];
}} {struct};
void {struct}_init({struct} *self);
void {struct}_step({struct} *self{"" if step else ", double h"});
void {struct}_take({struct} *self);
"""
    code = f"""#include "{struct}.h"

static void ask({struct} *self, double h) {{
    self->ask[0] = h;
{asks}}}

void {struct}_init({struct} *self) {{ ask(self, 0.0); }}

void {struct}_step({struct} *self{"" if step else ", double h"}) {{ ask(self, {repr(step) if step else "h"}); }}

void {struct}_take({struct} *self) {{
{takes}}}
"""
    return {f"{struct}.h": header, f"{struct}.c": code}


def asked_names(component: Component) -> tuple[list[str], list[str]]:
    """Parameters and inputs by name, in the order in which they are asked."""
    inputs = [port.name for port in component.interface.ports if port.causality is Causality.INPUT]
    return [parameter.name for parameter in component.parameters], inputs


def answered_names(component: Component) -> list[str]:
    """Outputs by name, in the order in which they are answered."""
    return [port.name for port in component.interface.ports if port.causality is Causality.OUTPUT]


def members_of(component: Component, groups: Iterable[str]) -> list[tuple[str, str]]:
    """Members of the struct and their types, by the groups ``par``, ``in`` and ``out``."""
    ports = component.interface.ports
    found = {
        "par": [(p.name, p.type) for p in component.parameters],
        "in": [(p.name, p.type) for p in ports if p.causality is Causality.INPUT],
        "out": [(p.name, p.type) for p in ports if p.causality is Causality.OUTPUT],
    }
    return [
        (f"{group}.{c_member(component.variable(name))}", _C_TYPES[type_.kind])
        for group in groups
        for name, type_ in found[group]
    ]


def struct_lines(found: Iterable[tuple[str, str]]) -> Iterator[str]:
    """The lines that declare the members."""
    return _struct(_tree(found), 1)


_PART = re.compile(r"(\w+)((?:\[\d+\])*)")


def _tree(members: Iterable[tuple[str, str]]) -> dict[str, Any]:
    """By name: the sizes of an array, () for none, and what is in it: a type or another such tree."""
    tree: dict[str, Any] = {}
    for member, type_ in members:
        inner: Any = tree
        *groups, last = _PART.findall(member)
        for name, indices in groups:
            inner = _put(inner, name, indices, {})
        _put(inner, last[0], last[1], type_)
    return tree


def _put(tree: dict[str, Any], name: str, indices: str, content: Any) -> Any:
    sizes = tuple(int(index) + 1 for index in re.findall(r"\d+", indices))
    before, kept = tree.get(name, (sizes, content))
    tree[name] = (tuple(map(max, before, sizes)), kept)
    return kept


def _struct(tree: dict[str, Any], depth: int) -> Iterator[str]:
    indent = "    " * depth
    for name, (sizes, content) in tree.items():
        named = name + "".join(f"[{size}]" for size in sizes)
        if isinstance(content, str):
            yield f"{indent}{content} {named};"
        else:
            yield f"{indent}struct {{"
            yield from _struct(content, depth + 1)
            yield f"{indent}}} {named};"
