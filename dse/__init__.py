"""A workbench for designing cyber-physical products when architecture and numbers are both open.

What this package exports (``dse.__all__``) is public: docs/python.md shows it; so are `dse.plugins` and `dse.testing`,
for packages that add to it. Everything else is private and may change from one version to the next. Nothing is imported
before it is used.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False  # type checkers take it for true; importing typing would be most of ``import dse``

if TYPE_CHECKING:
    from dse.api.spaces.design import Design
    from dse.api.spaces.ranking import Ranking
    from dse.api.studies.bench import Bench, Study
    from dse.api.studies.exploring import ExplorationInterruptedError, Progress
    from dse.api.studies.results import Results, results
    from dse.api.studies.run import Run, Waveforms
    from dse.api.workspace import Workspace
    from dse.api.workspace import open_workspace as open  # noqa: A004  # dse.open(".") reads as it should
    from dse.errors import DseError, Problem
    from dse.space.methods.tally import Tally
    from dse.space.questions.explain import Explanation

__version__ = "0.1.0"

__all__ = [
    "Bench",
    "Design",
    "DseError",
    "Explanation",
    "ExplorationInterruptedError",
    "Problem",
    "Progress",
    "Ranking",
    "Results",
    "Run",
    "Study",
    "Tally",
    "Waveforms",
    "Workspace",
    "__version__",
    "open",
    "results",
]

_PLACES = {
    "Bench": "api.studies.bench:Bench",
    "Design": "api.spaces.design:Design",
    "DseError": "errors:DseError",
    "Explanation": "space.questions.explain:Explanation",
    "ExplorationInterruptedError": "api.studies.exploring:ExplorationInterruptedError",
    "Problem": "errors:Problem",
    "Progress": "api.studies.exploring:Progress",
    "Ranking": "api.spaces.ranking:Ranking",
    "Results": "api.studies.results:Results",
    "Run": "api.studies.run:Run",
    "Study": "api.studies.bench:Study",
    "Tally": "space.methods.tally:Tally",
    "Waveforms": "api.studies.run:Waveforms",
    "Workspace": "api.workspace:Workspace",
    "open": "api.workspace:open_workspace",
    "results": "api.studies.results:results",
}


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(f"module 'dse' has no attribute '{name}'")
    module, _, attribute = _PLACES[name].partition(":")
    value = globals()[name] = getattr(import_module(f"dse.{module}"), attribute)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
