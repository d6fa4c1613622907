"""The waveforms of one run as a file for other programs, and for ``inputs`` of a bench. Numbers read back exactly."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dse.domain.run import Waveforms
from dse.errors import fail
from dse.scratch import written_whole

WAVEFORM_SUFFIXES = (".csv", ".json", ".parquet")


def write_waveform_file(target: Path, waveforms: Waveforms, units: Mapping[str, str], about: Mapping[str, Any]) -> None:
    """Write time and values, in SI, to *target*, of one of `WAVEFORM_SUFFIXES`.

    CSV: headings are ``name [unit]`` where *units* has one. JSON: the keys of *about*, ``time`` and ``signals``, each
    with its ``unit`` and ``values``. Parquet: float64 columns with the unit as the field's metadata ``unit``.
    Raises DseError for another suffix, or if *target* cannot be written.
    """
    if target.suffix.lower() not in WAVEFORM_SUFFIXES:
        raise fail(f"'{target.name}' must end in .csv, .json or .parquet")
    values = waveforms.values
    with written_whole(target) as aside:
        match target.suffix.lower():
            case ".parquet":
                aside.write_bytes(_parquet(waveforms, units))
            case ".json":
                signals = {name: {"unit": units.get(name, ""), "values": v.tolist()} for name, v in values.items()}
                data = {**about, "time": waveforms.time.tolist(), "signals": signals}
                aside.write_text(json.dumps(data, ensure_ascii=False, indent=1) + "\n", encoding="utf-8")
            case _:
                with aside.open("w", encoding="utf-8", newline="") as file:
                    writer = csv.writer(file, lineterminator="\n")
                    writer.writerow(
                        ["time", *(f"{name} [{units[name]}]" if units.get(name) else name for name in values)]
                    )
                    numbers = (column.tolist() for column in (waveforms.time, *values.values()))
                    writer.writerows(zip(*(map(repr, column) for column in numbers), strict=True))


def _parquet(waveforms: Waveforms, units: Mapping[str, str]) -> bytes:
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = {"time": waveforms.time, **waveforms.values}
    fields = [pa.field(name, pa.float64(), metadata={"unit": {"time": "s", **units}.get(name, "")}) for name in columns]
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table(list(columns.values()), pa.schema(fields)), sink, compression="zstd")
    data: bytes = sink.getvalue().to_pybytes()
    return data
