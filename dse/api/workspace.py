"""A workspace: its components, design spaces, test benches and studies by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from dse.api.authoring.defined import Definitions
from dse.api.lookup import space_of
from dse.api.presentation.html import table
from dse.api.spaces.design import Design
from dse.api.studies.bench import Bench, Study
from dse.loading import Workspace as Files
from dse.places import NO_BENCHES, STUDY

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dse.domain.component import Component
    from dse.errors import Problem


def open(path: str | Path = ".") -> Workspace:  # noqa: A001  # dse.open(".") reads as it should
    """The workspace that contains *path*: the nearest folder upwards with ``components/``.

    Nothing is read before it is needed. Raises DseError if there is none.
    """
    return Workspace(Files.around(Path(path)))


class Workspace:
    """The files of a product family: *components*, *designs*, *benches* and *studies* are mappings by name.

    A name may also be the path of a file, as on the command line. An unknown name is a DseError. *files* reads them,
    *definitions* also has what was defined in Python.

    >>> ws = dse.open(".")
    >>> ws.designs["acc_vehicle"].count()
    227
    """

    def __init__(self, files: Files | Definitions) -> None:
        self.definitions = files if isinstance(files, Definitions) else Definitions(files)
        here = self.definitions
        self.components: Named[Component] = Named(
            "components", here, lambda files: files.component_files, Files.component
        )
        self.designs = Named("designs", here, _designs, lambda files, name: _design(files, name, here))
        self.benches = Named("benches", here, _benches, lambda files, name: Bench.of(files.bench(name), here))
        self.studies = Named("studies", here, _studies, lambda files, name: Study.of(files.study(name), here))

    @staticmethod
    def new(folder: str | Path | None = None) -> Workspace:
        """A copy of the example workspace, to define things in: in a new or empty *folder*, which is kept, or by
        default in a temporary one, which is removed with this. Raises DseError."""
        return Workspace(Definitions.new(folder))

    @property
    def files(self) -> Files:
        """What reads its files."""
        return self.definitions.files

    @property
    def root(self) -> Path:
        """The folder with ``components/``, ``designs/`` and ``testbenches/``."""
        return self.files.root

    def check(self) -> tuple[Problem, ...]:
        """All errors in the current files; empty if there are none. See ``dse check``."""
        from dse.testbench import check_workspace

        return tuple(check_workspace(Files(self.root))[0])

    def __repr__(self) -> str:
        return f"<Workspace {self.root}: {', '.join(f'{len(named)} {what}' for what, named in self._kinds())}>"

    def _repr_html_(self) -> str:
        return table(f"Workspace {self.root}", (), [(what, ", ".join(named)) for what, named in self._kinds()])

    def _kinds(self) -> Iterable[tuple[str, list[str]]]:
        yield "components", list(self.components)
        yield "designs", list(self.designs)
        yield "benches", list(self.benches)
        yield "studies", list(self.studies)


# What a workspace has of one kind, by name.


def _designs(files: Files) -> Iterable[str]:
    return [path.stem for path in files.files("designs")]


def _design(files: Files, name: str, definitions: Definitions) -> Design:
    is_yaml = Path(name).suffix.lower() != ".uvl"
    return Design.of(space_of(name, workspace=files), definitions if is_yaml else None)


def _benches(files: Files) -> Iterable[str]:
    return [path.stem for path in files.files("testbenches") if not path.name.endswith(NO_BENCHES)]


def _studies(files: Files) -> Iterable[str]:
    found = (path.name for path in files.files("testbenches"))
    return [name.removesuffix(STUDY) for name in found if name.endswith(STUDY)]


T = TypeVar("T")


class Named(Mapping[str, T]):
    """Things by name, each read when it is first asked for. An unknown name is a DseError that hints at the nearest."""

    def __init__(
        self,
        what: str,
        definitions: Definitions,
        names: Callable[[Files], Iterable[str]],
        read: Callable[[Files, str], T],
    ) -> None:
        self._what = what
        self._definitions = definitions
        self._list = names
        self._read = read
        self._known: dict[str, T] = {}
        self._files = definitions.files

    def __getitem__(self, name: str) -> T:
        if self._files is not self._definitions.files:  # something was defined
            self._files, self._known = self._definitions.files, {}
        if name not in self._known:
            self._known[name] = self._read(self._files, name)
        return self._known[name]

    def _names(self) -> Iterable[str]:
        return self._list(self._definitions.files)

    def __contains__(self, name: object) -> bool:
        return name in set(self._names())

    def get(self, name: str, default: Any = None) -> Any:
        """What is called *name*, *default* if there is none. Raises DseError if it is there and cannot be read."""
        return self[name] if name in self else default  # noqa: SIM401  # this is get

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._names()))

    def __len__(self) -> int:
        return len(set(self._names()))

    def __repr__(self) -> str:
        return f"<{self._what}: {', '.join(self) or 'none'}>"

    def _repr_html_(self) -> str:
        return table(self._what, (), [[name] for name in self])
