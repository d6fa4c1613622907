"""A drive made again with nobody at the wheel: what the driver in the loop put out comes from a table in its place."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from hashlib import sha256
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import TestBench
from dse.domain.component import Causality, Component, Interface, Port, Type
from dse.domain.design import Configuration
from dse.domain.drive import TUNE, Drive
from dse.domain.time_series import Interpolation, Missing, Outside, Series, TableFile, TimeSeriesSource
from dse.errors import Location, Problem, fail, raise_if_any
from dse.live.driver_in_the_loop import driver_of, tunables_of, with_driver
from dse.live.shared_bench import Sharing, sharing_of, without_traffic

_NAME = "drive"


def bench_of_drive(drive: Drive, bench: TestBench, configuration: Configuration, folder: Path) -> TestBench:
    """*bench* as it was driven with *configuration*, to be simulated as any other: the same bits as in the drive.

    *folder* gets the table of what the driver in the loop put out, named by its content, which must stay there until
    the bench's FMUs
    are built. What follows after a drive that ended early is not simulated. Raises DseError for a drive of something
    else.
    """
    where = bench.where or Location(bench.name)
    sharing = sharing_of(bench, configuration) if drive.is_shared else None
    bench = without_traffic(bench, sharing) if sharing else bench
    types = _types(drive, bench, configuration, where, sharing)
    table = TableFile(_write(drive, types, folder))
    series = tuple(
        Series(port, table, number, 1, Interpolation.PREVIOUS, Outside.HOLD, Missing.SKIP, where)
        for number, port in enumerate(types, 2)
    )
    ports = tuple(Port(name, Causality.OUTPUT, type_) for name, type_ in types.items())
    names = {name: re.sub(r"\W+", "_", name) for name in types if "[" in name}
    component = Component(_NAME, Interface(_NAME, ports), source=TimeSeriesSource(series), names=names, where=where)
    tuned = [name.removeprefix(f"{TUNE}.") for name in types if _is_tuned(name)]
    driven = with_driver(bench, component, tuned, sharing.ends if sharing else None)
    simulation = replace(bench.simulation, stop=float(drive.time[-1]), record_every=drive.step)
    return replace(driven, parameters={**bench.parameters, **drive.settings}, simulation=simulation)


def _types(
    drive: Drive, bench: TestBench, configuration: Configuration, where: Location, sharing: Sharing | None
) -> dict[str, Type]:
    """What each column of *drive* is, in the order of its columns. Raises DseError."""
    raise_if_any(_misfits(drive, bench, configuration, where))
    interface = driver_of(bench).component.interface
    known = {port.name: port.type for port in interface.ports if port.causality is Causality.OUTPUT}
    known |= sharing.types if sharing else {}
    missing = known.keys() - drive.inputs.keys()
    tunables = tunables_of(bench, configuration)
    known |= {f"{TUNE}.{name}": parameter.type for name, parameter in tunables.items()}
    strange = drive.inputs.keys() - known.keys()
    for names, what in ((missing, "does not give"), (strange, "gives, without a receiver,")):
        if names:
            raise fail(f"the drive on '{bench.name}' {what} {', '.join(sorted(names))}", where, _ANOTHER)
    return {name: known[name].in_si for name in drive.inputs}


_ANOTHER = "the bench or the design has changed since the drive"


def _misfits(drive: Drive, bench: TestBench, configuration: Configuration, where: Location) -> Iterator[Problem]:
    if drive.bench != bench.name:
        yield Problem(f"the drive was on the bench '{drive.bench}', not on '{bench.name}'", where)
    if drive.configuration != configuration.id:
        yield Problem(f"the drive was with {drive.configuration}, not with {configuration.id}", where)
    if drive.step != bench.simulation.step:
        steps = f"{drive.step:g} s, not of {bench.simulation.step:g} s"
        yield Problem(f"the drive was made in steps of {steps}", bench.simulation.where or where, _ANOTHER)
    if len(drive.time) < 2 or any(len(column) != len(drive.time) for column in drive.inputs.values()):
        yield Problem("the drive has no step, or columns of different lengths", where)


def _is_tuned(name: str) -> bool:
    return name.startswith(f"{TUNE}.")


def _write(drive: Drive, types: Mapping[str, Type], folder: Path) -> Path:
    """The table: times, then a column for each of *types*, without the samples that only repeat the one before."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    # Half a step early: no rounding of a time decides which sample is the newest.
    columns = [drive.time - drive.step / 2, *(_changes(drive.inputs[name]) for name in types)]
    fields = [pa.field("time", pa.float64(), metadata={"unit": "s"})]
    fields += [
        pa.field(n, pa.float64(), metadata={"unit": str(t.unit)} if t.unit.symbol else None) for n, t in types.items()
    ]
    arrays = [pa.array(column, pa.float64()) for column in columns]
    written = BytesIO()
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), written, compression="zstd")
    file = folder / f"{sha256(written.getvalue()).hexdigest()[:20]}.parquet"
    folder.mkdir(parents=True, exist_ok=True)
    file.write_bytes(written.getvalue())
    return file


def _changes(column: NDArray[np.float64]) -> NDArray[np.float64]:
    """*column* with NaN for what is as before, but for the first and the last."""
    bits = np.ascontiguousarray(column, dtype=np.float64).view(np.int64)
    is_kept = np.ones(len(column), dtype=bool)
    is_kept[1:-1] = bits[1:-1] != bits[:-2]
    return np.where(is_kept, column, np.nan)
