"""Reads what is said of columns of files over time: under ``source`` of a component, and ``inputs`` of a bench."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TypeVar

from dse.domain.time_series import Interpolation, Missing, Outside, Series, TableFile
from dse.errors import closest, fail
from dse.formats import Entry, shown
from dse.loading.paths import is_file, named_file
from dse.loading.sections import Section

Column = str | int
"""A column by its heading, also with a unit in brackets, or by its number from 1."""


class TableSection(Section):
    """A file, and how its columns are meant."""

    file: str
    time: Column = ""
    interpolation: str | None = None
    outside: str = "hold"
    missing: str = "error"
    separator: str = ""
    decimal: str = ""
    skip_lines: int = 0
    group: int | None = None


SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".parquet", ".mf4", ".mdf")


def read_series(
    entry: Entry, section: TableSection, columns: Mapping[str, tuple[Column, Entry]], inside: Path
) -> tuple[Series, ...]:
    """The series of the *columns*, by port; the file lies in the workspace *inside*. Raises DseError."""
    where = entry["file"].where
    path = named_file(entry.document.path.parent, section.file, inside, SUFFIXES, where)
    if not is_file(path):
        raise fail(f"no such file: {shown(path)}", where, "paths are relative to this file")
    for key, text, known in (
        ("separator", section.separator, (",", ";", "|", "\t", " ")),
        ("decimal", section.decimal, (".", ",")),
    ):
        if text and text not in known:
            raise fail(f"'{key}' cannot be '{text}'", entry[key].where, f"possible: {', '.join(map(repr, known))}")
    if section.skip_lines < 0:
        raise fail("'skip_lines' must be 0 or more", entry["skip_lines"].where)
    for column, at in (*columns.values(), (section.time, entry["time"])):
        if isinstance(column, int) and column < 1:
            raise fail("columns are counted from 1", at.where)
    file = TableFile(path, section.separator, section.decimal, section.skip_lines, section.group)
    between = None
    if section.interpolation is not None:
        between = _word(Interpolation, section.interpolation, entry["interpolation"])
    outside = _word(Outside, section.outside, entry["outside"])
    missing = _word(Missing, section.missing, entry["missing"])
    return tuple(
        Series(port, file, column, section.time, between, outside, missing, at.where)
        for port, (column, at) in columns.items()
    )


W = TypeVar("W", bound=StrEnum)


def _word(words: type[W], written: str, entry: Entry) -> W:
    if written not in list(words):
        raise fail(f"unknown {entry.name} '{written}'", entry.where, closest(written, words))
    return words(written)
