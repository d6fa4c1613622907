"""A run: one configuration simulated once, and what came of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.api.presentation import definition_rows
from dse.api.presentation.html import table
from dse.api.presentation.quantities import units_called
from dse.domain.bench import Verdict, overall_verdict
from dse.domain.run import Outcome
from dse.errors import fail
from dse.storage import units_of

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from numpy.typing import NDArray

    from dse.domain import run as nouns
    from dse.domain.component import Value
    from dse.domain.definition import StudyDefinition


class Waveforms(Mapping[str, "NDArray[np.float64]"]):
    """Recorded variables by name, each an array over *time* (s), in SI; *units* names those units that are known.

    All arrays are float64 of the shape (points,), as *time*.

    >>> waveforms = dse.results("out/gains").run(7).waveforms
    >>> waveforms["world.speed"].shape == waveforms.time.shape == (601,)
    True
    """

    def __init__(self, noun: nouns.Waveforms, units: Mapping[str, str]) -> None:
        self._noun = noun
        self.time = noun.time
        self.units = {name: units[name] for name in noun.values if name in units}
        self._values = noun.values

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def to_pandas(self) -> pd.DataFrame:
        """A column for each variable over ``time``; ``frame.attrs["units"]`` has the units that are known."""
        import pandas as pd

        frame = pd.DataFrame(dict(self._values), pd.Index(self.time, name="time"))
        frame.attrs["units"] = {"time": "s", **self.units}
        return frame

    def write(self, target: str | Path, about: Mapping[str, Any] | None = None) -> None:
        """Write them to a .csv, .json or .parquet file: SI, numbers in full, with the units that are known.

        *about* are further keys for JSON. Raises DseError for another suffix, or if it cannot be written.
        """
        from dse.storage import write_waveform_file

        write_waveform_file(Path(target), self._noun, self.units, about or {})

    def __repr__(self) -> str:
        return f"<Waveforms of {len(self.time)} points: {', '.join(self)}>"


class Run:
    """One simulation; *noun* is its record, *definition* defines what was measured.

    All numbers are SI; *units* names the units. A failed run has a `problem` and no metrics. *check* has the error bars
    of the metrics if the run was checked, else it is None.

    >>> run = dse.results("out/gains").run(57)
    >>> str(run.verdict), run.units["final_gap"]
    ('pass', 'm')
    """

    def __init__(
        self,
        noun: nouns.Run,
        definition: StudyDefinition,
        units: Mapping[str, str] | None = None,
        check: definition_rows.Check | None = None,
    ) -> None:
        self.noun = noun
        self.definition = definition
        self.check = check or definition_rows.check_by_bars(noun, definition)
        """What finer numerics can change of it, if that was looked at (``check_step``): ``check.errors`` by metric,
        ``check.certainties`` by requirement (``certain``, ``doubtful``)."""
        self.units: Mapping[str, str] = {**units_of(definition), **(units or {})}
        """SI unit by name, of metrics, margins (``R1.margin``), design variables and waveforms."""

    @property
    def number(self) -> int:
        """Its number in the study; 0 outside of one."""
        return self.noun.request.number

    @property
    def configuration(self) -> str:
        """The id of the configuration."""
        return self.noun.request.configuration

    @property
    def choices(self) -> Mapping[str, str]:
        """The choice at each place of the configuration."""
        return self.definition.configuration(self.configuration).choices

    @property
    def point(self) -> Mapping[str, Value]:
        """The values that differ from the bench, by ``part.parameter``."""
        return self.noun.request.point

    @property
    def is_done(self) -> bool:
        """Whether the simulation finished."""
        return self.noun.outcome is Outcome.DONE

    @property
    def problem(self) -> str:
        """The message of the run, above all why it failed; "" if there is none."""
        return self.noun.problem

    @property
    def metrics(self) -> Mapping[str, float]:
        """The metrics by name; NaN where one is undefined."""
        return self.noun.metrics

    @property
    def verdicts(self) -> Mapping[str, Verdict]:
        """The verdict on each requirement: ``pass``, ``fail``, ``not exercised``, ``failed to run``."""
        return {entry.requirement: entry.verdict for entry in self.noun.judgements}

    @property
    def verdict(self) -> Verdict | None:
        """The verdict on all requirements: one failure fails a run, and without one a gap leaves it open; None if there
        are no requirements."""
        if not self.definition.requirements:
            return None
        return overall_verdict([*self.verdicts.values()]) if self.is_done else Verdict.FAILED_TO_RUN

    @property
    def margins(self) -> Mapping[str, float]:
        """By how much each requirement is met, negative where it is not, NaN where that is undefined."""
        return {entry.requirement: entry.margin for entry in self.noun.judgements}

    @property
    def has_waveforms(self) -> bool:
        """Whether its waveforms were kept."""
        return self.noun.waveforms is not None

    @property
    def waveforms(self) -> Waveforms:
        """What was recorded over time. Raises DseError if nothing was kept."""
        if self.noun.waveforms is None:
            hint = "replay the run: Results.replay, or dse replay" if self.is_done else "it failed to run"
            raise fail(f"run {self.number} has no waveforms", None, hint)
        return Waveforms(self.noun.waveforms, self.units)

    def as_data(self, units: str = "shown") -> dict[str, Any]:
        """The run in the shape that it has in the JSON of `Results.export`, in these *units*."""
        from dse.storage import run_as_data, scales_of

        scales = scales_of(self.definition, units_called(units))
        names = (*self.point, *self.metrics, *(f"{name}.margin" for name in self.margins))
        data = run_as_data(self.noun, scales, str(self.verdict or ""))
        return {**data, "units": {name: scales[name].symbol for name in names if scales[name].symbol}}

    def __repr__(self) -> str:
        if not self.is_done:
            return f"<Run {self.number} of {self.configuration} failed: {self.problem}>"
        said = ", ".join(f"{name} {verdict}" for name, verdict in self.verdicts.items())
        return f"<Run {self.number} of {self.configuration}: {said or f'{len(self.metrics)} metrics'}>"

    def _repr_html_(self) -> str:
        rows = definition_rows.metric_rows(self.noun, self.definition, self.check)
        cells = [(r.title, r.value, r.requirement, r.bound, r.margin, r.judged) for r in rows]
        headings = ("metric", "value", "requirement", "bound", "margin", "verdict")
        shown = f"{self.definition.title}, configuration {self.configuration}"
        failed = "" if self.is_done else f": failed to run: {self.problem}"
        return table(shown + failed, headings, cells)
