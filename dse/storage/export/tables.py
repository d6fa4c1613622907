"""The table of runs for other programs. The same study gives the same bytes, however many workers made it.

Rows are sorted by run number; values are in the units that are shown, or all in SI; wall times are not exported.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from itertools import repeat
from typing import TYPE_CHECKING, Any

import numpy as np

from dse.domain.bench import VERDICTS, overall_verdict
from dse.domain.run import ERROR_BAR, Run
from dse.storage.checks import CERTAINTIES
from dse.storage.database.definition import definition_to_json
from dse.storage.draws import over_draws
from dse.storage.export.headings import (
    Scale,
    Units,
    choice_columns,
    headed,
    scales_of,
    titles_of,
    total_columns,
    verdict_column,
)
from dse.storage.export.junit import junit
from dse.storage.export.reqif import reqif
from dse.storage.export.requirements import requirement_sheet
from dse.storage.folder import StudyFolder

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
from dse.storage.database.table import RunTable


def to_csv(folder: StudyFolder, units: Units = Units.SHOWN) -> bytes:
    """UTF-8 CSV: run, configuration with its choices and sums, outcome, problem, variables, metrics, ``verdict`` (that
    on all requirements), ``R.verdict`` and ``R.margin``. Headings are ``name [unit]`` where there is a unit.

    Where runs were checked: ``R.certainty`` as well, and unless error bars are metrics, these (``NAME.error``) and
    what the check has to say (``check``).

    An undefined number is an empty cell; infinities are ``inf`` and ``-inf``; floats read back exactly, and variables
    from their units, too.
    """
    table = folder.table()
    scales = scales_of(folder.require_definition(), units)
    names, columns = zip(*columns_of(table, scales), strict=True)
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(headed(names, _symbols(scales)))
    writer.writerows(zip(*([_csv_cell(cell) for cell in column] for column in columns), strict=True))
    return text.getvalue().encode()


def to_json(folder: StudyFolder, units: Units = Units.SHOWN) -> bytes:
    """UTF-8 JSON: the study's definition (SI) and fingerprint, ``units`` by the names of the columns in the CSV, and
    one object (on one line) per run.

    An undefined number is null; infinities are the strings ``inf`` and ``-inf``.
    """
    header = folder.header
    scales = scales_of(header.definition, units)
    about = {
        "definition": definition_to_json(header.definition),
        "fingerprint": header.fingerprint,
        "units": _symbols(scales),
    }
    # Sorted, as a header that came from the user's files has its keys in another order than a stored one.
    head = _json(about, sort_keys=True).removesuffix("}")
    table = folder.table()
    checks = _json_checks(table, scales) if table.has_checks else repeat({})
    verdicts = _overall(table) or repeat("")
    each = zip(table.runs(), verdicts, checks, strict=False)
    runs = ",\n".join(_json({**run_as_data(run, scales, verdict), **check}) for run, verdict, check in each)
    return f'{head},"runs":[\n{runs}\n]}}\n'.encode()


def to_parquet(folder: StudyFolder, units: Units = Units.SHOWN) -> bytes:
    """A Parquet file with the columns of the CSV, called by their names; undefined numbers are NaN.

    A field with a unit has it in its metadata, as ``unit``.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    sink = pa.BufferOutputStream()
    pq.write_table(to_arrow(folder, units), sink, compression="zstd")
    data: bytes = sink.getvalue().to_pybytes()
    return data


def to_arrow(folder: StudyFolder, units: Units = Units.SHOWN) -> pa.Table:
    """The table of `to_parquet`."""
    import pyarrow as pa

    scales = scales_of(folder.require_definition(), units)
    known = _symbols(scales, plain=True)
    arrays = {name: pa.array(_floats(column)) for name, column in columns_of(folder.table(), scales)}
    fields = [
        pa.field(name, array.type, metadata={"unit": known[name]} if name in known else None)
        for name, array in arrays.items()
    ]
    return pa.table(list(arrays.values()), schema=pa.schema(fields))


def to_frame(folder: StudyFolder, units: Units = Units.SHOWN) -> pd.DataFrame:
    """One row per run, sorted by number, with the columns of the CSV, called by their names; undefined numbers are NaN.

    ``attrs["units"]`` has the unit of each column of numbers that are a quantity, ``attrs["titles"]`` the titles of
    variables, metrics and requirements.
    """
    import pandas as pd

    definition = folder.require_definition()
    scales = scales_of(definition, units)
    known = _symbols(scales, plain=True)
    columns = {name: _floats(column) for name, column in columns_of(folder.table(), scales)}
    frame = pd.DataFrame(columns).set_index("run")
    frame.attrs["units"] = {name: known[name] for name in frame.columns if name in known}
    frame.attrs["titles"] = titles_of(definition, frame.columns)
    return frame


def to_junit(folder: StudyFolder, units: Units = Units.SHOWN) -> bytes:
    """JUnit XML: a test suite per configuration, a test case per requirement and run; see `junit`."""
    return junit(over_draws(folder.table()), scales_of(folder.require_definition(), units))


def to_requirements(folder: StudyFolder, units: Units = Units.SHOWN) -> bytes:
    """A table of the requirements for a review board; see `requirement_sheet`."""
    return requirement_sheet(over_draws(folder.table()), scales_of(folder.require_definition(), units))


def to_reqif(folder: StudyFolder, units: Units = Units.SHOWN) -> bytes:
    """ReqIF: a SPEC-OBJECT for each requirement, with its results; see `reqif`."""
    notes = folder.notes()
    scales = scales_of(folder.require_definition(), units)
    return reqif(over_draws(folder.table()), scales, notes.sources if notes else ())


