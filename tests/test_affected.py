"""Which test files a change selects, on invented trees and on this repository."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable
from pathlib import Path

import pytest
from affected import Reach, changed_files, dse_graph, selected
from grimp import ImportGraph

ROOT = Path(__file__).parents[1]

TREE = {
    "dse/low/__init__.pyi": "from .deep import LOW as LOW\nfrom .other import OTHER as OTHER\n",
    "dse/low/deep.py": "LOW = 1\n",
    "dse/low/other.py": 'OTHER = Registry("dse.kinds")\n',
    "dse/high.py": "from dse.low import (\n    LOW,  # not OTHER :)\n)\n",
    "dse/kinds/modelica.py": "",
    "dse/kernel/master.c": '#include "solver/step.h"\n',
    "dse/solver/step.h": "",
    "tests/conftest.py": "import launcher\n",
    "tests/launcher.py": "",
    "tests/told/conftest.py": "import dse.high\n",
    "tests/told/test_by_conftest.py": "",
    "tests/told/cases/one.txt": "",
    "tests/fakes.py": "from dse.high import HIGH\n",
    "tests/far/test_by_helper.py": "from fakes import fake\n",
    "tests/far/test_other.py": "from dse.low import OTHER\n",
    "tests/far/test_in_a_string.py": 'run("from dse.high import HIGH")\n',
    "tests/far/test_kernel.py": 'SOURCES = ROOT / "dse" / "kernel"\n',
    "tests/far/test_component.py": 'Workspace(ROOT).component("brake")\n',
    "tests/far/test_command.py": 'line = [sys.executable, "-m", "dse", "check"]\n',
    "tests/far/test_cases.py": 'CASES = Path("tests/told/cases")\n',
    "tests/docs/test_pages.py": "",
}
MODULES = ("dse", "dse.low", "dse.low.deep", "dse.low.other", "dse.high", "dse.kinds", "dse.kinds.modelica")
ALL = {path.rpartition("test_")[2].removesuffix(".py") for path in TREE if "/test_" in path}


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    for path, text in TREE.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")
    return tmp_path


def reach_of(tree: Path) -> Reach:
    modules = ImportGraph()
    for module in (*MODULES, "dse.kernel", "dse.solver"):
        modules.add_module(module)
    return Reach(tree, modules)


def names(paths: Iterable[str]) -> set[str]:
    return {Path(path).stem.removeprefix("test_") for path in paths}


def chosen(tree: Path, *changed: str) -> set[str]:
    return names(reach_of(tree).select(changed)[1])


@pytest.mark.parametrize(
    ("changed", "tests"),
    [
        ("dse/high.py", {"by_conftest", "by_helper", "in_a_string", "command"}),
        ("dse/low/data.json", {"by_conftest", "by_helper", "in_a_string", "command", "other"}),
        ("dse/kinds/modelica.py", {"other", "command"}),
        ("dse/solver/step.h", {"kernel", "command"}),
        ("dse/__init__.py", ALL - {"component", "cases", "pages"}),
        ("tests/fakes.py", {"by_helper"}),
        ("tests/told/conftest.py", {"by_conftest"}),
        ("tests/far/test_other.py", {"other"}),
        ("tests/told/cases/one.txt", {"by_conftest", "cases"}),
        ("tests/launcher.py", ALL),
        ("tests/conftest.py", ALL),
        ("pyproject.toml", ALL),
        ("a/new/folder", ALL),
        ("components/brake/brake.c", {"component"}),
        ("docs/tutorial.md", {"pages"}),
    ],
)
def test_a_change_selects_the_tests_from_which_imports_lead_to_it(tree, changed, tests):
    assert chosen(tree, changed) == tests


def test_several_changes_select_what_each_of_them_does(tree):
    assert chosen(tree, "docs/tutorial.md", "tests/fakes.py") == {"pages", "by_helper"}
    assert not chosen(tree)


@pytest.mark.parametrize(
    ("changed", "tests"),
    [
        ("dse/kernel/master.c", {"kernel", "command"}),  # it has no tests of its own
        ("dse/high.py", {"of_high"}),
        ("tests/fakes.py", {"by_helper", "of_high"}),
        ("tests/far/test_other.py", {"other"}),
        ("components/brake/brake.c", {"component"}),
        ("house.toml", {"pages"}),
        ("pyproject.toml", ALL | {"of_high"}),
    ],
)
def test_near_are_the_tests_of_a_room_that_changed_not_of_those_that_import_it(tree, changed, tests):
    (tree / "tests/high").mkdir()
    (tree / "tests/high/test_of_high.py").write_text("import dse.high\nimport fakes\n", encoding="utf-8")
    assert names(reach_of(tree).near([changed])) == tests


def git(folder: Path, *words: str) -> None:
    identity = ("-c", "user.name=T", "-c", "user.email=t@example.org", "-c", "init.defaultBranch=main")
    subprocess.run(["git", *identity, *words], cwd=folder, check=True, capture_output=True)


def test_what_git_says_differs_from_main_has_changed(tmp_path):
    (tmp_path / "ä b.py").touch()
    git(tmp_path, "init")
    assert changed_files(tmp_path) == (["everything"], "no commit that git can compare with")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-m", "first")
    git(tmp_path, "checkout", "-b", "topic")
    git(tmp_path, "mv", "ä b.py", "c.py")
    git(tmp_path, "commit", "-m", "second")
    (tmp_path / "new.py").touch()
    assert changed_files(tmp_path) == (["c.py", "ä b.py", "new.py"], "main")
    git(tmp_path, "branch", "-D", "main")
    assert changed_files(tmp_path)[1] == "HEAD~1"


def test_after_a_whole_run_what_changed_since_is_tested_and_all_else_within_five_commits(tree):
    everything = {f"tests/far/test_{number}.py" for number in range(60)} | {*reach_of(tree).files}
    for path in everything - {*TREE}:
        (tree / path).write_text("import dse.low\n", encoding="utf-8")
    assert selected(reach_of(tree), "base") == ("all test files, as no commit that git can compare with", everything)
    git(tree, "init")
    git(tree, "add", ".")
    git(tree, "commit", "-m", "whole")
    (tree / ".ci").mkdir()
    commit = subprocess.run(["git", "rev-parse", "HEAD"], cwd=tree, check=True, capture_output=True, text=True).stdout
    (tree / ".ci/base").write_text(commit, encoding="utf-8")
    (tree / "tests/fakes.py").write_text("import dse.high", encoding="utf-8")
    runs = []
    for number in range(5):
        git(tree, "commit", "--allow-empty", "-m", str(number))
        line, files = selected(reach_of(tree), "base")
        assert line.startswith(f"1 test files of what changed since {commit[:8]}, "), line
        assert "tests/far/test_by_helper.py" in files
        runs.append(files)
    assert frozenset().union(*runs) == everything
    assert sum(map(len, runs)) == len(everything) + 4
    (tree / ".ci/base").write_text("0" * 40, encoding="utf-8")
    assert selected(reach_of(tree), "base")[1] == everything


@pytest.fixture(scope="module")
def here() -> Reach:
    return Reach(ROOT, dse_graph())


def test_a_change_of_the_modelica_compiler_leaves_the_tests_of_design_spaces_out(here):
    rooms, files = here.select(["dse/modelica/translate.py"])
    of = {
        folder: {path for path in here.files if path.startswith(f"tests/{folder}/")} for folder in ("modelica", "space")
    }
    assert of["modelica"] <= files
    assert {path for path in here.files if path.startswith("tests/cli/")} & files
    assert {"kinds", "modelica", "cli"} <= {*rooms}
    assert "space" not in rooms
    # Those that read components of this repository can come by one in Modelica.
    reading = {path for path in of["space"] if "Workspace" in (ROOT / path).read_text("utf-8")}
    assert of["space"] & files <= reading | {"tests/space/test_tally.py"}


def test_a_change_of_the_errors_selects_all_but_a_few_tests(here):
    rooms, files = here.select(["dse/errors.py"])
    assert {*here.rooms} - {*rooms} <= {
        "csolve",
        "graphs",
        "json_data",
        "partners",
        "places",
        "plain_messages",
        "processes",
    }
    assert len(files) > 0.97 * len(here.files)


def test_every_room_is_reached_by_its_tests_and_the_command_line(here):
    for room in here.rooms:
        files = here.select([f"dse/{room}"])[1]
        assert "tests/cli/test_commands.py" in files, room
        folder = {path for path in here.files if path.startswith(f"tests/{room}/")}
        assert folder & files or not folder, room


def test_an_unknown_room_is_refused_with_those_there_are(here):
    with pytest.raises(pytest.UsageError, match=r"no room kosim; there are changed, base, .*cosim, csolve"):
        selected(here, "cosim,kosim")


def test_a_line_says_which_rooms_are_affected_and_why(here):
    line, files = selected(here, "serving")
    assert line == f"rooms: __main__, cli, serving (from serving); {len(files)} of {len(here.files)} test files"
