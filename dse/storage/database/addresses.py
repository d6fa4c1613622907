"""What names the runs of a study's configurations: by it they are found again when the study's files have changed."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping
from typing import Any

from dse.domain.address import Address
from dse.json_data import read_json


def read_addresses(connection: sqlite3.Connection) -> dict[str, Address]:
    """The address of each configuration that has one; none in a study that was made before there were any."""
    if not connection.execute("SELECT 1 FROM sqlite_schema WHERE name = 'addresses'").fetchone():
        return {}
    rows = connection.execute("SELECT configuration, address FROM addresses ORDER BY configuration").fetchall()
    try:
        return {name: _from_json(read_json(text)) for name, text in rows}
    except (ValueError, TypeError, KeyError):
        return {}  # not ours: nothing is known of these runs


def write_addresses(connection: sqlite3.Connection, addresses: Mapping[str, Address]) -> None:
    """Store *addresses* beside those that are there; the caller has a transaction open."""
    connection.execute(
        "CREATE TABLE IF NOT EXISTS addresses (configuration TEXT PRIMARY KEY, address TEXT NOT NULL) STRICT"
    )
    rows = [(name, json.dumps(_to_json(address), separators=(",", ":"))) for name, address in addresses.items()]
    connection.executemany("INSERT OR REPLACE INTO addresses VALUES (?, ?)", rows)


def _to_json(address: Address) -> dict[str, object]:
    return {
        "key": address.key,
        "names": address.names,
        "values": address.values.hex(),
        "places": address.places,
        "machine": address.machine,
    }


def _from_json(data: Mapping[str, Any]) -> Address:
    names, values = tuple(map(str, data["names"])), bytes.fromhex(data["values"])
    places = {str(name): tuple(map(int, at)) for name, at in dict(data["places"]).items()}
    key, machine = data["key"], data["machine"]
    is_whole = len(values) == 8 * len(names) and all(0 <= at < len(names) for where in places.values() for at in where)
    if not (is_whole and key.isalnum() and machine.isalnum()):  # they become names of files
        raise ValueError("no address")
    return Address(key, names, values, places, machine)
