"""The runs of a study as a pandas data frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dse.storage.export import columns_of
from dse.storage.folder import StudyFolder

if TYPE_CHECKING:
    import pandas as pd


def to_frame(folder: StudyFolder) -> pd.DataFrame:
    """One row per run, sorted by number, with the columns of the CSV export; undefined numbers are NaN, values SI."""
    import pandas as pd

    return pd.DataFrame(dict(columns_of(folder.table()))).set_index("run")
