"""Everything that can be found wrong with a workspace without simulating anything.

FMUs are built only for benches whose algorithm asks something of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import ParamSpec

from dse.domain.bench import TestBench
from dse.domain.component import Component
from dse.domain.design import Configuration, DesignSpace
from dse.domain.method import Coupling, Method
from dse.domain.run import TESTBENCH
from dse.domain.study import Study, types_of
from dse.errors import DseError, Problem, Problems, raise_if_any
from dse.fmu import in_parallel
from dse.loading import Workspace, kind_of
from dse.metrics import compile_rule
from dse.places import NO_BENCHES, PROCEDURE, RATING, STUDY
from dse.space import check_space, open_space
from dse.testbench.multi_bench import shared_settings
from dse.testbench.prepare import check_bench, prepare_bench
from dse.testbench.prepared_bench import Setting
from dse.testbench.selection import one_configuration, proposing, selected
from dse.testbench.study import require_variables
from dse.testbench.wired_bench import wire_bench
from dse.world import open_roads, road_tables

P = ParamSpec("P")

_MOST_WIRED = 200
"""Configurations that are looked at for one that has a variable."""

OnProgress = Callable[[str, int, int, str], None]
"""Is told what is being checked, as "components": which one, of how many, and its name."""


def check_workspace(
    workspace: Workspace, on_progress: OnProgress | None = None, ignored: list[Problem] | None = None
) -> tuple[list[Problem], dict[str, int]]:
    """All problems, each once, and how many files of each kind were read; *ignored* is told what else should not be."""
    tell = on_progress or (lambda *_: None)
    counts: dict[str, int] = {}
    found = _of(_survey, workspace, counts)
    designs = _Designs()
    # What cannot be read is told once more by whatever needs it; all else is told besides.
    found += _components(workspace, tell, [] if ignored is None else ignored)
    for path in _roads(workspace):
        found += _of(_road, workspace, path)
    for what, folder in (("design spaces", "designs"), ("test benches and studies", "testbenches")):
        paths = list(workspace.files(folder))
        for number, path in enumerate(paths, 1):
            tell(what, number, len(paths), path.name)
            bench = next((read for end, read in _OTHERS.items() if path.name.endswith(end)), _bench)
            found += _of(_design if folder == "designs" else bench, workspace, str(path), designs)
    return list(dict.fromkeys(found)), counts


class _Designs:
    """What is found out about design spaces, each once, however many benches have it."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[DesignSpace, list[Problem]]] = {}
        self._firsts: dict[int, Configuration] = {}

    def problems(self, space: DesignSpace) -> list[Problem]:
        """What is wrong with it."""
        if id(space) not in self._known:
            self._known[id(space)] = space, check_space(space)
        return self._known[id(space)][1]

    def first(self, space: DesignSpace) -> Configuration:
        """Its first configuration. Raises DseError if something is wrong with it, or it has none."""
        raise_if_any(self.problems(space))
        if id(space) not in self._firsts:
            self._firsts[id(space)] = one_configuration(space, None)
        return self._firsts[id(space)]


def _components(workspace: Workspace, tell: OnProgress, ignored: list[Problem]) -> list[Problem]:
    """Reads them one by one, then looks into several at a time: models are translated, which takes seconds."""
    problems: list[Problem] = []
    read: dict[str, Component] = {}
    try:
        known = workspace.component_files
    except DseError as error:
        return list(error.problems)
    for name in known:
        try:
            read[name] = workspace.component(name)
        except DseError as error:
            problems += error.problems
    names = list(read)

    def done(number: int, of: int) -> None:
        if number < of:
            tell("components", number + 1, of, names[number])

    done(0, len(names))
    return problems + _of(in_parallel, names, lambda name: ignored.extend(_component(read[name])), done)


def _of(action: Callable[P, object], *args: P.args, **kwargs: P.kwargs) -> list[Problem]:
    try:
        action(*args, **kwargs)
    except DseError as error:
        return list(error.problems)
    return []


