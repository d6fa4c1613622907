"""The results of a study, read from its folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from dse.api.presentation import definition_rows
from dse.api.presentation.html import table
from dse.api.presentation.quantities import units_called
from dse.api.spaces.design import several
from dse.api.studies.run import Run
from dse.domain.noise import DRAW
from dse.errors import fail

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    import pyarrow as pa
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from dse.analysis import Decision, Ranking
    from dse.api.studies.best_designs import BestDesigns, DesignChoice, Findings
    from dse.api.studies.replay import Replay
    from dse.api.studies.single_run import Tell
    from dse.domain import study as nouns
    from dse.domain.definition import StudyDefinition
    from dse.errors import Problem
    from dse.exploration import Explored
    from dse.report import Shot
    from dse.storage import RunTable, StudyFolder

T = TypeVar("T")


def results(folder: str | Path) -> Results:
    """The results in a study folder, finished or not. Raises DseError if it is not a study folder, or is damaged."""
    return Results(Path(folder))


_MOST_DRAWS = 10
"""Of noise, that a live page can be set to."""

_PICTURE = 960, 540  # pixels of the camera in a trace


@dataclass(frozen=True, slots=True)
class Summary:
    """*finished* of the study's *runs* are there; *failed* of them failed to run.

    *verdicts* counts each verdict by requirement. *problems* is what runs have to say of themselves, by number.
    """

    runs: int
    finished: int
    failed: int
    verdicts: Mapping[str, Mapping[str, int]]
    problems: Mapping[int, str]
    failures: frozenset[int]
    """Numbers of the runs that failed to run."""
    causes: Mapping[int, str]
    """What runs came to that were made once more, by number: they may have come right."""
    checked: int = 0
    """How many runs were repeated with finer numerics (``check_step``)."""
    doubtful: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    """How many of *verdicts* finer numerics or more draws may change, counted likewise: those are not certain."""
    remarks: Mapping[int, str] = field(default_factory=dict)
    """What the repetitions of runs have to say, by number: above all why nobody can tell how exact one is."""
    draws: str = ""
    """How many draws of the noise the verdicts rest on, in words; "" without noise."""

    def counts(self, requirement: str) -> dict[str, str]:
        """How many runs came to each verdict, in words: ``612 (9 doubtful)``."""
        doubtful = self.doubtful.get(requirement, {})
        return {
            verdict: f"{number} ({doubtful[verdict]} doubtful)" if doubtful.get(verdict) else str(number)
            for verdict, number in self.verdicts[requirement].items()
        }

    def _repr_html_(self) -> str:
        return self.as_html({})

    def as_html(self, labels: Mapping[str, str], title: str = "Study") -> str:
        """A table of the verdicts; *labels* are what requirements are called."""
        heads = dict.fromkeys(verdict for counts in self.verdicts.values() for verdict in counts)
        rows = [(labels.get(name, name), *self.counts(name).values()) for name in self.verdicts]
        what = f"{title}: {self.finished} of {self.runs} runs, {self.failed} failed"
        return table(what, ("requirement", *heads) if rows else (), rows)

    @property
    def unsettled(self) -> frozenset[int]:
        """Numbers of the runs that failed to run, or failed or gave another result when they were made again."""
        from dse.exploration import NOT_REPRODUCIBLE

        return self.failures | {number for number, said in self.problems.items() if said.startswith(NOT_REPRODUCIBLE)}

    @property
    def is_passed(self) -> bool:
        """Whether no run failed to run, no requirement failed and none is doubtful."""
        failed = any(counts["fail"] for counts in self.verdicts.values())
        return not self.failed and not failed and not any(any(c.values()) for c in self.doubtful.values())


class Results:
    """The runs in *folder*; each question reads the folder again. *explored*: the exploration, if it was done here.

    *definition* is the stored definition of the study. *source* is the file of the study, if it is known: what is
    simulated again is read from there. Raises DseError if the folder has no study, or is damaged.

    >>> results = dse.results("out/gains")
    >>> len(results), results.to_pandas().attrs["units"]["settling_time"]
    (2178, 's')
    """

    def __init__(self, folder: str | Path, explored: Explored | None = None, source: str | Path | None = None) -> None:
        self.folder = Path(folder)
        self.explored = explored
        self.source = source
        self.definition: StudyDefinition = self._read(lambda store: store.require_definition())

    @property
    def summary(self) -> Summary:
        """The number of runs, and their verdicts."""
        return self._read(lambda store: _summary(store.table(), store.causes()))

    def run(self, number: int) -> Run:
        """The run with this number, with its waveforms if they were kept, and error bars if it was checked."""
        return self._read(lambda store: _run(store, number, self.definition))

    def to_pandas(self, units: str = "shown") -> pd.DataFrame:
        """One row per run by number: choices and sums of its configuration, point, metrics, verdicts, margins.

        Numbers are in the units that the report and the terminal show, or with *units* ``si`` in SI.
        ``frame.attrs["units"]`` has the unit of each column that is a quantity, ``frame.attrs["titles"]`` the titles of
        those that have one. The column ``verdict`` is the verdict on all requirements together.
        """
        from dse.storage import to_frame

        return self._read(lambda store: to_frame(store, units_called(units)))

    def to_arrow(self, units: str = "shown") -> pa.Table:
        """The same as an Arrow table; a field's unit is in its metadata, as ``b"unit"``."""
        from dse.storage import to_arrow

        return self._read(lambda store: to_arrow(store, units_called(units)))

    def to_xarray(self, units: str = "shown", waveforms: Sequence[str] = ()) -> xr.Dataset:
        """The same as arrays: over ``configuration`` and the variables if each combination of their values was run
        once (a full factorial study), else over ``run``. *waveforms* names those to add: over ``time`` (s), too, in SI
        and NaN in runs without. ``attrs["units"]`` and ``attrs["long_name"]`` of an array are its unit and title.

        Needs the extra ``xarray``. Raises DseError, also for a waveform that no run has.
        """
        from dse.api.studies.arrays import to_xarray, with_waveforms
        from dse.storage import choice_columns, total_columns

        places = (*choice_columns(self.definition).values(), *total_columns(self.definition).values())
        variables = [variable.name for variable in self.definition.variables]
        found = to_xarray(self.to_pandas(units), places, variables)
        return self._read(lambda store: with_waveforms(found, store, waveforms)) if waveforms else found

    def figure(
        self,
        name: str = "constraints",
        *,
        x: str | None = None,
        y: str | None = None,
        configuration: str | None = None,
        run: int | None = None,
    ) -> Figure:
        """A figure for print, drawn with matplotlib: the constraint plot, or another one by its *name* (see
        ``dse figure``), as ``waveforms`` of a *run*.

        *x* and *y* are the design variables of the axes, by default the first two of the study or of its first slice;
        the *configuration* is the first, or the one whose id starts so. Raises DseError, also if there is nothing to
        draw of this study.
        """
        from dse.errors import fail
        from dse.report import View, configuration_called, drawings, read_content, read_insight, uses_insight

        if (x is None) != (y is None):
            raise fail(f"only {'x' if y is None else 'y'} is given", hint="give both x and y, or neither")
        content = read_content(self.folder)
        view = View(x, y, configuration_called(content, configuration), run)
        if uses_insight([name]):
            content = replace(content, insight=read_insight(self.folder))
        for _, sheet in drawings(name, content, view):
            return sheet
        raise fail(f"'{name}' has nothing to draw of this study")

    def findings(self, *, tell: Tell | None = None) -> Findings:
        """What the runs tell, in sentences: how often requirements are met, where, and what matters; what they do not
        tell, and why. Some of it needs the extra ``analysis``. *tell* hears what is looked for next."""
        from dse.analysis import findings
        from dse.api.studies.best_designs import Findings

        return Findings(findings(self._read(judged), tell or (lambda _: None)))

    def export(self, kind: str, units: str = "shown") -> bytes:
        """The table of runs as ``csv``, ``json``, ``parquet`` or ``junit``, or that of the requirements as
        ``requirements`` (CSV) or ``reqif``; *units* as in `to_pandas`."""
        from dse.errors import closest, fail
        from dse.storage import EXPORTS

        if kind not in EXPORTS:
            raise fail(f"results cannot be written as '{kind}'", None, closest(kind, EXPORTS))
        return self._read(lambda store: EXPORTS[kind](store, units_called(units)))

    def write_scene(
        self,
        run: int,
        target: str | Path | None = None,
        *,
        source: str | Path | None = None,
        live: bool = False,
        tell: Tell | None = None,
    ) -> Path:
        """Write a page with the *run* of this number in three dimensions; returns its path.

        A *live* page can be driven on: its reader changes a parameter at any moment, and it simulates what follows.

        It is *target*, or ``replays/run_RUN.html`` in the folder. The run is simulated once more: its study is found in
        the file *source*, else in the workspace around the folder or around here, if that is trusted. Raises DseError
        if it is not, if the run gives something else, or if nothing in it says where a car is.
        """
        from dse.api.studies.scenes import replay_file, scene_page_of
        from dse.scratch import make_folder, write_whole

        page = Path(target) if target is not None else replay_file(self.folder, run)
        found = scene_page_of(self.run(run), source=source or self.source, near=self.folder, live=live, tell=tell)
        make_folder(page.parent)
        write_whole(page, found)
        return page

    def replay_page(
        self, run: int, folder: str | Path | None = None, *, live: bool = False, tell: Tell | None = None
    ) -> Path:
        """The page that `write_scene` writes of a *run*, below *folder* (the study's): the one that is there, if it is
        of this run as it is now; a *live* one is always made. Raises DseError."""
        from dse.api.studies.scenes import mark_of, replay_file
        from dse.report import scene_mark

        page = replay_file(Path(folder or self.folder), run)
        if not live and scene_mark(page) == mark_of(self.run(run)):
            return page
        return self.write_scene(run, page, live=live, tell=tell)

    def runs_to_replay(self, which: str | int) -> tuple[int, ...]:
        """Numbers of the runs that came to their end: ``all`` of them, those that ``failed`` a requirement, or so many,
        spread evenly."""
        import numpy as np

        from dse.domain.bench import VERDICTS, Verdict

        table = self._read(judged)
        done = np.flatnonzero(table.done)
        if which == "failed":
            code = VERDICTS.index(Verdict.FAIL)
            has_failed = [table.verdicts(name) == code for name in table.header.requirements]
            done = done[np.any(has_failed, axis=0)[done]] if has_failed else done[:0]
        elif isinstance(which, int) and which < len(done):
            done = done[np.linspace(0, len(done) - 1, which).astype(int)]
        return tuple(table.numbers[done].tolist())

    def film_scene(
        self, run: int, target: str | Path, shot: Shot, *, source: str | Path | None = None, tell: Tell | None = None
    ) -> int:
        """Write what *shot* has of the *run* in three dimensions to *target*; returns how many frames.

        A PNG, or with a rate an animated picture, a video, or a folder of PNG files. A Chromium of the machine draws.
        Raises DseError if there is none, and as `write_scene` does.
        """
        from dse.report import film, require_target

        require_target(Path(target), shot)
        text = self.scene_page(run, source=source, tell=tell)
        return film(text, shot, Path(target), tell or (lambda _: None))

    def write_trace(
        self,
        run: int,
        target: str | Path,
        *,
        message: str = "ground_truth",
        part: str = "",
        rate: float = 25.0,
        pictures: float | None = None,
        layout: str | Path | None = None,
        source: str | Path | None = None,
        tell: Tell | None = None,
        warn: Tell | None = None,
    ) -> dict[str, int]:
        """Write a *run* as a trace file; returns the number of messages by topic.

        An ``.osi`` file contains messages of ASAM OSI of one type: *message* is ground_truth, sensor_view or
        sensor_data, the last two of one *part*. An ``.mcap`` file contains the ground truth, the data of all sensors
        and trackers, the scene in the messages of Foxglove, and all signals. *rate* is in messages per second;
        *pictures*, in pictures per second, adds a camera to an MCAP file. *layout* is a file for the arrangement of
        panels that Foxglove and Lichtblick import. The run is simulated again. *warn* receives each doubt about the
        size of the host.

        Raises DseError as `write_scene` does, for another ending, and without the extra ``traces``.
        """
        from dse.api.studies.scenes import trace_of
        from dse.report import (
            SceneSignals,
            chosen_part,
            frames_of,
            parts_with,
            require_packages,
            write_layout,
            write_mcap,
            write_osi,
        )

        def check(scene: SceneSignals) -> None:
            if kind == ".osi" and message != "ground_truth":
                chosen_part(parts_with(message, scene), message, part)

        require_packages()
        target = Path(target)
        if (kind := target.suffix.lower()) not in (".osi", ".mcap"):
            raise fail(f"'{target.name}' is not a trace file", hint="the ending is .osi or .mcap")
        source = source or self.source
        trace = trace_of(self.run(run), source=source, near=self.folder, rate=rate, tell=tell, check=check)
        if warn:
            for doubt in trace.scene.host.doubts:
                warn(doubt)
        if kind == ".osi":
            return {message: write_osi(trace, target, message, part)}
        progress = tell or (lambda _: None)
        frames = frames_of(trace.scene, pictures, "chase", _PICTURE, progress) if pictures else None
        counts = write_mcap(trace, target, frames)
        if layout:
            write_layout(trace, counts, Path(layout))
        return counts

    def scene_page(
        self,
        run: int,
        *,
        source: str | Path | None = None,
        workspace: Path | None = None,
        tell: Tell | None = None,
    ) -> str:
        """The page of a *run* as text: as `replay_page` has it in the folder, else made anew and not kept.

        Its study is taken from *source* or *workspace*, else found as `write_scene` does.
        """
        from dse.api.studies.scenes import mark_of, replay_file, scene_page_of
        from dse.report import scene_mark

        stored, page = self.run(run), replay_file(self.folder, run)
        if scene_mark(page) == mark_of(stored):
            return page.read_text(encoding="utf-8")
        where = source or self.source
        return scene_page_of(stored, source=where, near=self.folder, workspace=workspace, tell=tell)

    def scene_mark(self, run: int) -> str:
        """A digest of what a *run*'s page in three dimensions is made of: as long as it is the same, so is the page."""
        from dse.api.studies.scenes import mark_of

        return mark_of(self.run(run))

    def replays(self, folder: str | Path | None = None) -> tuple[int, ...]:
        """The runs that have a valid page for `replay_page`, below *folder* (the study's)."""
        from dse.api.studies.scenes import mark_of, replay_file, replays_in
        from dse.report import scene_mark

        place = Path(folder or self.folder)

        def are_there(store: StudyFolder) -> Iterator[int]:
            finished = store.finished()
            for number in replays_in(place):
                mark = scene_mark(replay_file(place, number))
                if number in finished and mark == mark_of(_run(store, number, self.definition)):
                    yield number

        return self._read(lambda store: tuple(are_there(store)))

    def report(
        self,
        target: str | Path | None = None,
        *,
        waveforms: int = 4000,
        live: bool = False,
        workspace: str | Path | None = None,
        on_problems: Callable[[Sequence[Problem]], None] | None = None,
        tell: Callable[[str], None] | None = None,
    ) -> Path:
        """Write the HTML report to *target* (``report.html`` in the folder) and return its path.

        It contains the waveforms of at most so many runs. Nothing is simulated; a *live* page can simulate by itself,
        for which the configurations are compiled from *workspace*, found as `replay_page` finds it. *on_problems* is
        called with problems: waveforms that are missing or damaged, and figures that could not be drawn; by default
        these are warnings. *tell* takes messages about the progress. Raises DseError for what cannot be in a live page.
        """
        from dse.report import read_report, with_replays, write_report

        page = Path(target) if target is not None else self.folder / "report.html"
        simulation = None
        if live:
            from dse.api.studies.page_simulation import page_simulation

            simulation = page_simulation(self.definition, self.folder, workspace, tell=tell, draws=self._draws())
        content = with_replays(read_report(self.folder, waveforms), self.replays(page.parent))
        if problems := (*content.missing, *write_report(content, page, simulation)):
            (on_problems or _warn)(problems)
        return page

    def print(
        self,
        target: str | Path,
        *,
        waveforms: int = 4000,
        on_problems: Callable[[Sequence[Problem]], None] | None = None,
    ) -> Path:
        """Write the report to *target* as PDF and return its path; as `report` otherwise.

        A Chromium of the machine prints it. Raises DseError if there is none.
        """
        from dse.report import print_report, read_report

        content = read_report(self.folder, waveforms)
        if content.missing:
            (on_problems or _warn)(content.missing)
        print_report(content, Path(target))
        return Path(target)

    def best(
        self, number: int = 5, *, minimize: str | Sequence[str] = (), maximize: str | Sequence[str] = ()
    ) -> BestDesigns:
        """The *number* best designs under one objective, or the front of several; without objectives those that meet
        all requirements, by their least margin.

        A design is a configuration with values for the design variables; its worst run counts. Objectives are metrics,
        ``sum(PROPERTY)``, or expressions in both; the default is those of the study. Raises DseError for an unknown
        objective.
        """
        from dse.analysis import objectives_of, ranked
        from dse.api.studies.best_designs import BestDesigns

        def answer(folder: StudyFolder) -> BestDesigns:
            wanted = objectives_of(folder.header.definition, several(minimize), several(maximize))
            return BestDesigns.of(ranked(judged(folder), wanted, number), folder.header.definition)

        return self._read(answer)

    def pareto(self, *, minimize: str | Sequence[str] = (), maximize: str | Sequence[str] = ()) -> BestDesigns:
        """The front of several objectives: the designs that meet all requirements and that no other one beats in all
        objectives, sorted by the first. Objectives are as in `best`. Raises DseError for fewer than two.
        """
        from dse.errors import fail

        found = self.best(minimize=minimize, maximize=maximize)
        if len(found.objectives) < 2:
            raise fail("two objectives or more are needed", None, "for one ask for 'best'")
        return found

    def against(self, one: str, other: str) -> Decision:
        """Two designs case by case, each named by the number of a run or the start of its configuration's id.

        Their draws are paired, as both met the same ones. Tells which is ahead, and what would change that. Raises
        DseError for what is no design of the study.
        """
        from dse.analysis import decide_between

        def answer(folder: StudyFolder) -> Decision:
            notes = folder.notes()
            return decide_between(folder.table(), one, other, notes.assumed if notes else None)

        return self._read(answer)

    def choice(self, ranking: Ranking | None = None) -> DesignChoice | None:
        """The design to take, the next one, and what decides between them; under the objectives of *ranking*, else the
        study's. None for a study without requirements or with one design, and if none was run at all conditions."""
        from dse.analysis import choice_of
        from dse.api.studies.best_designs import DesignChoice

        def answer(folder: StudyFolder) -> DesignChoice | None:
            notes, objectives = folder.notes(), ranking.objectives if ranking else None
            found = choice_of(folder.table(), notes.assumed if notes else None, objectives)
            return DesignChoice.of(found, folder.header.definition) if found else None

        return self._read(answer)

    def strength(self, ranking: Ranking, study: nouns.Study | None = None) -> tuple[str, ...]:
        """How strong the claim is that the designs of *ranking* are best: among how many, and how they were found.

        With the *study* also what no configuration of its design space can beat.
        """
        from dse.analysis import stages, static_bound, strength
        from dse.space import open_space

        space = open_space(study.bench.design, where=study.selection.where) if study else None
        bounds = [static_bound(space, each) if space else None for each in ranking.objectives]
        table = self._read(judged)
        sentences = [strength(ranking, len(table), bounds, self.definition)]
        if len(ranking.objectives) < 2:
            return tuple(sentences)
        ends = [round(len(table) * share) for share in (0.25, 0.5, 0.75)]
        shares = [
            stage.volume for stage in stages(table, ranking.objectives, [int(table.numbers[end]) for end in ends])
        ]
        if not any(share != share for share in shares):  # noqa: PLR0124  # NaN
            percentages = ", ".join(f"{100 * share:.0f} %" for share in shares)
            sentences.append(
                f"of the volume the front dominates, a quarter, half and three quarters of the runs had {percentages}"
            )
        return tuple(sentences)

    def study(self) -> nouns.Study | None:
        """The study, read from the workspace around the current folder; None if it is not there."""
        from dse.api.lookup import workspace_of
        from dse.errors import DseError

        try:
            return workspace_of(self.definition.study).study(self.definition.study)
        except DseError:
            return None

    def replay(self, number: int, *, source: str | Path | None = None, fmi: int = 2) -> Replay:
        """Simulate a run again and compare; its study is found in the workspace here, or in the file *source*."""
        from dse.api.studies.replay import replay

        return replay(self.run(number), source=source or self.source, fmi=fmi)

    def __len__(self) -> int:
        return len(self._read(lambda store: store.finished()))

    def __repr__(self) -> str:
        summary = self.summary
        failed = f", {summary.failed} failed" if summary.failed else ""
        return f"<Results in {self.folder}: {summary.finished} of {summary.runs} runs{failed}>"

    def _repr_html_(self) -> str:
        labels = definition_rows.requirement_labels(self.definition)
        return self.summary.as_html(labels, self.definition.title)

    def _draws(self) -> list[float]:
        """The first draws of noise that runs were made with."""
        drawn = self._read(lambda store: store.table().points.get(DRAW, ()))
        return sorted({float(draw) for draw in drawn})[:_MOST_DRAWS]

    def _read(self, question: Callable[[StudyFolder], T]) -> T:
        from dse.storage import StudyFolder

        with StudyFolder.open(self.folder) as store:
            return question(store)


