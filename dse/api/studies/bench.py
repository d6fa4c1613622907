"""Test benches and studies: what is simulated."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Required, TypedDict

from dse.api.authoring.defined import Defined, FileKind, InWorkspace
from dse.api.presentation.html import table
from dse.domain import study as nouns
from dse.domain.bench import TestBench
from dse.places import STUDY

if TYPE_CHECKING:
    from concurrent.futures import Executor as FuturesPool
    from typing import Unpack

    from dse.api.spaces.design import Design
    from dse.api.studies.plan import Plan
    from dse.api.studies.results import Results
    from dse.api.studies.run import Run
    from dse.domain.design import Configuration
    from dse.exploration import Progress
    from dse.loading import Raw


class Exploring(TypedDict, total=False):
    """How a study is explored: see `Study.explore`."""

    workers: int
    threads: int
    fuse: bool
    fresh: bool
    fmi: int
    sandbox: bool
    executor: FuturesPool | Callable[[], FuturesPool] | None
    progress: Callable[[Progress], None] | bool | None


class BenchKeys(TypedDict, total=False):
    """The arguments of `Bench`: the keys of a bench in ``testbenches/``."""

    title: str
    design: Required[str | Design]
    test_components: Mapping[str, Any]
    connections: Sequence[str]
    parameters: Mapping[str, Any]
    inputs: Mapping[str, Any]
    simulation: Required[Mapping[str, Any]]
    metrics: Mapping[str, Any]
    requirements: Mapping[str, Any]
    figures: Mapping[str, Any]


_BENCH: FileKind[TestBench] = FileKind(
    "Bench", "testbench", "testbenches", ".yaml", lambda files, name: files.bench(name)
)


class Bench(Defined[TestBench]):
    """A test bench; *noun* is the content of its file.

    >>> run = dse.open(".").benches["acc_following"].simulate(set={"controller.kp_speed": "1.2 1/s"})
    >>> run.is_done, str(run.verdicts["R1"])
    (True, 'pass')
    """

    def __init__(self, testbench: str, *, workspace: InWorkspace | None = None, **keys: Unpack[BenchKeys]) -> None:
        """Define the bench called *testbench*; the other arguments are the keys of its file.

        Quantities, expressions and connections are written as in YAML (``"70 km/h"``, ``"max(car.speed)"``); numbers
        without a unit are in that of the parameter, times in s. The file is written to *workspace*, by default that of
        the *design*. Raises DseError, which names the argument.
        """
        super().__init__(*_BENCH.define(testbench, keys, workspace))

    @property
    def design(self) -> Design:
        """The design space it tests."""
        from dse.api.spaces.design import Design

        return Design.of(self.noun.design, self.definitions)

    def simulate(
        self,
        configuration: str | Configuration | None = None,
        set: Mapping[str, Raw] | None = None,  # noqa: A002  # the command line's word
        *,
        check_step: bool = False,
        fuse: bool = False,
        fmi: int = 2,
        sandbox: bool = False,
    ) -> Run:
        """Simulate one configuration once, in a process of its own, and keep its waveforms.

        It is the first valid one, or the one whose id is or starts with *configuration*. *set* changes parameters:
        ``{"controller.kp_speed": 1.2}`` in the parameter's unit, or ``"1.2 1/s"``. With *check_step* every metric has
        an error bar beside it (``NAME.error``); with *fuse* the configuration is one library. In a *sandbox* FMUs have
        no network and write in their scratch folder only (Linux). Raises DseError if something cannot be built; a
        failed run is a result, too.
        """
        from dse.api.studies.single_run import prepare_once

        wanted = configuration if configuration is None or isinstance(configuration, str) else configuration.id
        given = set or {}
        prepared = prepare_once(self.noun, wanted, given, check_step=check_step, fuse=fuse, sandbox=sandbox, fmi=fmi)
        return prepared.simulate(sandbox=sandbox)

    def run(self, folder: str | Path, **options: Unpack[Exploring]) -> Results:
        """Run the bench on every valid configuration, into a study folder; see `Study.explore`."""
        from dse.testbench import bench_study

        return Study.of(bench_study(self.noun), self.definitions).explore(folder, **options)

    def __repr__(self) -> str:
        noun = self.noun
        counts = f"{len(noun.metrics)} metrics, {len(noun.requirements)} requirements"
        return f"<Bench {self.name} of {noun.design.name}: {noun.simulation.stop:g} s, {counts}>"

    def _repr_html_(self) -> str:
        noun = self.noun
        required = {entry.metric: entry.name for entry in noun.requirements}
        rows = [(m.name, m.title, m.text, str(m.unit), required.get(m.name, "")) for m in noun.metrics]
        headings = ("metric", "title", "expression", "unit", "requirement")
        return table(f"{self.name}: {noun.title or noun.design.name}", headings, rows)


class StudyKeys(TypedDict, total=False):
    """The arguments of `Study`: the keys of a ``.pet.yaml``."""

    title: str
    testbench: Required[str | Bench | Sequence[str | Bench]]
    configurations: str | Sequence[str] | Mapping[str, str]
    design_variables: Mapping[str, Any]
    constraints: Sequence[str]
    conditions: Mapping[str, Any]
    uncertain: Mapping[str, Any]
    correlations: Sequence[Sequence[str | float]]
    objectives: Sequence[str]
    sampler: str | Mapping[str, Any]
    executor: str | Mapping[str, Any]
    keep_waveforms: str
    check_step: str
    bench_weights: Sequence[str | float]
    seed: int
    replicates: int | Mapping[str, Any]


_STUDY: FileKind[nouns.Study] = FileKind("Study", "study", "testbenches", STUDY, lambda files, name: files.study(name))


class Study(Defined[nouns.Study]):
    """Design variables explored on a test bench (PET); *noun* is the content of its file.

    >>> study = dse.open(".").studies["acc_gains"]
    >>> study.explore("out/gains")
    <Results in out/gains: 2178 of 2178 runs>
    """

    def __init__(self, study: str, *, workspace: InWorkspace | None = None, **keys: Unpack[StudyKeys]) -> None:
        """Define the study called *study*; the other arguments are the keys of its file.

        Ranges are written as in YAML: ``design_variables={"controller.kp": {"range": [0.1, "3 1/s"]}}``; numbers
        without a unit are in that of the parameter. The file is written to *workspace*, by default that of the bench.
        Raises DseError, which names the argument.
        """
        super().__init__(*_STUDY.define(study, keys, workspace))

    @property
    def bench(self) -> Bench:
        """The test bench it runs on."""
        return Bench.of(self.noun.bench, self.definitions)

    def explore(
        self,
        folder: str | Path,
        *,
        workers: int = 0,
        threads: int = 1,
        fuse: bool = False,
        fresh: bool = False,
        fmi: int = 2,
        sandbox: bool = False,
        retry_failed: bool = False,
        executor: FuturesPool | Callable[[], FuturesPool] | None = None,
        progress: Callable[[Progress], None] | bool | None = None,
    ) -> Results:
        """Make the runs that *folder* does not have yet, and return its results.

        *workers* processes (0: one for each processor) make *threads* runs at once each. *fuse* links each
        configuration into one library first, *fresh* deletes the contents of the folder; with *retry_failed*, runs that
        failed before are made again. *progress* is called with the progress; True shows a bar on standard error. In a
        *sandbox* FMUs have no network and write in their scratch folder only (Linux). *executor* makes the runs instead
        of what the study names: one of ``concurrent.futures`` with so many *workers* (0: as it says itself), or a
        function that makes one. Results do not depend on any of that. Runs that were made before, for this study or
        another, are not simulated again, unless *fresh*; `plan` lists them.

        Raises DseError with everything that is wrong, and ExplorationInterruptedError, a KeyboardInterrupt, on Ctrl-C:
        finished runs are stored, and the same call resumes.
        """
        from dse.api.presentation.progress import progress_shown
        from dse.api.studies.exploration import ExploreOptions, explore_into
        from dse.api.studies.results import Results

        options = ExploreOptions(workers, threads, fuse, fresh, fmi, sandbox, retry_failed, executor)
        with progress_shown(progress) as tell:
            explored = explore_into(self.noun, Path(folder), options, on_progress=tell)
        source = self.noun.where.file if self.definitions and self.noun.where else None
        return Results(Path(folder), explored, source)

    def plan(
        self, folder: str | Path, *, workers: int = 0, fuse: bool = False, fresh: bool = False, fmi: int = 2
    ) -> Plan:
        """What `explore` would do with these arguments: which runs it would simulate, why, and how long it takes.

        FMUs are built, nothing is simulated, and *folder* is left as it is. Raises DseError as `explore` would.
        """
        from dse.api.studies.exploration import ExploreOptions, plan_into

        return plan_into(self.noun, Path(folder), ExploreOptions(workers, 1, fuse, fresh, fmi))

    def __repr__(self) -> str:
        names = ", ".join(variable.name for variable in self.noun.variables)
        return f"<Study {self.name} on {self.noun.bench.name}: {names}>"

    def _repr_html_(self) -> str:
        rows = [
            (v.name, v.title, *(f"{v.unit.from_si(value):g}" for value in (v.low, v.high, v.nominal)), str(v.unit))
            for v in self.noun.variables
        ]
        headings = ("design variable", "title", "low", "high", "nominal", "unit")
        return table(f"{self.name}: {self.noun.title or self.noun.bench.name}", headings, rows)
