"""A folder that Simulink's coder has written: its files, and which of them is the model."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from dse.errors import Location, fail
from dse.formats import shown

_CODE = (".c", ".cpp", ".h", ".hpp")
_HEADERS = (".h", ".hpp")
_MOST_BYTES = 50_000_000
_MOST_FILES = 5000
_HEAD = 3000
"""Characters at the beginning of a file in which the coder says what it is."""

_MADE_FOR = re.compile(
    r"Code generat(?:ed|ion) for (?:Simulink )?model:? ?['\":](\w+)"
    r"|Real-Time Workshop code generat\w+ for Simulink model \"?(\w+)"
)
_MAIN = re.compile(
    r"(?:(?:ert|grt|rt|classic)_)?main\.(?:c|cpp)|rt_(?:matrx|logging)\w*\.c|\w+_(?:sf|msf|capi_host)\.c"
)
_STEPS = re.compile(r"\b(?:\w+_)?step\d*\s*\(")


@dataclass(frozen=True, slots=True)
class CoderFolder:
    """*texts* are the files of C and C++ by name; *model* is the model's name, which its files bear.

    *further* are those elsewhere that belong to it, by a path of their own: of models that it refers to and what they
    share, as ``slprj/ert/child/child.c``, and of the user's, as ``sources/0/drive.c``. *places* are the folders that
    these paths begin with.
    """

    path: Path
    texts: Mapping[str, str]
    model: str
    further: Mapping[str, str] = field(default_factory=dict)
    places: Mapping[str, Path] = field(default_factory=dict)

    @property
    def header(self) -> str:
        """The name of the model's header."""
        return next(name for name in self._named(_HEADERS) if name in self.texts)

    @property
    def source(self) -> str:
        """The name of the file with its step."""
        return next(name for name in self._named((".c", ".cpp")) if name in self.texts)

    @property
    def is_cpp(self) -> bool:
        """Whether it is C++."""
        return self.source.endswith(".cpp")

    @property
    def units(self) -> tuple[str, ...]:
        """What is compiled: all but programs of their own and what only MATLAB uses."""
        every = (name for name in (*self.texts, *self.further) if not name.endswith(_HEADERS))
        alike: dict[tuple[str, str], str] = {}  # copies of one file, in several folders, are one
        for name in every:
            last = name.rpartition("/")[2]
            if not _MAIN.fullmatch(last):
                alike.setdefault((last, self.text(name)), name)
        return tuple(alike.values())

    def text(self, name: str) -> str:
        """Of one of the files, by its name or path."""
        return self.texts[name] if name in self.texts else self.further[name]

    def file(self, name: str) -> Path:
        """Where a file is on the disk, by its name or path."""
        place, _, last = name.rpartition("/")
        return (self.places[place] if place else self.path) / last

    @property
    def headers(self) -> tuple[str, ...]:
        """The model's header and the one for its own code, if there is one."""
        return self.header, *(name for name in (f"{self.model}_private.h",) if name in self.texts)

    @property
    def code(self) -> str:
        """The texts of all code that was generated for the model: a driver beside it may write what the model reads."""
        made = (text for name, text in self.texts.items() if name in self.units and _MADE_FOR.search(text[:_HEAD]))
        return "\n".join([self.texts[self.source], *made])

    @property
    def own_text(self) -> str:
        """The texts of all files that bear the model's name."""
        return "\n".join(text for name, text in self.texts.items() if name.startswith(self.model))

    @property
    def parameters_of_main(self) -> Iterator[str]:
        """The texts of programs beside the model, which may hold its default values."""
        return (text for name, text in self.texts.items() if re.fullmatch(r"\w*main\.(c|cpp)", name))

    @property
    def main(self) -> str:
        """The text of the programs that run the model."""
        return "\n".join(text for text in self.parameters_of_main if f'"{self.header}"' in text)

    def _named(self, suffixes: tuple[str, ...]) -> Iterator[str]:
        return (self.model + suffix for suffix in suffixes)


def read_folder(path: Path, model: str = "", sources: Sequence[Path] = ()) -> CoderFolder:
    """The folder at *path* with the *model* of this name, or with the one there is.

    *sources* are further files and folders that the user gives. Raises DseError.
    """
    where = Location(shown(path))
    if not path.is_dir():
        raise fail("this is a file, not a folder" if path.exists() else "there is no such folder", where)
    if not _is_text(str(path.absolute())):
        raise fail("the name of this folder is not UTF-8", where, "rename it")
    texts = _texts(sorted(path.iterdir()), where)
    chosen = model or _model_of(texts, where)
    if not re.fullmatch(r"[A-Za-z_]\w*", chosen, re.ASCII):
        raise fail(f"'{chosen}' is not a name that Simulink gives a model", where)
    if not any(chosen + suffix in texts for suffix in _HEADERS):
        raise fail(f"there is no header '{chosen}.h'", where, _names(texts))
    if not any(chosen + suffix in texts for suffix in (".c", ".cpp")):
        raise fail(f"there is no source '{chosen}.c' or '{chosen}.cpp'", where, "the folder is not whole")
    places = {**dict(_referred(path, texts, where)), **dict(_given(sources))}
    further = {
        f"{name}/{file}": text
        for name, place in places.items()
        for file, text in _texts(sorted(_files_at(place)), where).items()
    }
    return CoderFolder(path, texts, chosen, further, {name: _folder_of(place) for name, place in places.items()})


