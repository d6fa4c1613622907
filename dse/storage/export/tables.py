"""The table of runs for other programs. The same study gives the same bytes, however many workers made it.

Rows are sorted by run number; all values are SI; wall times are not exported.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Iterator, Mapping
from itertools import repeat
from typing import TYPE_CHECKING

import numpy as np

from dse.domain.bench import VERDICTS
from dse.domain.run import ERROR_BAR, Run
from dse.storage.checks import CERTAINTIES
from dse.storage.database.definition import definition_to_json
from dse.storage.export.junit import junit
from dse.storage.folder import StudyFolder

if TYPE_CHECKING:
    import pandas as pd
from dse.storage.database.table import RunTable


def to_csv(folder: StudyFolder) -> bytes:
    """UTF-8 CSV: run, configuration, outcome, problem, variables, metrics, ``R.verdict`` and ``R.margin``.

    Where runs were checked: ``R.certainty`` as well, and unless error bars are metrics, these (``NAME.error``) and
    what the check has to say (``check``).

    An undefined number is an empty cell; infinities are ``inf`` and ``-inf``; floats read back exactly.
    """
    table = folder.table()
    names, columns = zip(*columns_of(table), strict=True)
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(zip(*([_csv_cell(cell) for cell in column] for column in columns), strict=True))
    return text.getvalue().encode()


def to_json(folder: StudyFolder) -> bytes:
    """UTF-8 JSON: the study's definition and fingerprint, and one object (on one line) per run.

    An undefined number is null; infinities are the strings ``inf`` and ``-inf``.
    """
    header = folder.header
    about = {"definition": definition_to_json(header.definition), "fingerprint": header.fingerprint}
    # Sorted, as a header that came from the user's files has its keys in another order than a stored one.
    head = _json(about, sort_keys=True).removesuffix("}")
    table = folder.table()
    checks = _json_checks(table) if table.has_checks else repeat({})
    runs = ",\n".join(_json({**_json_run(run), **check}) for run, check in zip(table.runs(), checks, strict=False))
    return f'{head},"runs":[\n{runs}\n]}}\n'.encode()


def to_parquet(folder: StudyFolder) -> bytes:
    """A Parquet file with the columns of the CSV; undefined numbers are NaN."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrays = {name: pa.array(column) for name, column in columns_of(folder.table())}
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table(arrays), sink, compression="zstd")
    data: bytes = sink.getvalue().to_pybytes()
    return data


def to_frame(folder: StudyFolder) -> pd.DataFrame:
    """One row per run, sorted by number, with the columns of the CSV; undefined numbers are NaN."""
    import pandas as pd

    return pd.DataFrame(dict(columns_of(folder.table()))).set_index("run")


def to_junit(folder: StudyFolder) -> bytes:
    """JUnit XML: a test suite per configuration, a test case per requirement and run; see `junit`."""
    return junit(folder.table())


EXPORTS: Mapping[str, Callable[[StudyFolder], bytes]] = {
    "csv": to_csv,
    "json": to_json,
    "parquet": to_parquet,
    "junit": to_junit,
}
"""Every format by its name."""


def columns_of(table: RunTable) -> Iterator[tuple[str, list[object]]]:
    """The columns of the table by name, n values each; a problem is one line."""
    header = table.header
    verdicts = [str(verdict) for verdict in VERDICTS]
    yield "run", table.numbers.tolist()
    yield "configuration", list(table.configurations)
    yield "outcome", np.where(table.done, "done", "failed").tolist()
    yield "problem", [" ".join(problem.split()) for problem in table.problems]
    for variable in header.definition.variables:
        values = table.points[variable.name].tolist()
        yield variable.name, [variable.label(value) or value for value in values] if variable.labels else values
    for name in header.metrics:
        yield name, table.metric(name).tolist()
    for name in header.metrics if len(table.checks) else ():
        yield f"{name}{ERROR_BAR}", table.errors(name).tolist()
    for name in header.requirements:
        yield f"{name}.verdict", [verdicts[code] for code in table.verdicts(name).tolist()]
        yield f"{name}.margin", table.margins(name).tolist()
        if table.has_checks:
            yield f"{name}.certainty", [str(CERTAINTIES[code]) for code in table.certainties(name).tolist()]
    if len(table.checks):
        problems = table.checks.problems
        yield "check", [" ".join(problems.get(number, "").split()) for number in table.numbers.tolist()]


def _csv_cell(cell: object) -> object:
    return "" if isinstance(cell, float) and math.isnan(cell) else cell


def _json_run(run: Run) -> dict[str, object]:
    return {
        "run": run.request.number,
        "configuration": run.request.configuration,
        "outcome": str(run.outcome),
        "problem": run.problem,
        "point": {name: _json_number(value) for name, value in run.request.point.items()},
        "metrics": {name: _json_number(value) for name, value in run.metrics.items()},
        "requirements": {
            judgement.requirement: {"verdict": str(judgement.verdict), "margin": _json_number(judgement.margin)}
            for judgement in run.judgements
        },
    }


def _json_checks(table: RunTable) -> Iterator[dict[str, object]]:
    """What each run has besides: error bars unless they are metrics, and how certain its verdicts are."""
    header, checked = table.header, set(table.checks.numbers.tolist())
    errors = {name: table.errors(name).tolist() for name in header.metrics} if checked else {}
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
