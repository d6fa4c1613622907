"""Which test files a change can reach: those from which imports lead to a room that changed (``pytest --rooms``).

    dse/storage/lock.py changed, and with it the room dse.storage
    dse.report.content.reading imports dse.storage, so dse.report is affected
    tests/report/conftest.py imports dse.report, and all test files of its folder use it
    tests/report/test_page.py is selected
    tests/space/test_tally.py is not: nothing it imports leads to dse.storage

``--rooms base`` selects less, the tests of the rooms that changed, and adds a fifth of the others by turns.

The graph is grimp's: the modules of dse, with the Python files of tests/ added. Three kinds of imports that grimp does
not see are added, too. A name taken from a room is followed through the room's ``__init__.pyi`` to the module that
defines it: by whole rooms, a change of dse.modelica would reach all tests of dse.space, which takes one function from
dse.loading, another part of which finds component kinds. A string that is the name of a module is an import
(registries, workers). C code imports the rooms whose headers it includes.

Tests are read as text, as another process may import what is in a string, and a name too many only selects a test too
many. A test that runs the command line reaches every room. Making the graph takes about a second.
"""

from __future__ import annotations

import re
import subprocess
from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import accumulate
from pathlib import Path
from typing import Any
from zlib import crc32

import pytest
from grimp import ImportGraph, build_graph

_TURNS = 5
_FROM = re.compile(r"^[ \t]*from ([\w.]+) import (\((?:[^)#]|#.*)*\)|.*)", re.MULTILINE)
_IMPORT = re.compile(r"^[ \t]*import ([\w.]+)", re.MULTILINE)
_STRING = re.compile(r"(dse(?:\.\w+)+)[\"']")
_MENTION = re.compile(r"dse(?:\.\w+)+")
_SCRIPT = re.compile(r"[\"'/](\w+)\.py[\"']")
_SLASH = re.compile(r"(?<=\w)(?:[\"'] / [\"']|/)(?=\w)")  # "dse" / "fmu/runtime"
_INCLUDE = re.compile(r'^#include "(\w+)/', re.MULTILINE)
_COMMAND_LINE = ("command_line", "dse.cli", "dse.__main__", '"-m", "dse"', '["dse"', '== "dse"', '/ "dse"')
# All tests use these files, but few use what they import of dse: those that import it themselves, or import the file.
_FRAME = ("tests/conftest.py", "tests/affected.py", "tests/compile_cache.py")
# What these folders contain is also read by tests that do not name them.
_CONTENT = frozenset(("components", "designs", "examples", "roads", "schemas", "testbenches"))
_READS_CONTENT = r"\bWorkspace\b|\brun_dse\b|\bdse\.open\b|\bparents\["
# Only tests that name these read them, and those of the documentation.
_TEXTS = frozenset(("benchmarks", "clients", "docs", ".ci", ".github"))


