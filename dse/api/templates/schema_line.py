"""The first line of a file, by which editors know what may stand in it."""

from __future__ import annotations


def headed(text: str, depth: int, kind: str) -> str:
    """*text*, a file of the *kind* so many folders below the root of its workspace, with its schema named."""
    return f"# yaml-language-server: $schema={'../' * depth}schemas/{kind}.json\n{text}"
