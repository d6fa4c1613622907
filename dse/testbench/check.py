"""Everything that can be found wrong with a workspace without simulating anything.

FMUs are built only for benches whose algorithm asks something of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ParamSpec

from dse.domain.bench import TestBench
from dse.domain.design import Configuration
from dse.domain.method import Coupling, Method
from dse.errors import DseError, Problem
from dse.loading.kind import kind_of
from dse.loading.workspace import Workspace
from dse.space.check import check as check_space
from dse.testbench.plan import require_variables
from dse.testbench.prepare import check_bench, prepare, settable
from dse.testbench.select import one, selected

P = ParamSpec("P")


def check_workspace(workspace: Workspace) -> tuple[list[Problem], dict[str, int]]:
    """All problems, each once, and how many files of each kind were read."""
    counts: dict[str, int] = {}
    found = _of(_survey, workspace, counts)
    if not found:
        for name in workspace.component_files:
            found += _of(_component, workspace, name)
        for path in workspace.files("designs"):
            found += _of(_design, workspace, str(path))
        for path in workspace.files("testbenches"):
            reader = _study if path.name.endswith(".pet.yaml") else _bench
            found += _of(reader, workspace, str(path))
    return list(dict.fromkeys(found)), counts


def _of(action: Callable[P, object], *args: P.args, **kwargs: P.kwargs) -> list[Problem]:
    try:
        action(*args, **kwargs)
    except DseError as error:
        return list(error.problems)
    return []


def _survey(workspace: Workspace, counts: dict[str, int]) -> None:
    benches = [path.name for path in workspace.files("testbenches")]
    studies = sum(name.endswith(".pet.yaml") for name in benches)
    counts |= {
        "interface": len(workspace.interfaces),
        "component": len(workspace.component_files),
        "design space": len(list(workspace.files("designs"))),
        "test bench": len(benches) - studies,
        "study": studies,
    }


def _design(workspace: Workspace, path: str) -> None:
    problems = check_space(workspace.design(path))
    if problems:
        raise DseError(*problems)
    one(workspace.design(path), None)


def _component(workspace: Workspace, name: str) -> None:
    component = workspace.component(name)
    kind = kind_of(component)
    if kind is not None:
        kind.check(component, component.source)


def _bench(workspace: Workspace, path: str) -> None:
    bench = workspace.bench(path)
    problems = check_space(bench.design)
    if problems:
        raise DseError(*problems)
    configuration = one(bench.design, None)
    check_bench(bench, configuration)
    if _asks_of_fmus(bench.simulation.method) or _is_finished(bench, configuration):
        prepare(bench, [configuration])


def _asks_of_fmus(method: Method) -> bool:
    """Whether only the FMUs know if they bear *method*."""
    return bool(method.steps) or method.adaptive is not None or method.coupling is Coupling.PROPAGATE


def _is_finished(bench: TestBench, configuration: Configuration) -> bool:
    """Whether there is nothing to build."""
    parts = [*configuration.parts.values(), *(part.component for part in bench.test_components)]
    return all(component.source is not None and component.source.is_finished for component in parts)


def _study(workspace: Workspace, path: str) -> None:
    study = workspace.study(path)
    space = study.bench.design
    if check_space(space):
        return  # the design's own file says what is wrong
    first = selected(space, study.selection, study.where)[0]
    require_variables(study, {first.id: settable(study.bench, first)})