EXPORTS: Mapping[str, Callable[[StudyFolder, Units], bytes]] = {
    "csv": to_csv,
    "json": to_json,
    "parquet": to_parquet,
    "junit": to_junit,
    "requirements": to_requirements,
    "reqif": to_reqif,
}
"""Every format by its name."""


def columns_of(table: RunTable, scales: Mapping[str, Scale]) -> Iterator[tuple[str, list[object]]]:
    """The columns of the table by name, n values each in the units of *scales*; a problem is one line.

    Values of variables are decimal numbers where their unit is not SI, so that they read back exactly.
    """
    header = table.header
    verdicts = [str(verdict) for verdict in VERDICTS]
    yield "run", table.numbers.tolist()
    yield "configuration", list(table.configurations)
    yield from _described(table, scales)
    yield "outcome", np.where(table.done, "done", "failed").tolist()
    yield "problem", [" ".join(problem.split()) for problem in table.problems]
    for variable in header.definition.variables:
        values = table.points[variable.name].tolist()
        known = {value: variable.label(value) or scales[variable.name].point(value) for value in {*values}}
        yield variable.name, [known[value] for value in values]
    for name in header.metrics:
        yield name, scales[name].of(table.metric(name)).tolist()
    for name in header.metrics if len(table.checks) else ():
        yield f"{name}{ERROR_BAR}", scales[f"{name}{ERROR_BAR}"].of(table.errors(name)).tolist()
    if header.requirements:
        yield verdict_column(header.definition), [*_overall(table)]
    for name in header.requirements:
        yield f"{name}.verdict", [verdicts[code] for code in table.verdicts(name).tolist()]
        yield f"{name}.margin", scales[f"{name}.margin"].of(table.margins(name)).tolist()
        if table.has_checks:
            yield f"{name}.certainty", [str(CERTAINTIES[code]) for code in table.certainties(name).tolist()]
    if len(table.checks):
        problems = table.checks.problems
        yield "check", [" ".join(problems.get(number, "").split()) for number in table.numbers.tolist()]


def run_as_data(run: Run, scales: Mapping[str, Scale], verdict: str) -> dict[str, Any]:
    """A run as plain data, with its *verdict* on all requirements if there are any."""
    return {
        "run": run.request.number,
        "configuration": run.request.configuration,
        "outcome": str(run.outcome),
        "problem": run.problem,
        "point": {name: scales[name].number(value) for name, value in run.request.point.items()},
        "metrics": {name: _json_number(scales[name].of(value)) for name, value in run.metrics.items()},
        **({"verdict": verdict} if verdict else {}),
        "requirements": {
            name: {"verdict": str(entry.verdict), "margin": _json_number(scales[f"{name}.margin"].of(entry.margin))}
            for name, entry in ((entry.requirement, entry) for entry in run.judgements)
        },
    }


def _overall(table: RunTable) -> list[str]:
    """The verdict of each run on all requirements; none if there are no requirements."""
    columns = [table.verdicts(name).tolist() for name in table.header.requirements]
    known = {codes: str(overall_verdict([VERDICTS[code] for code in codes])) for codes in {*zip(*columns, strict=True)}}
    return [known[codes] for codes in zip(*columns, strict=True)]


def _symbols(scales: Mapping[str, Scale], *, plain: bool = False) -> dict[str, str]:
    """Units by column, and with *plain* those of plain numbers."""
    return {name: scale.symbol for name, scale in scales.items() if scale.symbol or plain}


def _floats(column: list[Any]) -> list[Any]:
    return [float(value) if isinstance(value, Decimal) else value for value in column]


def _described(table: RunTable, scales: Mapping[str, Scale]) -> Iterator[tuple[str, list[object]]]:
    """What is chosen in the configuration of each run, None where there is no such place; its sums, NaN if empty."""
    definition = table.header.definition
    known = {configuration.id: configuration for configuration in definition.configurations}
    for path, name in choice_columns(definition).items():
        chosen = {key: configuration.choices.get(path) for key, configuration in known.items()}
        yield name, [chosen[key] for key in table.configurations]
    for total, name in total_columns(definition).items():
        sums = {
            key: scales[name].number(table.header.total(key, total)) if total in configuration.totals else math.nan
            for key, configuration in known.items()
        }
        yield name, [sums[key] for key in table.configurations]


def _csv_cell(cell: object) -> object:
    return "" if isinstance(cell, float) and math.isnan(cell) else cell


def _json_checks(table: RunTable, scales: Mapping[str, Scale]) -> Iterator[dict[str, object]]:
    """What each run has besides: error bars unless they are metrics, and how certain its verdicts are."""
    header, checked = table.header, set(table.checks.numbers.tolist())
    bars = {name: scales[f"{name}{ERROR_BAR}"] for name in header.metrics} if checked else {}
    errors = {name: scale.of(table.errors(name)).tolist() for name, scale in bars.items()}
    codes = {name: table.certainties(name).tolist() for name in header.requirements}
    for row, number in enumerate(table.numbers.tolist()):
        said = {name: str(CERTAINTIES[column[row]]) for name, column in codes.items() if column[row]}
        found: dict[str, object] = {"certainty": said} if said else {}
        if number in checked:
            found["errors"] = {name: _json_number(column[row]) for name, column in errors.items()}
            found["check"] = table.checks.problems.get(number, "")
        yield found


def _json(value: object, *, sort_keys: bool = False) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"), sort_keys=sort_keys)


def _json_number(value: object) -> object:
    if not isinstance(value, float) or math.isfinite(value):
        return value
    return None if math.isnan(value) else str(value)
