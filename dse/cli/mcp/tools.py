"""What an assistant may ask: plain functions of plain data, each of which is a tool of `server`.

Every answer that has numbers has their units, and those about runs have their number, verdicts, margins and error bars.
Names and folders that lie outside of the workspace are refused. A tool reads the files anew each time it is called.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, cast

from dse.api import Results, choice_lines, listing, open as open_workspace, ranking_as_data
from dse.cli.diagnostics import Checked, as_data
from dse.cli.spaces import constraint_data, tally_data
from dse.cli.terminal import plain_data
from dse.errors import fail
from dse.places import OUT
from dse.units import short_symbol

if TYPE_CHECKING:
    from dse.api import Design, Progress, Run, Workspace

Data = dict[str, Any]

_MOST_CONFIGURATIONS, _MOST_DESIGNS, _MOST_FINDINGS, _MOST_PROBLEMS = 50, 50, 200, 100
_MOST_POINTS, _MOST_SIGNALS = 500, 20
_MOST_LETTERS = 10_000


class Tools:
    """Questions about the workspace around *root*. At most *budget* runs may be simulated, all together."""

    def __init__(self, root: Path, budget: int = 0) -> None:
        self.workspace = open_workspace(root).root.resolve()
        self.left = budget
        self._count = threading.Lock()

    def contents(self) -> Data:
        """List the design spaces, test benches, studies, ratings, procedures and study folders of the workspace.

        Start here. `results` are the folders that the tools about results take.
        """
        found = listing(self._open().files)
        named = {
            kind: [
                {"name": each.name, "title": each.title, **each.facts}
                | ({"problem": each.problem} if each.problem else {})
                for each in listed
            ]
            for kind, listed in found.files.items()
        }
        folders = [{**asdict(each), "folder": self._shown(each.folder)} for each in found.results]
        return _plain({**named, "results": folders, "runs_left": self.left})

    def check(self) -> Data:
        """Check all files of the workspace; each problem has its file, line, message and hint."""
        problems = self._open().check()
        return {**_plain(as_data(Checked(problems[:_MOST_PROBLEMS]))), "number": len(problems)}

    def count(self, design: str, where: str = "", choose: dict[str, str] | None = None) -> Data:
        """Count the valid configurations of a design space.

        `where` is a condition in the constraint language, such as `sum(cost) <= 6000 EUR`; `choose` fixes alternatives
        by place, such as {"sensor": "radar"}. `exact` is false where the count is an estimate: then `low` and `high`
        are the ends of its 95 % interval.
        """
        space = self._design(design)
        found = space.count(**_narrowing(where, choose))
        counted = {"valid": found, "exact": True} if isinstance(found, int) else tally_data(found)
        return _plain({"design": space.name, "combinations": space.total, **counted})

    def alternatives(self, design: str) -> Data:
        """Show a design space: the alternatives at each place, and its constraints with their reasons."""
        from dse.space import alternatives

        noun = self._design(design).space
        places = {path: [name or "absent" for name in names] for path, names in alternatives(noun).items()}
        return _plain({"places": places, "constraints": [constraint_data(each) for each in noun.constraints]})

    def best_configurations(
        self,
        design: str,
        minimize: str = "",
        maximize: str = "",
        where: str = "",
        choose: dict[str, str] | None = None,
        number: int = 5,
    ) -> Data:
        """Find the best valid configurations of a design space under one objective, such as minimize `sum(cost)`.

        Exact: no other configuration is better. Nothing is simulated: requirements are not looked at.
        """
        found = self._design(design).best(
            _text(minimize) or None,
            maximize=_text(maximize) or None,
            n=_within("number", number, 1, _MOST_CONFIGURATIONS),
            **_narrowing(where, choose),
        )
        units = {str(aim): str(unit) for aim, unit in zip(found.aims, found.units, strict=True)}
        entries = [
            {"id": each.id, "choices": each.choices, "values": values}
            for each, values in zip(found, found.shown(), strict=True)
        ]
        return _plain({"configurations": entries, "units": units})

    def explain(self, design: str, choose: dict[str, str]) -> Data:
        """Explain whether choices are valid together: which constraints prevent it, and the nearest valid choices."""
        if not choose:
            raise fail("no choice is given", hint='name choices by place, such as {"sensor": "radar"}')
        found = self._design(design).explain(choose)
        if not found.is_whole:
            conflict = [constraint_data(each) for each in found.conflict]
            return _plain({"valid": found.is_valid, "first": found.choices, "conflict": conflict})
        broken = [
            {**constraint_data(each.constraint), "seen": {seen.what: seen.value for seen in each.seen}}
            for each in found.broken
        ]
        nearest = found.nearest and {
            "id": found.nearest.id,
            "changes": [asdict(change) for change in found.nearest.changes],
        }
        return _plain({"id": found.id, "valid": not broken, "broken": broken, "nearest": nearest})

    def summary(self, folder: str) -> Data:
        """Summarize a study: its variables, requirements, counts of verdicts, and which design to take and why.

        `doubtful` counts verdicts that more draws or finer numerics may change.
        """
        results = self._results(folder)
        definition, summary = results.definition, results.summary
        choice = results.choice()
        told: Data = {}
        if choice is not None:
            name, lines = choice_lines(choice, definition)
            told = {"design": name, "run": choice.run, **{label: text for label, text in lines if label != "misses"}}
            told["misses"] = [text for label, text in lines if label == "misses"]
        variables = [
            {
                "name": each.name,
                "title": each.title,
                "unit": short_symbol(each.unit),
                "role": str(each.role),
            }
            for each in definition.variables
        ]
        requirements = [
            {
                "name": each.name,
                "title": each.title,
                "metric": each.metric,
                "unit": short_symbol(each.unit),
                "at_least": each.at_least,
                "at_most": each.at_most,
                "verdicts": summary.verdicts.get(each.name, {}),
                "doubtful": summary.doubtful.get(each.name, {}),
            }
            for each in definition.requirements
        ]
        return _plain(
            {
                "folder": self._shown(results.folder),
                "study": definition.study,
                "title": definition.title,
                "runs": summary.runs,
                "finished": summary.finished,
                "failed_to_run": sorted(summary.failures)[:_MOST_PROBLEMS],
                "checked": summary.checked,
                "configurations": len(definition.configurations),
                "variables": variables,
                "requirements": requirements,
                "metrics": [
                    {"name": e.name, "title": e.title, "unit": short_symbol(e.unit)} for e in definition.metrics
                ],
                "which_design": told,
            }
        )

    def best(
        self, folder: str, number: int = 5, minimize: list[str] | None = None, maximize: list[str] | None = None
    ) -> Data:
        """Rank the designs of a study that meet all requirements in all conditions, with their margins and runs.

        Objectives are metrics or `sum(PROPERTY)`, such as `sum(cost)`; the default is those of the study, else the
        least margin. `better` are designs that would win but miss a requirement. `doubtful` names requirements whose
        verdicts are not certain.
        """
        results = self._results(folder)
        several = _within("number", number, 1, _MOST_DESIGNS)
        found = results.best(several, minimize=_texts(minimize), maximize=_texts(maximize))
        chosen = {each.configuration for each in (*found.best, *found.better)}
        choices = {name: results.definition.configuration(name).choices for name in chosen}
        return _plain({**ranking_as_data(found, results.definition), "choices": choices})

    def findings(self, folder: str) -> Data:
        """Tell what the runs of a study show, in sentences with their numbers, and which findings are withheld."""
        found = self._results(folder).findings()
        return _plain({"findings": [asdict(each) for each in found[:_MOST_FINDINGS]], "number": len(found)})

    def run(self, folder: str, number: int, signals: list[str] | None = None, points: int = 50) -> Data:
        """Show one run of a study: choices, point, metrics, verdicts, margins, error bars; and waveforms.

        `signals` names the waveforms; each has at most `points` values, evenly spaced, in SI.
        """
        return self._run_data(self._results(folder).run(_within("number", number, 0, 2**53)), signals, points)

    def picture(self, folder: str, x: str = "", y: str = "", run: int | None = None) -> bytes:
        """Draw the constraint plot of a study over the design variables `x` and `y`; with `run` the waveforms of a run.

        A PNG. Without `x` and `y` the first plot of the study.
        """
        from dse.report import View, drawings, read_content, save_drawing

        if bool(x) != bool(y):
            raise fail("'x' and 'y' belong together", hint="give both, or neither")
        content = read_content(self._folder(folder))
        view = View(_text(x) or None, _text(y) or None, "", run)
        name = "constraints" if run is None else "waveforms"
        for _, sheet in drawings(name, content, view):
            with TemporaryDirectory() as scratch:
                target = Path(scratch) / "picture.png"
                save_drawing(sheet, target)
                return target.read_bytes()
        raise fail(f"there is nothing to draw of {self._shown(self._folder(folder))}")

    def plan(self, study: str) -> Data:
        """Tell how many runs `explore` would simulate for a study, and how many are there or in the cache already."""
        name, noun = self._study(study)
        found = noun.plan(self._open().root / OUT / name)
        return {"study": name, "runs": found.runs, "to_simulate": found.missing, "seconds": found.seconds}

    def explore(self, study: str, tell: Callable[[Progress], None] | None = None) -> Data:
        """Simulate the missing runs of a study into `out/STUDY`, and summarize it. Uses the budget of runs."""
        name, noun = self._study(study)
        folder = self._open().root / OUT / name
        found = noun.plan(folder)
        if found.open_ended:
            what = f"how many runs the sampler of '{name}' asks for depends on their results"
            raise fail(what, hint=f"a person starts it: dse explore {name}")
        self._spend(found.missing + found.again)
        noun.explore(folder, progress=tell)
        return self.summary(name)

    def simulate(
        self,
        bench: str,
        configuration: str = "",
        values: dict[str, str] | None = None,
        signals: list[str] | None = None,
        points: int = 50,
    ) -> Data:
        """Simulate one configuration on a test bench, with its waveforms and error bars. Uses one run of the budget.

        `configuration` is an id or its first characters; the default is the first valid one. `values` changes
        parameters, such as {"controller.kp_speed": "1.2 1/s"}.
        """
        self._inside(bench)
        noun = self._open().benches[bench]
        self._spend(1)
        run = noun.simulate(
            _text(configuration) or None, {name: _text(v) for name, v in (values or {}).items()}, check_step=True
        )
        return self._run_data(run, signals, points)

    def _run_data(self, run: Run, signals: list[str] | None, points: int) -> Data:
        wanted = _texts(signals)[:_MOST_SIGNALS]
        data = {**run.as_data(), "choices": run.choices, "problem": run.problem}
        data["certainty"] = {name: str(word) for name, word in run.check.certainties.items()}
        data["error_bars"] = {
            name: {"value": bar, "unit": run.units.get(name, "")} for name, bar in run.check.errors.items()
        }
        data["waveforms_of"] = [*run.waveforms] if run.has_waveforms else []
        if wanted:
            waves = run.waveforms
            if unknown := [name for name in wanted if name not in waves]:
                raise fail(
                    f"run {run.number} has no waveform '{unknown[0]}'", hint=f"it has {', '.join(waves) or 'none'}"
                )
            step = -(-len(waves.time) // _within("points", points, 2, _MOST_POINTS))
            data["time"] = waves.time[::step].tolist()
            data["waveforms"] = {
                name: {"unit": run.units.get(name, ""), "values": waves[name][::step].tolist()} for name in wanted
            }
        return _plain(data)

    def _spend(self, runs: int) -> None:
        with self._count:
            if runs > self.left:
                what = f"{runs:,} runs would be simulated, and {self.left:,} are left of the budget"
                raise fail(what, hint="a person starts the server with a larger one: dse mcp --runs N")
            self.left -= runs

    def _open(self) -> Workspace:
        return open_workspace(self.workspace)

    def _design(self, name: str) -> Design:
        self._inside(name)
        return self._open().designs[name]

    def _study(self, name: str) -> tuple[str, Any]:
        self._inside(name)
        found = self._open().studies[name]
        return found.name, found

    def _results(self, folder: str) -> Results:
        return Results(self._folder(folder))

    def _folder(self, folder: str) -> Path:
        """A folder in the workspace, or the name of one in ``out/``."""
        path = self._inside(folder)
        return path if path.is_dir() else self.workspace / OUT / path.relative_to(self.workspace)

    def _inside(self, name: str) -> Path:
        """The path that *name* would be. Raises DseError if that is outside of the workspace."""
        text = _text(name)
        try:
            path = (self.workspace / text).resolve()
        except (OSError, ValueError, RuntimeError):
            path = self.workspace.parent
        if not text or "\0" in text or not path.is_relative_to(self.workspace):
            raise fail(f"'{text[:80]}' is not in the workspace", hint="the tool 'contents' lists what is")
        return path

    def _shown(self, folder: Path) -> str:
        return folder.resolve().relative_to(self.workspace).as_posix()


def _narrowing(where: str, choose: Mapping[str, str] | None) -> Any:
    return {"choose": choose or {}, "where": _text(where)} if where else {"choose": choose or {}}


def _text(value: str) -> str:
    if len(value) > _MOST_LETTERS:
        raise fail(f"a text of {len(value):,} characters is too long", hint=f"at most {_MOST_LETTERS:,}")
    return value


def _texts(values: Iterable[str] | None) -> list[str]:
    return [_text(each) for each in values or ()]


def _within(name: str, value: int, low: int, high: int) -> int:
    if not low <= value <= high:
        raise fail(f"'{name}' is {value}", hint=f"from {low} to {high:,}")
    return value


def _plain(data: Mapping[str, Any]) -> Data:
    return cast("Data", plain_data(data))
