"""Configurations for other programs, written block by block: memory does not grow with what is written.

The same rows give the same bytes. A file appears under its name only once it is complete.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from io import TextIOWrapper
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from dse.errors import fail
from dse.scratch import written_whole
from dse.space.configurations.lookup import Lookup
from dse.space.configurations.resolve import ResolvedEntry, part_columns
from dse.space.decisions import sites
from dse.space.flat import Floats, Rows
from dse.space.output.sheet import Sheet

ROW_GROUP = 65_536
"""Rows of a row group of a Parquet file."""

RowWriter = Callable[[Sheet, Iterable[Rows], BinaryIO], int]
"""Writes blocks of rows and returns how many rows there were."""


def write_csv(sheet: Sheet, blocks: Iterable[Rows], stream: BinaryIO) -> int:
    """UTF-8 CSV with the sheet's headings; a place where nothing is chosen is an empty cell, and so is an empty sum."""
    text = TextIOWrapper(stream, "utf-8", newline="", write_through=True)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(sheet.headings)
    written = 0
    for rows in blocks:
        sums = [["" if math.isnan(v) else v for v in total.values(rows).tolist()] for total in sheet.totals]
        chosen = (place.chosen(rows) for place in sheet.places)
        writer.writerows(zip(sheet.ids(rows), *chosen, *sums, strict=True))
        written += len(rows)
    text.detach()
    return written


def write_json(sheet: Sheet, blocks: Iterable[Rows], stream: BinaryIO) -> int:
    """A UTF-8 JSON array with an object on each line: id, choices, components, totals; see `write_jsonl`."""
    stream.write(b"[")
    written = _write_objects(sheet, blocks, stream, "\n", ",\n")
    stream.write(b"\n]\n" if written else b"]\n")
    return written


def write_jsonl(sheet: Sheet, blocks: Iterable[Rows], stream: BinaryIO) -> int:
    """JSON lines: objects with the id, the choices by path, the components by path and the sums with their units.

    What is left out is not there; a sum that no part contributes to is not there either.
    """
    written = _write_objects(sheet, blocks, stream, "", "\n")
    stream.write(b"\n" if written else b"")
    return written


def write_parquet(sheet: Sheet, blocks: Iterable[Rows], stream: BinaryIO) -> int:
    """A Parquet file with the sheet's headings; choices are dictionary-encoded, what is not there is null."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    texts = pa.dictionary(pa.int32(), pa.string())
    kinds = [pa.string(), *(texts for _ in sheet.places), *(pa.float64() for _ in sheet.totals)]
    schema = pa.schema(list(zip(sheet.headings, kinds, strict=True)))
    names = [pa.array(place.names, pa.string()) for place in sheet.places]
    written = 0
    with pq.ParquetWriter(stream, schema, compression="zstd") as writer:
        for rows in _regular(blocks, ROW_GROUP):
            columns: list[Any] = [pa.array(sheet.ids(rows), pa.string())]
            for place, known in zip(sheet.places, names, strict=True):
                codes = place.of(rows)
                columns.append(pa.DictionaryArray.from_arrays(pa.array(codes, mask=codes < 0), known))
            columns += [pa.array(total.values(rows), from_pandas=True) for total in sheet.totals]
            writer.write_table(pa.table(columns, schema=schema), row_group_size=ROW_GROUP)
            written += len(rows)
    return written


WRITERS: Mapping[str, RowWriter] = {
    "csv": write_csv,
    "json": write_json,
    "jsonl": write_jsonl,
    "parquet": write_parquet,
}
"""Every format by its name, which is also the suffix of its files."""


def writer_of(target: Path) -> RowWriter:
    """The writer for a file, by its suffix. Raises DseError for one that is not known."""
    writer = WRITERS.get(target.suffix.lower().removeprefix("."))
    if writer is None:
        known = ", ".join(f".{suffix}" for suffix in WRITERS)
        raise fail(f"cannot determine the format of '{target.name}'", None, f"end its name in one of {known}")
    return writer


def save(sheet: Sheet, blocks: Iterable[Rows], target: Path) -> int:
    """Write blocks of rows to a file in the format of its suffix; returns how many rows there were.

    Raises DseError if the suffix is not known or the file cannot be written.
    """
    write = writer_of(target)
    with written_whole(target) as aside, aside.open("wb") as stream:
        return write(sheet, blocks, stream)


def _write_objects(sheet: Sheet, blocks: Iterable[Rows], stream: BinaryIO, first: str, between: str) -> int:
    written = 0
    for lines in _objects(sheet, blocks):
        stream.write(((between if written else first) + between.join(lines)).encode())
        written += len(lines)
    return written


def _objects(sheet: Sheet, blocks: Iterable[Rows]) -> Iterator[list[str]]:
    """The JSON text of each row."""
    choices = Lookup(
        [
            (number, [*(_member(variable.path, name) for name in variable.values), ""])
            for number, variable in enumerate(sheet.variables)
        ]
    )
    parts = Lookup(
        [
            (variable, [_component(entry) for entry in entries])
            for variable, entries in part_columns(sheet.variables, sites(sheet.space))
        ]
    )
    for rows in blocks:
        sums = [_json_sums(total.name, str(total.unit), total.values(rows)) for total in sheet.totals]
        # Every member starts with a comma, so each object's text starts with a comma too much.
        yield [
            f'{{"id":"{name}","choices":{{{"".join(chosen)[1:]}}},"components":{{{"".join(there)[1:]}}},'
            f'"totals":{{{"".join(added)[1:]}}}}}'
            for name, chosen, there, added in zip(
                sheet.ids(rows), choices.of(rows), parts.of(rows), _across(sums, len(rows)), strict=True
            )
        ]


def _member(name: str, text: str | None) -> str:
    return "" if text is None else f",{_json(name)}:{_json(text)}"


def _component(entry: ResolvedEntry[Any]) -> str:
    path, component = entry
    return "" if path is None or component is None else _member(path, component.name)


def _json_sums(name: str, unit: str, values: Floats) -> list[str]:
    head, tail = f',{_json(name)}:{{"value":', f',"unit":{_json(unit)}}}'
    shown = [repr(value) if math.isfinite(value) else f'"{value}"' for value in values.tolist()]
    return ["" if math.isnan(value) else head + text + tail for value, text in zip(values.tolist(), shown, strict=True)]


def _json(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _across(columns: list[list[str]], length: int) -> Iterable[tuple[str, ...]]:
    return zip(*columns, strict=True) if columns else ((),) * length


def _regular(blocks: Iterable[Rows], size: int) -> Iterator[Rows]:
    """The same rows in blocks of *size*, the last one shorter."""
    waiting: list[Rows] = []
    length = 0
    for block in blocks:
        waiting.append(block)
        length += len(block)
        if length >= size:
            rows = np.concatenate(waiting)
            whole = length - length % size
            yield from (rows[start : start + size] for start in range(0, whole, size))
            waiting, length = [rows[whole:]], length - whole
    if length:
        yield np.concatenate(waiting)
