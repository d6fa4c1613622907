"""The table of slots of an FMU built here: written as C for its runtime, and as data for who builds on it."""

from __future__ import annotations

import json
from dataclasses import astuple, dataclass

from dse.json_data import read_json

PARTNER = "resources/partner.txt"
"""What in an FMU names the module of dse that is run as its partner (dse/fmu/runtime/partner.h)."""

LIVE = "sources/runtime/udp.h"
"""What an FMU has that exchanges datagrams with somebody outside."""

SLOT_TABLE = "slots.json"
"""Its file, below ``sources/``."""


@dataclass(frozen=True, slots=True)
class Row:
    """One variable; its place in the table is the value reference.

    *member* is a member of the component's struct, or of C made from Modelica the place among the model's values.
    *kind* and *settable* are the names that slot.h has for them, without their ``DSE_``; *items* counts those of an
    enumeration.
    """

    member: str
    kind: str
    settable: str
    items: int


@dataclass(frozen=True, slots=True)
class SlotTable:
    """*header* declares the component's struct, below ``sources/``; empty for C made from Modelica."""

    header: str
    rows: tuple[Row, ...]

    def to_bytes(self) -> bytes:
        """The content of SLOT_TABLE."""
        return json.dumps({"header": self.header, "rows": [astuple(row) for row in self.rows]}).encode("ascii")

    @staticmethod
    def from_bytes(content: bytes) -> SlotTable:
        """What `to_bytes` made it of. ValueError, KeyError or TypeError for anything else."""
        found = read_json(content)
        return SlotTable(found["header"], tuple(Row(*row) for row in found["rows"]))
