"""What a configuration is simulated with, and what hangs on what."""

from __future__ import annotations

from dse.domain.definition import DefinedConfiguration


def parts_and_links(entry: DefinedConfiguration) -> tuple[dict[str, str], tuple[tuple[str, str], ...]]:
    """Components by path, "" for parts of the bench, and the pairs of them that wires join, in the order of these."""
    parts = sorted({*entry.components, *entry.start}, key=len, reverse=True)

    def owner(variable: str) -> str:
        # Paths and variables both have dots: the longest path that fits is the part.
        return next((part for part in parts if variable.startswith(f"{part}.")), "")

    ends = [tuple(map(owner, wire.split(" -> ", 1))) for wire in entry.wires]
    pairs = dict.fromkeys((a, b) for a, b in (end for end in ends if len(end) == 2) if a and b and a != b)
    links = tuple(pair for pair in pairs if pair[::-1] not in pairs or pair < pair[::-1])
    return {name: entry.components.get(name, "") for name in sorted(parts)}, links
