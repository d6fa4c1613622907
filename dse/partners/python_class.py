"""The process that does the work of a component in Python: ``python -m dse.partners.python_class FOLDER``.

FOLDER has the component's files and `ABOUT`. They are imported once; each run makes an instance of the class in a fork
of this process. So every run begins with the same state, also of modules, and whoever crashes takes nobody along.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import traceback
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn

from dse.partners.line import END, START, Line, Question, how_ended, open_line

ABOUT = "about.json"
"""Names the *file*, the *class*, and its *parameters*, *inputs* and *outputs*: lists of a name, a kind and items."""

Item = tuple[str, str, list[str]]


class _WrongOutputError(Exception):
    """What step returned is not what the component's interface says."""


class _Component:
    """The user's class, of which a run makes one object, and how its values are written as numbers."""

    def __init__(self, folder: Path) -> None:
        about = json.loads((folder / ABOUT).read_text("utf-8"))
        self._parameters: list[Item] = about["parameters"]
        self._inputs: list[Item] = about["inputs"]
        self._outputs: list[Item] = about["outputs"]
        sys.path.insert(0, str(folder))
        module = importlib.import_module(Path(about["file"]).stem)
        self._class: Callable[[Mapping[str, Any]], Any] = getattr(module, about["class"])
        self._object: Any = None
        self._numbers: tuple[float, ...] | None = None
        self._values: dict[str, Any] = {}

    def step(self, numbers: tuple[float, ...]) -> list[float]:
        """The outputs after a step; *numbers* are its length, the parameters and the inputs."""
        first = 1 + len(self._parameters)
        if self._numbers != numbers[1:first]:
            self._numbers = numbers[1:first]
            self._values.update(_named(self._parameters, self._numbers))
        if self._object is None:
            self._object = self._class(self._values)
        found = self._object.step(_named(self._inputs, numbers[first:]), numbers[0])
        if not isinstance(found, Mapping):
            raise _WrongOutputError(f"step returned {type(found).__name__}, not a dict of outputs by name")
        names = [name for name, _, _ in self._outputs]
        missing = [name for name in names if name not in found]
        odd = [str(name) for name in found if name not in names]
        if missing or odd:
            told = [f"lacks {', '.join(missing)}"] * bool(missing) + [f"has {', '.join(odd)}, no outputs"] * bool(odd)
            raise _WrongOutputError(f"what step returned {' and '.join(told)}")
        return [_number(name, kind, items, found[name]) for name, kind, items in self._outputs]


def _named(items: Iterable[Item], numbers: Iterable[float]) -> dict[str, Any]:
    return {name: _value(kind, words, number) for (name, kind, words), number in zip(items, numbers, strict=True)}


def _value(kind: str, words: list[str], number: float) -> Any:
    match kind:
        case "real":
            return number
        case "bool":
            return number != 0
        case "int":
            return int(number)
        case _:
            return words[int(number)]


def _number(name: str, kind: str, words: list[str], value: Any) -> float:
    if kind == "enum":
        if value not in words:
            raise _WrongOutputError(f"'{name}' is {value!r}, none of {', '.join(words)}")
        return float(words.index(value))
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise _WrongOutputError(f"'{name}' is {value!r}, not a number") from None
    if kind == "int" and not (number.is_integer() and abs(number) < 2**31):
        raise _WrongOutputError(f"'{name}' is {value!r}, not a whole number of 32 bits")
    if kind == "bool" and number not in (0, 1):
        raise _WrongOutputError(f"'{name}' is {value!r}, neither True nor False")
    return number


def _serve(line: Line, component: _Component, folder: Path) -> None:
    question = line.question()
    while question:
        if question[0] == START:
            child = os.fork()
            if not child:
                _run(line, component, question, folder)
            told = how_ended(child, "the process of the class")
            if told:
                line.refuse(told)
        question = line.question()


def _run(line: Line, component: _Component, question: Question | None, folder: Path) -> NoReturn:
    while question and question[0] != END:
        try:
            values = component.step(question[1])
        except BaseException as error:  # noqa: BLE001  # whatever it is, it is told
            line.refuse(_error_text(error, folder))
            break
        line.answer(values)
        question = line.question()
    sys.stdout.flush()
    os._exit(0)


def _error_text(error: BaseException, folder: Path) -> str:
    """What went wrong, and the last line of the component's files that led there."""
    if isinstance(error, _WrongOutputError):
        return str(error)
    own = [each for each in traceback.extract_tb(error.__traceback__) if Path(each.filename).parent == folder]
    where = f"{Path(own[-1].filename).name}:{own[-1].lineno}: " if own else ""
    return f"{where}{type(error).__name__}: {error}"


def main() -> None:
    """Import the class, and answer until nobody asks any more."""
    line, folder = open_line(), Path(sys.argv[1])
    sys.dont_write_bytecode = True  # the folder is an FMU in the cache
    try:
        component = _Component(folder)
    except BaseException as error:  # noqa: BLE001  # whatever it is, it is told
        line.question()
        line.refuse(_error_text(error, folder))
        return
    _serve(line, component, folder)


if __name__ == "__main__":
    main()
