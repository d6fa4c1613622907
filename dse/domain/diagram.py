"""What a Modelica model is made of and how its parts hang together, for a picture of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Link:
    """Two parts or ports that know of each other. A physical one is a connection of flanges or pins."""

    ends: tuple[str, str]
    is_physical: bool


@dataclass(frozen=True, slots=True)
class Diagram:
    """Top-level *parts* in the order of the model, and *links* between them and the ports, each pair once."""

    parts: tuple[str, ...]
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    links: tuple[Link, ...] = ()
