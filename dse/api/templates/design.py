"""The start of a design space: a place for each interface, connected by the names of ports."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from dse.api.templates.wires import wires
from dse.api.templates.write import headed
from dse.domain.component import Component
from dse.errors import Location, fail

if TYPE_CHECKING:
    from dse.loading import Workspace


def new_design(workspace: Workspace, name: str, components: Sequence[str]) -> dict[PurePosixPath, str]:
    """The file of a design space *name* of *components*: those of one interface are alternatives of one place.

    An input is connected if one other place has an output of its name and type. Raises DseError.
    """
    if not components:
        known = ", ".join(sorted(workspace.component_files)[:6]) or "none yet: 'dse new component NAME' makes one"
        raise fail("a design space needs components", hint=f"dse new design {name} COMPONENT…, as {known}")
    option = Location("COMPONENT")
    places: dict[str, list[Component]] = {}
    for word in dict.fromkeys(components):
        component = workspace.component(word, option)
        places.setdefault(component.interface.name or component.name, []).append(component)
    lines = []
    for place, several in places.items():
        names = ", ".join(component.name for component in several)
        if len(several) > 1:
            lines.append(f"    {place}: {{alternatives: [{names}]}}\n")
        else:
            lines.append(f"    {place}: {names}{' ' * 8}# a choice: {{alternatives: [{names}, other]}}\n")
    found = wires({place: several[0].interface for place, several in places.items()})
    written = "".join(f"    - {source} -> {target}\n" for source, target in found)
    connections = (
        f"  connections:{' ' * 12}# from outputs to inputs; a bench connects the rest\n{written}"
        if written
        else "  # connections: [a.output -> b.input]   # a bench connects the rest\n"
    )
    text = (
        f"design: {name}\ntitle: {name}\n"
        f"root:\n  compound:{' ' * 15}# its places; {{optional: x}} may be left out\n{''.join(lines)}{connections}"
        "# constraints:                   # rules that are checked before simulation\n"
        "#   budget: {require: sum(cost) <= 1000 EUR, because: target price}\n"
    )
    return {PurePosixPath("designs", f"{name}.yaml"): headed(text, 1, "design")}
