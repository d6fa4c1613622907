"""A study ready to be explored: configurations chosen, benches prepared, header written."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from dse.domain.bench import TestBench
from dse.domain.component import Value
from dse.domain.definition import StudyDefinition
from dse.domain.design import Configuration
from dse.domain.noise import DRAW, HIGHEST_DRAW
from dse.domain.run import TESTBENCH
from dse.domain.sampler import Architectures, Nominal
from dse.domain.study import Keep, Selection, Study
from dse.errors import DseError, Location, Problem, Problems, fail, raise_if_any
from dse.loading import Raw, read_setting
from dse.testbench.definition import configuration_of, define, fmus_of
from dse.testbench.error_bars import with_error_bars
from dse.testbench.multi_bench import Prepared, together
from dse.testbench.numerics import Say
from dse.testbench.objectives import compile_objective
from dse.testbench.prepare import prepare_bench
from dse.testbench.prepared_bench import PreparedBench, Setting
from dse.testbench.selection import digest_of, proposing, selected
from dse.testbench.split_bench import WorldPlace
from dse.units import own_units


@dataclass(frozen=True, slots=True)
class Preparing:
    """How the configurations of *study* are prepared.

    FMUs are built as *version* of FMI; *say* and *sandboxed* are for `with_error_bars`. With a *world*, that half of
    the bench is there. *fuse* links each configuration into one library.
    """

    study: Study
    version: int = 2
    cache: Path | None = None
    say: Say = lambda _: None
    sandboxed: bool = False
    world: WorldPlace | None = None
    fuse: bool = False

    def benches(self, configurations: Iterable[Configuration]) -> dict[str, Prepared]:
        """*configurations* on the study's benches, by id. Raises DseError with everything that is wrong."""
        chosen, problems = tuple(configurations), Problems()
        made: list[dict[str, PreparedBench]] = []
        for bench in self.study.benches:
            with problems:
                made.append(self._on(bench, chosen))
        if problems:
            raise DseError(*dict.fromkeys(problems))
        _require_units(self.study, made)
        names = [bench.name for bench in self.study.benches]
        benches = {name: together([each[name] for each in made], names) for name in made[0]}
        if not self.fuse or not benches:
            return benches
        from dse.testbench.fuse import fuse_benches

        say = self.say
        say("fusing configurations")
        return fuse_benches(
            self.study, benches, cache=self.cache, tell=lambda n, all_: say(f"fusing configurations: {n} of {all_}")
        )

    def _on(self, bench: TestBench, configurations: Iterable[Configuration]) -> dict[str, PreparedBench]:
        test_parts = {part.name: part.component for part in bench.test_components}
        prepared = prepare_bench(bench, configurations, version=self.version, cache=self.cache, world=self.world)
        return {
            name: with_error_bars(
                each,
                {**each.configuration.parts, **test_parts},
                cache=self.cache,
                say=self.say,
                sandboxed=self.sandboxed,
            )
            for name, each in prepared.items()
        }


@dataclass(slots=True)
class PreparedStudy:
    """A study with its benches by configuration id, and its definition as it is stored.

    Of a sampler that proposes configurations there are those that were asked for so far, out of *space*.
    """

    study: Study
    benches: dict[str, Prepared]
    definition: StudyDefinition
    preparing: Preparing
    space: Architectures | None = None

    def recall(self, choices: Iterable[Mapping[str, str]]) -> None:
        """Prepare the configurations of *choices* that are still some, too. Raises DseError."""
        opened = proposing(self.study)
        found = (opened.of_choices(each) for each in choices)
        self.add(each for each in found if each is not None)

    def add(self, configurations: Iterable[Configuration]) -> dict[str, Prepared]:
        """Prepare *configurations*, too. Raises DseError."""
        made = self.preparing.benches(configurations)
        self.benches |= made
        self.definition = replace(
            self.definition,
            configurations=(
                *self.definition.configurations,
                *(configuration_of(each, self.study) for each in made.values()),
            ),
            fmus=dict(sorted({**self.definition.fmus, **fmus_of(made)}.items())),
        )
        return made