def _survey(workspace: Workspace, counts: dict[str, int]) -> None:
    benches = [path.name for path in workspace.files("testbenches")]
    counted = {end: sum(name.endswith(end) for name in benches) for end in NO_BENCHES}
    counts |= {
        "interface": len(workspace.interfaces),
        "component": len(workspace.component_files),
        "design space": len(list(workspace.files("designs"))),
        **({"road": roads} if (roads := len(_roads(workspace))) else {}),
        "test bench": len(benches) - sum(counted.values()),
        "study": counted[STUDY],
        **{end.split(".")[1]: counted[end] for end in (RATING, PROCEDURE) if counted[end]},
    }


def _design(workspace: Workspace, path: str, designs: _Designs) -> None:
    designs.first(workspace.design(path))


def _roads(workspace: Workspace) -> list[Path]:
    return [*workspace.files("roads"), *sorted((workspace.root / "roads").rglob("*.xodr"))]


def _road(workspace: Workspace, path: Path) -> None:
    """That it can be read, and that a path leads through it."""
    road_tables(open_roads(str(path), workspace))


def _component(component: Component) -> tuple[Problem, ...]:
    kind = kind_of(component)
    return tuple(kind.check(component, component.source) or ()) if kind is not None else ()


def _bench(workspace: Workspace, path: str, designs: _Designs) -> None:
    bench = workspace.bench(path)
    configuration = designs.first(bench.design)
    if _asks_of_fmus(bench.simulation.method) or _is_finished(bench, configuration):
        prepare_bench(bench, [configuration])
    else:
        check_bench(bench, configuration)


def _asks_of_fmus(method: Method) -> bool:
    """Whether only the FMUs know if they bear *method*."""
    return bool(method.steps) or method.adaptive is not None or method.coupling is Coupling.PROPAGATE


def _is_finished(bench: TestBench, configuration: Configuration) -> bool:
    """Whether there is nothing to build."""
    parts = [*configuration.parts.values(), *(part.component for part in bench.test_components)]
    return all(component.source is not None and component.source.is_finished for component in parts)


def _study(workspace: Workspace, path: str, designs: _Designs) -> None:
    _require_runnable(workspace.study(path), designs)


def _require_runnable(study: Study, designs: _Designs) -> None:
    space = study.bench.design
    if designs.problems(space):
        return  # the design's own file says what is wrong
    opened = proposing(study) if study.sampler.proposes else open_space(space, where=study.selection.where)
    few = selected(space, study.selection, study.where) if study.selection.ids else opened.configurations(_MOST_WIRED)
    settings: dict[str, Mapping[str, Setting]] = {}
    lacking = {variable.name for variable in study.variables}
    for configuration in few:
        shared = shared_settings([wire_bench(bench, configuration).settings for bench in study.benches])
        settings[configuration.id] = shared
        lacking -= {*shared, TESTBENCH}
        if len(settings) == 1 and study.bench.derived:
            for bench in study.benches:
                check_bench(bench, configuration)
        if not lacking:
            break
    if not settings:
        selected(space, study.selection, study.where)  # says that there is none
    if len(settings) < _MOST_WIRED:
        require_variables(study, settings)
    for constraint in study.constraints:
        compile_rule(constraint, types_of(study.variables))


def _rating(workspace: Workspace, path: str, _designs: _Designs) -> None:
    """What can be told without the protocol's package."""
    workspace.rating(path)


def _procedure(workspace: Workspace, path: str, designs: _Designs) -> None:
    problems = Problems()
    for test in workspace.procedure(path).tests:
        with problems:
            check_bench(test.bench, designs.first(test.bench.design))
            _require_runnable(test, designs)
    raise_if_any(problems)


_OTHERS = {STUDY: _study, RATING: _rating, PROCEDURE: _procedure}
"""How the files in ``testbenches/`` that are no benches are checked, by the ends of their names."""
