"""The runs of a study as labelled arrays over what was varied."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dse.errors import closest, fail
from dse.storage import read_chosen_waveforms

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from dse.domain.run import Waveforms
    from dse.storage import StudyFolder

_RUN = "run"


def to_xarray(frame: pd.DataFrame, choices: Sequence[str], variables: Sequence[str]) -> xr.Dataset:
    """The runs in *frame* (see `Results.to_pandas`): over ``configuration`` and *variables* if each of their
    combinations was run once, else over ``run``. *choices* are the columns that follow from the configuration.

    Raises DseError if xarray is not installed.
    """
    try:
        import xarray as xr
    except ImportError:
        raise fail("xarray is not installed", hint="pip install 'dse-workbench[xarray]'") from None
    axes = ["configuration", *variables]
    sizes = [frame[axis].nunique() for axis in axes]
    is_grid = math.prod(sizes) == len(frame) and not frame.duplicated(axes).any()
    table = frame.reset_index().set_index(axes) if is_grid else frame
    found = xr.Dataset.from_dataframe(table)
    if is_grid:
        each = frame.drop_duplicates("configuration").set_index("configuration")[list(choices)]
        labels = each.loc[found["configuration"].to_numpy()]
        found = found.assign_coords({name: ("configuration", labels[name].to_numpy()) for name in choices})
    else:
        found = found.set_coords([name for name in (*axes, *choices) if name in found])
    for name, said in (("units", frame.attrs["units"]), ("long_name", frame.attrs["titles"])):
        for column, text in said.items():
            if column in found.variables:
                found[column].attrs[name] = text
    return found


def with_waveforms(runs: xr.Dataset, store: StudyFolder, names: Sequence[str]) -> xr.Dataset:
    """*runs* with the waveforms *names*, which have the further axis ``time`` (s) and are in SI; NaN where none was
    kept. Raises DseError if no run has such a waveform, or if runs have other times than others."""
    files = {number: file for number, file in store.kept().items() if file}
    kept: dict[int, Waveforms] = {}
    for file in sorted({*files.values()}):
        kept |= read_chosen_waveforms(store.waveform_folder / file, files.keys(), {*names})
    for name in names:
        if not any(name in waveforms.values for waveforms in kept.values()):
            there = store.waveforms(min(files)) if files else None
            hint = closest(name, there.values) if there else "no waveforms were kept: keep_waveforms: all"
            raise fail(f"no run has the waveform '{name}'", hint=hint)
    time = kept[min(kept)].time
    for number, waveforms in kept.items():
        if not np.array_equal(waveforms.time, time):
            raise fail(f"run {number} has other times than run {min(kept)}", hint="read it alone: Results.run")
    axes, numbers = runs[_RUN].dims, runs[_RUN].to_numpy()
    nothing = np.full(len(time), np.nan)
    for name in names:
        columns = [kept[n].values.get(name, nothing) if n in kept else nothing for n in numbers.ravel().tolist()]
        runs[name] = ((*axes, "time"), np.reshape(columns, (*numbers.shape, len(time))))
    return runs.assign_coords(time=("time", time, {"units": "s"}))
