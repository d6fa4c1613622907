"""Tables for pandas, with the units of their columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

    from dse.space import OpenedSpace


def configurations_frame(opened: OpenedSpace, limit: int | None) -> pd.DataFrame:
    """One row per configuration by id: the choices, None where nothing stands, and the sums, units in ``attrs``."""
    import pandas as pd

    sheet, rows = opened.sheet(), opened.rows(limit)
    columns: dict[str, Any] = {place.path: place.chosen(rows) for place in sheet.places}
    columns |= {f"sum({total.name})": total.values(rows) for total in sheet.totals}
    frame = pd.DataFrame(columns, pd.Index(sheet.ids(rows), name="id"))
    frame.attrs["units"] = {f"sum({total.name})": total.unit.symbol for total in sheet.totals}
    return frame
