"""``dse simulate`` of a package: its waveforms as a file, or what came of them as a table."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import typer

from dse.cli.arguments import Output
from dse.cli.diagnostics import Checked
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.terminal import console, plain, plain_table, print_json, print_line, print_some, print_table
from dse.errors import raise_if_any

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from dse.domain.method import Method
    from dse.interchange import PreparedPackage, ResolvedSystem

    Columns = Mapping[str, NDArray[np.float64]]

SUFFIXES = (".ssp", ".ssd", ".fmu")
_TIMEOUT = 600.0
"""Seconds a package's run may take, if nobody says it."""


@dataclass(frozen=True, slots=True)
class Wishes:
    """What a person asks of the simulation of a package, as typed; None for what is left to the package."""

    variant: str | None
    stop: str | None
    step: str | None
    settings: Mapping[str, str]
    record: tuple[str, ...]
    algorithm: str | None
    coupling: str | None
    extrapolation: str | None
    tolerance: float | None
    timeout: str | None


def is_package(name: str) -> bool:
    """Whether *name* is that of a package or an FMU, not of a test bench."""
    return Path(name).suffix.lower() in SUFFIXES


def waveform_file(path: Path | None) -> Path | None:
    """Refuse a file that could not be written before anything is simulated for it."""
    if path is not None and path.suffix.lower() not in (".csv", ".json", ".parquet"):
        raise typer.BadParameter(f"'{path.name}' must end in .csv, .json or .parquet")
    if path is not None and not path.parent.is_dir():
        raise typer.BadParameter(f"there is no folder '{path.parent}'")
    return path


def simulate_package(
    path: Path, wishes: Wishes, target: Path | None, output: Output, *, sandbox: bool, strict: bool
) -> None:
    """Simulate the package once, show or write its waveforms, and exit as it deserves.

    *strict*: what would be ignored is refused.
    """
    from dse.api import Waveforms, simulate_package as simulated
    from dse.interchange import prepare_ssp

    with console(stderr=True).status("opening FMUs"):
        prepared = prepare_ssp(
            path,
            variant=wishes.variant,
            stop=seconds("--stop", wishes.stop),
            step=seconds("--step", wishes.step),
            settings=wishes.settings,
            record=wishes.record,
            method=_method(wishes),
            tolerance=_tolerance(wishes.tolerance),
            timeout=seconds("--timeout", wishes.timeout) or _TIMEOUT,
        )
    _show_ignored(prepared.resolved, strict=strict)
    run = simulated(prepared, sandbox=sandbox)
    if run.waveforms is None:
        print_line(f"{path.name} failed to run: {run.problem}", style="bold red", stderr=True)
        raise typer.Exit(RUNS_FAILED)
    columns = run.waveforms.values
    if target is not None:
        # As other tools do, the headings of CSV are the names alone.
        is_csv = target.suffix.lower() == ".csv"
        units = {} if is_csv else prepared.units
        Waveforms(run.waveforms, units).write(target, _about(prepared))
        print_line(f"{target}: {len(columns)} waveforms of {len(run.waveforms.time)} points")
    elif output is Output.JSON:
        print_json(_data(columns, prepared))
    else:
        _show(path, columns, prepared)
    if run.problem:
        print_line(run.problem, style="yellow", stderr=True)
    raise typer.Exit(DONE)


def check_package(path: Path) -> Checked:
    """Read the package and its FMUs."""
    from dse.interchange import check_ssp

    with console(stderr=True).status("opening FMUs"):
        resolved = check_ssp(path)
    counts = {"FMU": len(resolved.structure.elements), "output": len(resolved.signals)}
    return Checked(ignored=resolved.ignored, counts=counts, notes=resolved.notes)


def _show_ignored(resolved: ResolvedSystem, *, strict: bool) -> None:
    if strict:
        raise_if_any(resolved.ignored)
    print_some("note", resolved.notes)
    print_some("ignored", resolved.ignored)


def seconds(option: str, text: str | None) -> float | None:
    """A time as a person types it: a number of seconds, or with a unit."""
    from dse.units import UnitError, parse_quantity, parse_unit

    if text is None:
        return None
    try:
        quantity = parse_quantity(text)
    except UnitError as error:
        raise typer.BadParameter(str(error), param_hint=option) from None
    if quantity.unit.symbol and quantity.unit.dimension != parse_unit("s").dimension:
        raise typer.BadParameter(f"'{text}' is not a time", param_hint=option)
    if quantity.si <= 0:
        raise typer.BadParameter(f"'{text}' is not positive", param_hint=option)
    return float(quantity.si)


def _tolerance(number: float | None) -> float | None:
    if number is not None and not 0.0 < number < 1.0:
        raise typer.BadParameter(f"{number:g} is not between 0 and 1", param_hint="--tolerance")
    return number


def _method(wishes: Wishes) -> Method:
    from dse.domain.method import Algorithm, Coupling, Extrapolation, Method

    return Method(
        algorithm=_word(Algorithm, wishes.algorithm, "--algorithm"),
        coupling=_word(Coupling, wishes.coupling, "--coupling"),
        extrapolation=_word(Extrapolation, wishes.extrapolation, "--extrapolation"),
    )


W = TypeVar("W", bound=StrEnum)


def _word(words: type[W], text: str | None, option: str) -> W:
    """The word typed; the first of them, which is the plain way, if none is."""
    known = list(words)
    if text is None:
        return known[0]
    if text not in known:
        raise typer.BadParameter(f"'{text}' is none of {', '.join(known)}", param_hint=option)
    return words(text)


def _data(columns: Columns, prepared: PreparedPackage) -> dict[str, object]:
    """The run as data: where each waveform begins and ends."""
    signals = {s.name: {"unit": s.unit, **_extremes(columns[s.name])} for s in prepared.resolved.signals}
    return {**_about(prepared), "signals": signals}


def _about(prepared: PreparedPackage) -> dict[str, object]:
    timing = prepared.timing
    head: dict[str, object] = {
        "system": prepared.ssp.name,
        "variant": prepared.ssp.variant,
        "stop": timing.stop,
        "step": timing.step,
    }
    if prepared.resolved.ignored:
        head["ignored"] = [str(problem) for problem in prepared.resolved.ignored]
    return head


def _extremes(values: NDArray[np.float64]) -> dict[str, float]:
    return {
        "start": float(values[0]),
        "end": float(values[-1]),
        "least": float(values.min()),
        "greatest": float(values.max()),
    }


def _show(path: Path, columns: Columns, prepared: PreparedPackage) -> None:
    screen, timing, ssp = console(), prepared.timing, prepared.ssp
    screen.print(plain(ssp.name), style="bold")
    more = f", variant {ssp.variant} of {', '.join(ssp.variants)}" if len(ssp.variants) > 1 else ""
    screen.print(plain(f"{path.name}{more}"), soft_wrap=True)
    screen.print(
        f"{timing.stop:g} s ({timing.stop_said_by}) in steps of {timing.step:g} s ({timing.step_said_by})",
        soft_wrap=True,
    )
    numbered = ("at the start", "at the end", "least", "greatest")
    table = plain_table("signal", *numbered, "unit", right=numbered)
    for signal in prepared.resolved.signals:
        numbers = _extremes(columns[signal.name]).values()
        table.add_row(plain(signal.name), *(f"{number:.6g}" for number in numbers), plain(signal.unit))
    print_table(table)