def prepare_study(
    study: Study,
    *,
    version: int = 2,
    cache: Path | None = None,
    say: Say = lambda _: None,
    sandboxed: bool = False,
    world: WorldPlace | None = None,
    fuse: bool = False,
) -> PreparedStudy:
    """Choose the configurations, build FMUs, assemble systems. Raises DseError with everything that is wrong.

    Of a sampler that proposes configurations only the first valid one is prepared: what is wrong with all shows there.
    *say* and *sandboxed* are for `with_error_bars`. With a *world*, that half of the bench is there. *fuse* links each
    configuration into one library.
    """
    if world is not None and study.others:
        raise fail("a study on several benches has no other half: each would need a world of its own", study.where)
    preparing = Preparing(study, version, cache, say, sandboxed, world, fuse)
    if not study.sampler.proposes:
        benches = preparing.benches(selected(study.bench.design, study.selection, study.where))
        require_variables(study, {name: bench.settings for name, bench in benches.items()})
        return PreparedStudy(study, benches, _checked(study, define(study, benches)), preparing)
    opened = proposing(study)
    first = preparing.benches(opened.configurations(1))
    if not first:
        raise opened.nothing()
    defined = _checked(study, define(study, first, digest_of(study)))
    return PreparedStudy(study, {}, replace(defined, configurations=(), fmus={}), preparing, opened.architectures())


def _require_units(study: Study, made: Sequence[Mapping[str, PreparedBench]]) -> None:
    """Raise DseError unless a metric is of the same dimension on every bench, where none of them gives it a unit."""
    problems = []
    programs = [next(iter(each.values())).program for each in made if each]
    for metric in study.metrics:
        having = [
            (bench, program.units[metric.name])
            for bench, program in zip(study.benches, programs, strict=False)
            if metric.name in program.units
        ]
        for bench, unit in having[1:]:
            first, theirs = having[0]
            if unit.dimension != theirs.dimension:
                what = f"the metric '{metric.name}' is in {unit or '1'} on '{bench.name}', and in {theirs or '1'}"
                problems.append(Problem(f"{what} on '{first.name}'", study.where, "rename one of them"))
    raise_if_any(problems)


def _checked(study: Study, definition: StudyDefinition) -> StudyDefinition:
    """*definition*, if its objectives can be computed. Raises DseError."""
    for objective in study.objectives:
        if objective.is_composite:
            compile_objective(objective, definition)
    return definition


def bench_study(bench: TestBench, selection: Selection | None = None) -> Study:
    """The study that runs a bench once on every configuration, waveforms kept."""
    return Study(
        bench.name, bench, (), Nominal(), selection or Selection(), Keep.ALL, title=bench.title, where=bench.where
    )


def with_settings(bench: TestBench, settings: Mapping[str, Raw], configuration: Configuration) -> TestBench:
    """*bench* with other parameter values for one configuration, given as the user writes them. Raises DseError."""
    test_parts = {part.name: part.component for part in bench.test_components}
    components = {path: (component,) for path, component in {**configuration.parts, **test_parts}.items()}
    values: dict[str, Value] = {}
    problems: list[Problem] = []
    for name, raw in settings.items():
        here = Location(f"--set {name}={raw}")
        try:
            if name == DRAW:
                values[name] = _read_draw(raw, here)
                continue
            with own_units(bench.design.units):
                values[name] = read_setting(name, raw, components, here, here)
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    return with_values(bench, values)


def _read_draw(raw: Raw, here: Location) -> int:
    try:
        draw = int(str(raw))
    except ValueError:
        draw = -1
    if not 0 <= draw < HIGHEST_DRAW:
        raise fail(f"the draw must be 0 … {int(HIGHEST_DRAW) - 1}, not {raw}", here, "draw=1")
    return draw


def with_values(bench: TestBench, values: Mapping[str, Value]) -> TestBench:
    """*bench* with other parameter values, in SI."""
    return replace(bench, parameters={**bench.parameters, **values})


def require_variables(study: Study, settings: Mapping[str, Mapping[str, Setting]]) -> None:
    """Raise DseError unless every design variable can be set in some configuration (*settings* by its id)."""
    problems = []
    for variable in study.variables:
        if variable.name != TESTBENCH and not any(variable.name in known for known in settings.values()):
            if variable.name == DRAW:
                what, hint = "no part has noise: all replicates would be the same", "leave 'replicates' out"
                hint += ", or declare which parameter is a seed: 'random: true' in component.yaml"
                problems.append(Problem(what, variable.where, hint))
                continue
            what = f"none of {len(settings)} configurations can vary '{variable.name}', as {next(iter(settings))}"
            hint = "vary a parameter, or an input nothing is connected to, that some chosen configuration has"
            hint += " on each of the benches" if study.others else ""
            problems.append(Problem(what, variable.where, hint))
    raise_if_any(problems)