class Reach:
    """What the tests in the folder *root* reach; *modules* is the import graph of dse, to which they are added.

    Files are named by their paths in *root*.
    """

    def __init__(self, root: Path, modules: ImportGraph) -> None:
        self.root = root
        self._graph = modules
        self._modules = set(modules.modules)
        self.rooms = sorted(module.removeprefix("dse.") for module in modules.find_children("dse"))
        self._faces = dict(self._names_in_faces())
        files = sorted((root / "tests").rglob("*.py"))
        self._tests = {file.relative_to(root).as_posix(): file.read_text("utf-8") for file in files}
        self.files = frozenset(path for path in self._tests if Path(path).name.startswith("test_"))
        self._add_modules()
        self._add_tests()

    def select(self, changed: Iterable[str]) -> tuple[list[str], frozenset[str]]:
        """The rooms and the test files that reach one of the files *changed*; ``dse/cosim`` is all of a room."""
        affected: set[str] = set()
        for seed in {seed for path in changed for seed in self._seeds(path)}:
            inside = {seed} if seed in self._tests else {seed, *self._graph.find_descendants(seed)}
            affected |= inside | self._graph.find_downstream_modules(seed, as_package=len(inside) > 1)
        rooms = {name.split(".")[1] for name in affected if name.startswith("dse.")}
        return sorted(rooms), self.files & affected

    def near(self, changed: Iterable[str]) -> frozenset[str]:
        """The test files of what *changed* itself: its room's own, or those that use a file of tests or of content.

        Those of rooms that import a changed one are not among them, unless that has no tests of its own.
        """
        found: set[str] = set()
        for seed in {seed for path in changed for seed in self._seeds(path)}:
            room = seed.removeprefix("dse.")
            own = {path for path in self.files if path.startswith((f"tests/{room}/", f"tests/test_{room}.py"))}
            if seed in self._tests:
                own = {seed, *self._graph.find_downstream_modules(seed)}
            found |= own or self.select([f"dse/{room}"])[1]
        return self.files & found

    def _seeds(self, path: str) -> Iterable[str]:
        """The nodes of the graph that a change of *path* changes."""
        top, _, rest = path.partition("/")
        name = Path(path).name
        if top == "dse":
            room = rest.partition("/")[0].partition(".")[0]
            return (f"dse.{room}" if room in self.rooms else "dse",)
        if path in self._tests:
            return (path,)
        if top == "tests":  # what tests read, or a file that is gone
            words = rf"\b{re.escape(Path(path).stem)}\b|[\"'/]{re.escape(Path(path).parent.name)}[\"'/]"
            return self._naming(words, folder="/".join(path.split("/")[:2]))
        named = rf"[\"'/]{re.escape(top)}[\"'/]"
        if rest and top in _CONTENT:
            return self._naming(f"{named}|{_READS_CONTENT}")
        if (rest and top in _TEXTS) or name.endswith((".cff", ".md", ".yaml")) or path == "house.toml":
            return self._naming(f"{named}|{re.escape(name)}", folder="tests/docs")
        return ("dse", *self._tests)

    def _naming(self, pattern: str, folder: str = "nowhere") -> list[str]:
        others = {path: text for path, text in self._tests.items() if path not in _FRAME}
        return [path for path, text in others.items() if path.startswith(f"{folder}/") or re.search(pattern, text)]

    def _names_in_faces(self) -> Iterator[tuple[str, str]]:
        for face in (self.root / "dse").rglob("__init__.pyi"):
            room = ".".join(face.relative_to(self.root).parent.parts)
            for name in _imported(face.read_text("utf-8")):
                yield f"{room}.{name.rpartition('.')[2]}", room + name

    def _add_modules(self) -> None:
        for module in self._modules:
            self._link(f"all of {module}", [module, *self._graph.find_descendants(module)])
            file = self.root.joinpath(*module.split("."))
            file = file / "__init__.py" if file.is_dir() else file.with_suffix(".py")
            text = file.read_text("utf-8") if file.is_file() else ""
            self._link(module, [module.rpartition(".")[0], *self._homes([*_imported(text), *_STRING.findall(text)])])
        for file in (self.root / "dse").rglob("*.[ch]"):
            room = f"dse.{file.relative_to(self.root).parts[1]}"
            for other in set(_INCLUDE.findall(file.read_text("utf-8"))) & set(self.rooms):
                for module in (room, *self._graph.find_descendants(room)):
                    self._link(module, [f"all of dse.{other}"])

    def _add_tests(self) -> None:
        called: dict[str, set[str]] = defaultdict(set)  # by every end of its dotted name, as sys.path has many folders
        for path in self._tests:
            words = path.removesuffix(".py").removesuffix("/__init__").split("/")
            for start in range(1, len(words)):
                called[".".join(words[start:])].add(path)
        del called["conftest"]  # which is imported from where it is
        for path, text in self._tests.items():
            names = _imported(text)
            for name in (*names, *_SCRIPT.findall(text)):
                for beginning in accumulate(name.split("."), "{}.{}".format):
                    self._link(path, called.get(beginning, ()))
            above = {f"{folder.as_posix()}/conftest.py" for folder in Path(path).parents}
            self._link(path, above & self._tests.keys())
            if path not in _FRAME:
                frame = (self._tests.get(file, "") for file in _FRAME if Path(file).stem in names)
                dotted = _SLASH.sub(".", "".join((text, *frame)))
                self._link(path, self._homes([*_imported(dotted), *_MENTION.findall(_FROM.sub("", dotted))]))
                if any(sign in dotted for sign in _COMMAND_LINE):
                    self._link(path, ["all of dse"])

    def _homes(self, names: Iterable[str]) -> Iterator[str]:
        """The modules that define *names* of dse, or all of the package where that is not known."""
        for name in set(names):
            home = name
            while home in self._faces:
                home = self._faces[home]
            while home and home not in self._modules:
                home = home.rpartition(".")[0]
            if home:
                yield home if home == "dse" else f"all of {home}"

    def _link(self, importer: str, imported: Iterable[str]) -> None:
        for name in imported:
            if name and name != importer:
                self._graph.add_import(importer=importer, imported=name)


