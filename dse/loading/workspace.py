"""A workspace: the folder that holds ``components/``, ``designs/``, ``roads/`` and ``testbenches/``."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.component import Component, Interface
from dse.errors import DseError, Location, Problems, closest, fail, raise_if_any
from dse.formats import Entry, remember, shown
from dse.loading.component.component import read_collection, read_component
from dse.loading.component.interfaces import read_interfaces, read_own_units, read_stand_ins, read_types
from dse.loading.include import read_document
from dse.loading.paths import find_root
from dse.places import NO_BENCHES, PROCEDURE, RATING, STUDY
from dse.units import OwnUnits, own_units

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.design import DesignSpace
    from dse.domain.road import Road
    from dse.domain.study import Study
    from dse.loading.bench.procedure import Procedure
    from dse.loading.bench.rating import Rating

_FOLDERS = ("components", "designs", "testbenches")


class Workspace:
    """Finds and reads files by the names they use for each other; each file is read once.

    A component's folder, a design's and a bench's file are named after it, so that only what is needed is read;
    of components, those in files with many are always read.
    """

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        self._components: dict[str, Component] = {}
        self._designs: dict[Path, DesignSpace] = {}
        self._benches: dict[Path, TestBench] = {}

    @staticmethod
    def around(path: Path) -> Workspace:
        """The workspace that contains *path*: the nearest folder upwards with ``components/``.

        Raises DseError, also if there is nothing at *path*.
        """
        if not path.exists():
            raise fail("no such file or folder", Location(shown(path)), "check the spelling and the folder you are in")
        root = find_root(path)
        if root is not None:
            remember(root)
            return Workspace(root)
        raise fail(
            "not in a workspace: no folder 'components' here or above",
            Location(shown(path)),
            "'dse init DIR' lays out a working example",
        )

    @cached_property
    def units(self) -> OwnUnits:
        """The units that its ``interfaces.yaml`` files define. Raises DseError."""
        with own_units({}):
            return read_own_units(self._components_yaml.get("interfaces.yaml", []), self.root)

    @cached_property
    def interfaces(self) -> dict[str, Interface]:
        """Every interface of the workspace, by name."""
        found: dict[str, Interface] = {}
        problems = Problems()
        paths = self._components_yaml.get("interfaces.yaml", [])
        with own_units(self.units):
            types = read_types(paths, self.root)
            for path in paths:
                with problems:
                    for name, interface in read_interfaces(path, self.root, types).items():
                        if name in found:
                            hint = f"see {found[name].where}"
                            problems.add(f"interface '{name}' is defined twice", interface.where, hint)
                        found.setdefault(name, interface)
        raise_if_any(problems)
        return found

    @cached_property
    def stand_ins(self) -> dict[str, Entry]:
        """Where interfaces say what their components stand for in designs, by their names."""
        paths = self._components_yaml.get("interfaces.yaml", [])
        return {name: entry for path in paths for name, entry in read_stand_ins(path, self.root).items()}

    @cached_property
    def component_files(self) -> dict[str, Path]:
        """The file of every component by its name: a ``component.yaml`` by that of its folder, or one with many."""
        found: dict[str, Path] = {}
        problems = Problems()
        for path in self._components_yaml.get("component.yaml", []):
            name = path.parent.name
            if name in found:
                hint = f"see {shown(found[name])}"
                problems.add(f"component '{name}' is defined twice", Location(shown(path)), hint)
            found.setdefault(name, path)
        for component, path in self._collected:
            if component.name in found:
                hint = f"see {shown(found[component.name])}"
                problems.add(f"component '{component.name}' is defined twice", component.where, hint)
            found.setdefault(component.name, path)
        raise_if_any(problems)
        return found

    @cached_property
    def _collected(self) -> list[tuple[Component, Path]]:
        """The components of files with many, each with its file."""
        found: list[tuple[Component, Path]] = []
        problems = Problems()
        for path in self._components_yaml.get("", []):
            with problems, own_units(self.units):
                found += [(component, path) for component in read_collection(path, self.interfaces, self.root)]
        raise_if_any(problems)
        return found

    def component(self, name: str, where: Location | None = None) -> Component:
        """The component called *name*. Raises DseError, at *where* if there is none."""
        if name not in self._components:
            path = self.component_files.get(name)
            if path is None:
                raise fail(f"unknown component '{name}'", where, closest(name, self.component_files))
            if path.name != "component.yaml":
                self._components |= {component.name: component for component, _ in self._collected}
                return self._components[name]
            with own_units(self.units):
                component = read_component(path, self.interfaces, self.root)
            if component.name != name:
                raise fail(
                    f"component '{component.name}' is in a folder called '{name}'",
                    component.where,
                    "name the folder after the component, so that it is found",
                )
            self._components[name] = component
        return self._components[name]

    def design(self, name: str, where: Location | None = None) -> DesignSpace:
        """The design space called *name*, or in the file *name*. Raises DseError."""
        path = self._file(name, "designs", ".yaml", where)
        if path not in self._designs:
            from dse.loading.design.design import read_design

            with own_units(self.units):
                design = read_design(path, self.component, self.interfaces, self.stand_ins, self.root)
            _require_name(design.name, path, ".yaml", design.where)
            self._designs[path] = design
        return self._designs[path]

    def bench(self, name: str, where: Location | None = None) -> TestBench:
        """The test bench called *name*, or in the file *name*. Raises DseError."""
        path = self._file(name, "testbenches", ".yaml", where)
        if path not in self._benches:
            from dse.loading.bench.bench import read_bench

            with own_units(self._units_of(path, "design", self.design)):
                bench = read_bench(path, self.component, self.design, self.root)
            _require_name(bench.name, path, ".yaml", bench.where)
            self._benches[path] = bench
        return self._benches[path]

    def study(self, name: str, where: Location | None = None) -> Study:
        """The study called *name*, or in the file *name*. Raises DseError."""
        from dse.loading.bench.study import read_study

        path = self._file(name, "testbenches", STUDY, where)
        with own_units(self._units_of(path, "testbench", lambda name, where: self.bench(name, where).design)):
            study = read_study(path, self.bench, self.root)
        _require_name(study.name, path, STUDY, study.where)
        return study

    def rating(self, name: str, where: Location | None = None) -> Rating:
        """The rating called *name*, or in the file *name*. Raises DseError."""
        from dse.loading.bench.rating import read_rating

        path = self._file(name, "testbenches", RATING, where)
        with own_units(self.units):
            rating = read_rating(path, self.bench, self.root)
        _require_name(rating.name, path, RATING, rating.where)
        return rating

    def procedure(self, name: str, where: Location | None = None) -> Procedure:
        """The test procedure called *name*, or in the file *name*. Raises DseError."""
        from dse.loading.bench.procedure import read_procedure

        path = self._file(name, "testbenches", PROCEDURE, where)
        with own_units(self.units):
            procedure = read_procedure(path, self.bench, self.root)
        _require_name(procedure.name, path, PROCEDURE, procedure.where)
        return procedure

    def road(self, name: str, where: Location | None = None) -> Road:
        """The road called *name*, or in the file *name*. Raises DseError."""
        from dse.loading.road.road import read_road

        path = self._file(name, "roads", ".yaml", where)
        road = read_road(path, self.root)
        _require_name(road.name, path, ".yaml", road.where)
        return road

    def files(self, folder: str) -> Iterator[Path]:
        """The YAML files of a folder of the workspace; a name that starts with ``_`` is only for including."""
        for path in _yaml_below(self.root / folder):
            if not path.name.startswith("_"):
                yield path

    @cached_property
    def _components_yaml(self) -> dict[str, list[Path]]:
        """The files below ``components/``: by their name, where it says what they hold, else by ""."""
        found: dict[str, list[Path]] = {}
        for path in self.files("components"):
            name = path.name
            found.setdefault(name if name in ("component.yaml", "interfaces.yaml") else "", []).append(path)
        return found

    def _units_of(self, path: Path, key: str, find: Callable[[str, Location], DesignSpace]) -> OwnUnits:
        """What the file at *path* may use: also the units of the design that *find* finds by what *key* names."""
        found = dict(self.units)
        with suppress(DseError):  # who reads the file tells of it
            named = read_document(path, self.root)[key]
            names = named.data if named.is_there else None
            for name in names if isinstance(names, list) else [names]:
                if isinstance(name, str):
                    found |= find(name, named.where).units
        return found

    def _file(self, name: str, folder: str, suffix: str, where: Location | None) -> Path:
        typed = Path(name)
        # Only who types a command may give a path: a file names others by what they define.
        if where is None and (typed.suffix in (".yaml", ".yml") or typed.is_dir() or len(typed.parts) > 1):
            return typed.resolve()
        found: dict[str, Path] = {}
        for path in self.files(folder):
            stem = path.name.removesuffix(suffix)
            if _suffix(path) != suffix:
                continue
            if stem in found:
                what = f"two files are called '{path.name}'"
                raise fail(what, Location(shown(path)), f"the other is {shown(found[stem])}; rename one")
            found[stem] = path
        if name not in found:
            wanted = next(kind for kind in _KINDS if (kind.folder, kind.suffix) == (folder, suffix))
            other = self.kind_of(name)
            if other is not None and where is None:
                hint = f"{other.command} {name} {other.does}"
                raise fail(f"'{name}' is a {other.name}, not a {wanted.name}", where, hint)
            raise fail(f"unknown {wanted.name} '{name}'", where, closest(name, found) or f"there is none in {folder}/")
        return found[name]

    def kind_of(self, name: str) -> FileKind | None:
        """What kind of file is called *name*; None if there is no such file."""
        for kind in _KINDS:
            for path in self.files(kind.folder):
                if path.name == f"{name}{kind.suffix}" and _suffix(path) == kind.suffix:
                    return kind
        return None


@dataclass(frozen=True, slots=True)
class FileKind:
    """Files in *folder* whose names end in *suffix*; *command* *does* something with one."""

    name: str
    folder: str
    suffix: str
    command: str
    does: str


STUDY_FILE = FileKind("study", "testbenches", STUDY, "dse explore", "simulates it")
BENCH_FILE = FileKind("test bench", "testbenches", ".yaml", "dse run", "simulates it")
_KINDS = (
    STUDY_FILE,
    BENCH_FILE,
    FileKind("rating", "testbenches", RATING, "dse rate DESIGN --rating", "predicts its points"),
    FileKind("procedure", "testbenches", PROCEDURE, "dse verify", "checks it"),
    FileKind("design space", "designs", ".yaml", "dse enumerate", "lists its configurations"),
    FileKind("road", "roads", ".yaml", "dse figure", "draws it"),
)


def _suffix(path: Path) -> str:
    return next((suffix for suffix in NO_BENCHES if path.name.endswith(suffix)), ".yaml")


def _yaml_below(folder: Path | str) -> Iterator[Path]:
    """What is called ``*.yaml`` in *folder* and below, sorted; links to folders are not followed.

    As ``sorted(folder.rglob("*.yaml"))``, which takes five times as long where there are thousands.
    """
    try:
        with os.scandir(folder) as entries:
            found = sorted(entries, key=lambda entry: os.path.normcase(entry.name))
    except (FileNotFoundError, NotADirectoryError):
        return
    for entry in found:
        if entry.name.endswith(".yaml"):
            yield Path(entry.path)
        if entry.is_dir(follow_symlinks=False):
            yield from _yaml_below(entry.path)


def _require_name(name: str, path: Path, suffix: str, where: Location | None) -> None:
    """Raise DseError unless the file is called after what it defines: others find it by that name."""
    if path.name.removesuffix(suffix) != name:
        raise fail(f"'{name}' is defined in a file called '{path.name}'", where, f"call the file {name}{suffix}")
