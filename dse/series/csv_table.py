"""Tables as text: CSV in the dialects of measuring devices and spreadsheets.

What can be meant in two ways is refused, with the key that decides it.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from dse.domain.time_series import TableFile
from dse.errors import Location, fail
from dse.formats import shown
from dse.series.columns import LARGEST_FILE, Place, RawColumn, split_unit

MISSING = frozenset({"", "nan", "na", "n/a", "null", "none", "-"})
"""What stands, in small letters, where there is no value."""

NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?", re.ASCII)


@dataclass(frozen=True, slots=True)
class TextTable:
    """*headings*, none if the first line has numbers, and *rows* of texts with the *lines* they stand on."""

    file: TableFile
    headings: tuple[str, ...]
    rows: Sequence[Sequence[str]]
    lines: Sequence[int]

    @property
    def width(self) -> int:
        """How many columns there are."""
        return len(self.headings or self.rows[0])

    def where(self, row: int, skipped: int = 0) -> Location:
        """Where *row* stands, counted from the row number *skipped*."""
        return Location(shown(self.file.path), self.lines[row + skipped], 1)

    def columns(self, places: Sequence[Place]) -> list[RawColumn]:
        """The columns at *places*, of which the first is the time; a line of units below the headings is none of them.

        Raises DseError if a decimal comma could be something else.
        """
        rows, skipped = self.rows, 0
        units = [""] * len(places)
        if self.headings and len(rows) > 1 and _is_unit(cell := _cell(rows[0], places[0].index)) and cell:
            units, skipped = [_bare(_cell(rows[0], place.index)) for place in places], 1
        texts = [[_cell(row, place.index) for row in rows[skipped:]] for place in places]
        if (self.file.decimal or self._decimal(texts, skipped)) == ",":
            texts = [[text.replace(",", ".") if _COMMA.fullmatch(text) else text for text in cells] for cells in texts]
        columns = []
        for place, cells, below in zip(places, texts, units, strict=True):
            heading = self.headings[place.index] if self.headings else f"column {place.index + 1}"
            unit = below or split_unit(heading)[1]
            at = partial(self.where, skipped=skipped)
            columns.append(RawColumn(heading, place.stated, unit, np.array(cells, dtype=object), at))
        return columns

    def _decimal(self, columns: Sequence[Sequence[str]], skipped: int) -> str:
        """The decimal sign in *columns*, by all numbers in them."""
        commas, points = [], False
        for cells in columns:
            for row, cell in enumerate(cells):
                if "," in cell and _COMMA.fullmatch(cell):
                    commas.append((row, cell))
                points = points or ("." in cell and NUMBER.fullmatch(cell) is not None)
        if not commas:
            return "."
        where = self.where(commas[0][0] + skipped)
        if points:
            raise fail(
                f"'{commas[0][1]}' has a comma, other numbers have a point", where, "set 'decimal: \".\"' or ','"
            )
        if all(_THOUSANDS.fullmatch(cell) for _, cell in commas):
            what = f"the comma in '{commas[0][1]}' may mark decimals or thousands"
            raise fail(what, where, "set 'decimal: \",\"', or take out the commas")
        return ","


_COMMA = re.compile(r"[+-]?\d*,\d*(?:[eE][+-]?\d{1,3})?", re.ASCII)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+", re.ASCII)


def read_text_table(file: TableFile, where: Location) -> TextTable:
    """The table in *file*. Raises DseError: it cannot be read, or how its columns are separated is not clear."""
    text = _text(file, where)
    if text.count("\n") > _MOST_LINES:
        raise fail(f"{shown(file.path)} has more than {_MOST_LINES:,} lines", where, "cut out what is used")
    numbered = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if number > file.skip_lines and line.strip() and not line.lstrip().startswith(("#", "%", "//"))
    ]
    stated = _STATED.fullmatch(numbered[0][1].strip()) if numbered else None
    numbered = numbered[1:] if stated else numbered
    if not numbered:
        raise fail(f"{shown(file.path)} is empty", where)
    lines = [line for _, line in numbered]
    separator = file.separator or (stated[1] if stated else _separator(file, lines[:_TRIED], where))
    rows, places = [], []
    try:
        if separator == " ":
            rows, places = [line.split() for line in lines], [number for number, _ in numbered]
        else:
            reader = csv.reader(lines, delimiter=separator, skipinitialspace=True)
            for row in reader:
                rows.append(row)
                places.append(numbered[reader.line_num - 1][0])
    except csv.Error as error:
        raise fail(f"no CSV: {error}", Location(shown(file.path), numbered[len(rows)][0])) from None
    head = [cell.strip() for cell in rows[0]]
    is_headed = not all(_is_number(cell) for cell in head if cell)
    while head and not head[-1]:
        head.pop()
    width = len(head)
    for row, line in zip(rows, places, strict=True):
        if len(row) > width and any(cell.strip() for cell in row[width:]):
            what = f"{len(row)} values, but {width} columns"
            raise fail(what, Location(shown(file.path), line, 1), "set 'separator:' or 'skip_lines:', or mend the line")
    first = int(is_headed)
    if len(rows) == first:
        raise fail(f"{shown(file.path)} has no row below its headings", where)
    return TextTable(file, tuple(head) if is_headed else (), rows[first:], places[first:])


_MOST_LINES = 1_000_000

_STATED = re.compile(r"sep=([,;|\t])", re.IGNORECASE)
"""What a spreadsheet writes before the headings."""

_TRIED = 50
"""Lines by which the separator is found out; all others have to agree with it."""


def _text(file: TableFile, where: Location) -> str:
    try:
        if file.path.stat().st_size > LARGEST_FILE:
            raise fail(
                f"{shown(file.path)} is larger than {LARGEST_FILE // 1_000_000} MB", where, "cut out what is used"
            )
        content = file.path.read_bytes()
    except OSError as error:
        raise fail(f"{shown(file.path)} cannot be read: {error.strerror or error}", where) from None
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", "replace")
    if b"\0" in content:
        raise fail(f"{shown(file.path)} is not text", where, "name a CSV file, or one that ends in .parquet or .mf4")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace")  # matters for headings and units only: µ, °


def _separator(file: TableFile, lines: Sequence[str], where: Location) -> str:
    """What stands between the cells of every one of *lines*; of two that do, the one that is no decimal comma."""
    for separator in ("\t", ";", "|", ","):
        head, *rows = csv.reader(lines, delimiter=separator)
        width = len(_stripped(head))
        is_even = width > 1 and all(width in (len(row), len(_stripped(row))) for row in rows)
        # Decimal commas between blanks look like a table of their own: 0,1 2,5.
        if is_even and not any(_TWO_NUMBERS.fullmatch(cell) for row in (head, *rows) for cell in row):
            return separator
    counts = {len(line.split()) for line in lines}
    if len(counts) == 1 and max(counts) > 1:
        return " "
    what = f"how the columns of {shown(file.path)} are separated is not clear"
    raise fail(what, where, "set 'separator: \",\"'; lines before the headings are left out by 'skip_lines: 3'")


_TWO_NUMBERS = re.compile(r"\s*[+-]?\d+\s+[+-]?\d+\s*", re.ASCII)


def _stripped(row: list[str]) -> list[str]:
    return row[:-1] if row and not row[-1].strip() else row


def _cell(row: Sequence[str], index: int) -> str:
    return row[index].strip() if index < len(row) else ""


def _is_number(cell: str) -> bool:
    return NUMBER.fullmatch(cell.replace(",", ".", 1)) is not None


def _is_unit(cell: str) -> bool:
    return _bare(cell).lower() in _TIME_UNITS


_TIME_UNITS = frozenset({"s", "sec", "ms", "us", "µs", "ns", "min", "h", "second", "seconds"})


def _bare(cell: str) -> str:
    return cell[1:-1].strip() if cell[:1] + cell[-1:] in ("[]", "()") else cell