def _imported(text: str) -> list[str]:
    """Every name that *text* imports, dotted; of modules only in ``import a.b``."""
    names = _IMPORT.findall(text)
    for module, several in _FROM.findall(text):
        words = (one.split() for one in re.sub(r"#.*|[()\\]", "", several).split(","))
        names += (f"{module}.{word[0]}" for word in words if word)
    return names


def dse_graph() -> ImportGraph:
    """The imports between the modules of dse, those for type checkers among them."""
    return build_graph("dse", cache_dir=None)


def changed_files(root: Path, starts: Iterable[str] = ("origin/main", "main", "HEAD~1")) -> tuple[list[str], str]:
    """The files, untracked ones too, that differ from where this branch left main, and the name of that commit."""
    for start in starts:
        if base := _git(root, "merge-base", "HEAD", start):
            changed = _git(root, "diff", "--name-only", "--no-renames", "-z", base[0].strip())
            return [*changed, *_git(root, "ls-files", "--others", "--exclude-standard", "-z")], start
    return ["everything"], "no commit that git can compare with"


def selected(reach: Reach, which: str) -> tuple[str, frozenset[str]]:
    """What ``--rooms`` *which* selects: a line about it, and the test files. Raises pytest.UsageError."""
    if which == "changed":
        changed, since = changed_files(reach.root)
        named = ", ".join(changed[:3]) + (f" and {len(changed) - 3} more" if len(changed) > 3 else "")
        reason = f"{named or 'no change'} since {since}"
    elif which == "base":
        return _base(reach)
    else:
        unknown = sorted({*which.split(",")} - {*reach.rooms})
        if unknown:
            there_are = ", ".join(["changed", "base", *reach.rooms])
            raise pytest.UsageError(f"--rooms: there is no room {', '.join(unknown)}; there are {there_are}")
        changed, reason = [f"dse/{room}" for room in which.split(",")], which
    rooms, files = reach.select(changed)
    named = "all" if rooms == reach.rooms else ", ".join(rooms) or "none"
    return f"rooms: {named} (from {reason}); {len(files)} of {len(reach.files)} test files", files


def _base(reach: Reach) -> tuple[str, frozenset[str]]:
    """After the whole run that ``.ci/base`` names: the tests of what changed since, and a fifth of the others."""
    file = reach.root / ".ci" / "base"
    base = file.read_text("utf-8").split() if file.is_file() else []
    changed, since = changed_files(reach.root, base)
    if since not in base:
        return f"all test files, as {since}", reach.files
    turn = int(_git(reach.root, "rev-list", "--count", "HEAD")[0]) % _TURNS
    near = reach.near({*changed} - {".ci/base"})
    others = {path for path in reach.files - near if crc32(path.encode()) % _TURNS == turn}
    line = f"{len(near)} test files of what changed since {since[:8]}, {len(others)} of the others (fifth {turn + 1})"
    return f"{line}; {len(near | others)} of {len(reach.files)}", near | others


class ByRooms:
    """pytest's part: test files that *which* leaves out are not imported, and a line says what is selected."""

    def __init__(self, config: pytest.Config, which: str) -> None:
        self._root = config.rootpath
        of_controller = getattr(config, "workerinput", {}).get("rooms")
        self._line, files = of_controller or selected(Reach(self._root, dse_graph()), which)
        self._files = frozenset(files)

    @pytest.hookimpl(optionalhook=True)
    def pytest_configure_node(self, node: Any) -> None:
        node.workerinput["rooms"] = self._line, sorted(self._files)

    def pytest_sessionstart(self, session: pytest.Session) -> None:
        reporter = session.config.pluginmanager.get_plugin("terminalreporter")
        if reporter:  # a report header would not be shown with -q
            reporter.write_line(self._line)

    def pytest_ignore_collect(self, collection_path: Path) -> bool | None:
        if not collection_path.name.startswith("test_") or collection_path.suffix != ".py":
            return None
        return collection_path.relative_to(self._root).as_posix() not in self._files or None

    def pytest_sessionfinish(self, session: pytest.Session, exitstatus: int) -> None:
        if exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED:  # a change that no test can reach is no failure
            session.exitstatus = pytest.ExitCode.OK


def _git(root: Path, *words: str) -> list[str]:
    """What git prints, split at zero bytes; nothing if it fails."""
    try:
        done = subprocess.run(["git", *words], cwd=root, capture_output=True, encoding="utf-8", check=False)
    except FileNotFoundError:
        return []
    return [part for part in done.stdout.split("\0") if part] if done.returncode == 0 else []
