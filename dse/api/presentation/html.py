"""Small tables for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

    from dse.space import OpenedSpace


def table(caption: str, headings: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """An HTML table; every text is escaped."""
    head = f"<thead><tr>{_cells(headings, 'th')}</tr></thead>" if headings else ""
    body = "".join(f"<tr>{_cells(row, 'td')}</tr>" for row in rows)
    return f"<table><caption>{escape(caption)}</caption>{head}<tbody>{body}</tbody></table>"


def _cells(cells: Sequence[object], tag: str) -> str:
    return "".join(f"<{tag}>{escape(str(cell))}</{tag}>" for cell in cells)


# Tables for pandas, with the units of their columns.


def configurations_frame(opened: OpenedSpace, limit: int | None) -> pd.DataFrame:
    """One row per configuration by id: the choices, None where nothing stands, and the sums, units in ``attrs``."""
    import pandas as pd

    sheet, rows = opened.sheet(), opened.rows(limit)
    columns: dict[str, Any] = {place.path: place.chosen(rows) for place in sheet.places}
    columns |= {f"sum({total.name})": total.values(rows) for total in sheet.totals}
    frame = pd.DataFrame(columns, pd.Index(sheet.ids(rows), name="id"))
    frame.attrs["units"] = {f"sum({total.name})": str(total.unit) for total in sheet.totals}
    return frame