def _referred(path: Path, texts: Mapping[str, str], where: Location) -> Iterator[tuple[str, Path]]:
    """The folders of the models that it refers to and of what all share, below ``slprj`` within or beside it."""
    target = re.fullmatch(r"\w+?_((?:ert|grt|rsim|autosar)\w*?)(?:_rtw)?", path.absolute().name)
    for parent in (path / "slprj", path.absolute().parent / "slprj"):
        kinds = [
            each
            for each in sorted(parent.glob("*"))
            if each.is_dir() and each.name[0] not in "_." and each.name != "sim"
        ]
        named = [each for each in kinds if target and each.name == target[1]] or (kinds if len(kinds) == 1 else [])
        if not named:
            continue
        (kind,) = named
        shared = kind / "_sharedutils"
        found = {f"slprj/{kind.name}/_sharedutils": shared} if shared.is_dir() else {}
        waiting = list(texts.values())
        while waiting:
            for header in re.findall(r'#\s*include "(\w+)\.h"', waiting.pop()):
                child, name = kind / header, f"slprj/{kind.name}/{header}"
                if name not in found and (child / f"{header}.h").is_file():
                    found[name] = child
                    waiting += _texts(sorted(child.iterdir()), where).values()
        yield from found.items()
        return


def _given(sources: Sequence[Path]) -> Iterator[tuple[str, Path]]:
    for number, source in enumerate(sources):
        if not source.exists():
            raise fail("there is no such file or folder", Location(shown(source)), "see the key 'sources'")
        yield f"sources/{number}", source


def _files_at(place: Path) -> Iterator[Path]:
    return place.iterdir() if place.is_dir() else iter([place])


def _folder_of(place: Path) -> Path:
    return place if place.is_dir() else place.parent


def _texts(files: Iterable[Path], where: Location) -> dict[str, str]:
    texts: dict[str, str] = {}
    size = 0
    for file in files:
        if file.suffix not in _CODE or not file.is_file():
            continue
        if not _is_text(file.name):
            raise fail("the name of this file is not UTF-8", Location(shown(file)), "rename it")
        size += file.stat().st_size
        if size > _MOST_BYTES or len(texts) == _MOST_FILES:
            raise fail(f"there are more than {_MOST_FILES} files or {_MOST_BYTES // 1_000_000} MB of C", where)
        try:
            texts[file.name] = file.read_bytes().decode("utf-8", "replace")
        except OSError as error:
            raise fail(f"cannot be read: {error.strerror}", Location(shown(file))) from error
    return texts


def _model_of(texts: Mapping[str, str], where: Location) -> str:
    """The model whose header tells a step. Raises DseError if there is none, or several as likely."""
    found = {name: score for name, score in _candidates(texts) if score > 0}
    best = [name for name, score in found.items() if score == max(found.values())]
    if not best:
        # Whoever took its comments and guards away left its functions.
        headers = [(file.rpartition(".")[0], text) for file, text in texts.items() if file.endswith(_HEADERS)]
        begun = [name for name, text in headers if f"{name}_initialize(void)" in text and f"{name}.c" in texts]
        hint = f"if it is {begun[0]}: --model {begun[0]}, or 'model: {begun[0]}' in component.yaml" if begun else ""
        raise fail("no model that Simulink's coder wrote is in this folder", where, hint or _names(texts))
    if len(best) > 1:
        raise fail(f"there are several models: {', '.join(best)}", where, f"model: {best[0]}")
    return best[0]


def _candidates(texts: Mapping[str, str]) -> Iterator[tuple[str, int]]:
    for file, text in texts.items():
        name, _, suffix = file.rpartition(".")
        if f".{suffix}" not in _HEADERS or not {f"{name}.c", f"{name}.cpp"} & texts.keys():
            continue
        made = _MADE_FOR.search(text[:_HEAD])
        # Without comments, its guard is what is left of the coder.
        if made is None and f"RTW_HEADER_{name}_h_" not in text:
            continue
        is_whole = made is not None and (made[1] or made[2]) == name
        is_used = any(
            f'"{file}"' in other for each, other in texts.items() if re.match(r"(?:ert|grt|rt)_main|rtmodel\.h", each)
        )
        has_steps = _STEPS.search(text) is not None
        yield name, (2 * is_whole + 4 * is_used + 1) if has_steps or is_used else 0


def _names(texts: Mapping[str, str]) -> str:
    headers = [name for name in texts if name.endswith(_HEADERS)]
    return f"its headers are {', '.join(headers[:6])}" if headers else "it holds no C at all"


def _is_text(name: str) -> bool:
    """Whether the system's bytes for a name are what Python takes them for."""
    return not any("\ud800" <= letter <= "\udfff" for letter in name)
