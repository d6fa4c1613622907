"""Tables for pandas and Arrow, with the units of their columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dse.api.showing import described

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

    from dse.space import OpenedSpace
    from dse.storage import StudyFolder


def runs_frame(folder: StudyFolder) -> pd.DataFrame:
    """One row per run by number, values SI, and ``attrs["units"]`` by column."""
    from dse.storage import to_frame

    frame = to_frame(folder)
    known = described.units(folder.require_definition())
    frame.attrs["units"] = {name: known[name] for name in frame.columns if name in known}
    return frame


def runs_table(folder: StudyFolder) -> pa.Table:
    """The same as an Arrow table; a field with a unit has it in its metadata, as ``unit``."""
    import pyarrow as pa

    from dse.storage import columns_of

    known = described.units(folder.require_definition())
    arrays = {name: pa.array(column) for name, column in columns_of(folder.table())}
    fields = [
        pa.field(name, array.type, metadata={"unit": known[name]} if name in known else None)
        for name, array in arrays.items()
    ]
    return pa.table(list(arrays.values()), schema=pa.schema(fields))


def configurations_frame(opened: OpenedSpace, limit: int | None) -> pd.DataFrame:
    """One row per configuration by id: the choices, None where nothing stands, and the sums, units in ``attrs``."""
    import pandas as pd

    sheet, rows = opened.sheet(), opened.rows(limit)
    columns: dict[str, Any] = {place.path: place.chosen(rows) for place in sheet.places}
    columns |= {f"sum({total.name})": total.values(rows) for total in sheet.totals}
    frame = pd.DataFrame(columns, pd.Index(sheet.ids(rows), name="id"))
    frame.attrs["units"] = {f"sum({total.name})": total.unit.symbol for total in sheet.totals}
    return frame