def judged(store: StudyFolder) -> RunTable:
    """The runs of *store*, with one row for those that differ in their draw alone."""
    from dse.storage import over_draws

    return over_draws(store.table())


def _run(store: StudyFolder, number: int, definition: StudyDefinition) -> Run:
    from dse.storage import CERTAINTIES

    noun, table = store.run(number), store.table((number,))
    if not len(table.checks):
        return Run(noun, definition)
    errors = {name: float(table.errors(name)[0]) for name in table.header.metrics}
    certainties = {name: CERTAINTIES[table.certainties(name)[0]] for name in table.header.requirements}
    return Run(noun, definition, check=definition_rows.Check(errors, certainties))


def _summary(runs: RunTable, causes: Mapping[int, str]) -> Summary:
    from dse.storage import CERTAINTIES, Certainty, draws_sentence, over_draws

    names, points = runs.header.requirements, over_draws(runs)
    doubtful = CERTAINTIES.index(Certainty.DOUBTFUL)
    verdicts = {name: _counted(points.verdicts(name)) for name in names}
    doubts = {name: _counted(points.verdicts(name)[points.certainties(name) == doubtful]) for name in names}
    problems = {n: problem for n, problem in zip(runs.numbers.tolist(), runs.problems, strict=True) if problem}
    failures = frozenset(runs.numbers[~runs.done].tolist())
    checked = int(runs.done.sum()) if runs.are_all_checked else len(runs.checks)
    return Summary(
        runs.header.runs,
        len(runs),
        len(failures),
        verdicts,
        problems,
        failures,
        causes,
        checked,
        doubts if points.has_certainties else {},
        runs.checks.problems,
        draws_sentence(runs.header.definition, len(points)),
    )


def _counted(codes: NDArray[np.uint8]) -> dict[str, int]:
    from dse.domain.bench import VERDICTS, Verdict

    counted = ((code, verdict) for code, verdict in enumerate(VERDICTS) if verdict is not Verdict.NOT_APPLICABLE)
    return {str(verdict): int((codes == code).sum()) for code, verdict in counted}


def _warn(problems: Sequence[Problem]) -> None:
    import warnings

    for problem in problems:
        warnings.warn(str(problem), stacklevel=3)
