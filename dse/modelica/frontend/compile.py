"""Modelica sources to the front-end's flat system, with every failure told in the user's words."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from dse.errors import DseError, Problem, fail, raise_if_any
from dse.modelica.frontend.buses import REFUSED, with_members
from dse.modelica.frontend.jumps import OPEN_LOOP, without_open_loops
from dse.modelica.frontend.literal import WRAPPER, is_class_name, wrapper
from dse.modelica.frontend.messages import found_problems, refusal
from dse.modelica.frontend.misreadings import misread
from dse.modelica.frontend.other_words import ELEMENTS, OF_EXPRESSION, with_equations, with_variables
from dse.modelica.frontend.process import FrontEnd, FrontEndDied, FrontEndRefusal
from dse.modelica.frontend.redeclarations import NOT_TAKEN, with_redeclarations
from dse.modelica.frontend.result import SCHEMA, FrontEndResult
from dse.modelica.frontend.source_text import SourceText, declarations
from dse.modelica.frontend.sources import FILES, LIBRARIES, ModelSources, libraries
from dse.scratch import ScratchFolder

_BASE, _TRIAL = "base", "trial"
_WRAPPER_FILE = "dse_wrapper.mo"
_Way = tuple[tuple[str, ...], Callable[[Mapping[str, bytes]], dict[str, bytes]]]


def compile_model(sources: ModelSources) -> FrontEndResult:
    """The flat system of the model; ``structural`` of the result is empty.

    Raises DseError: the front-end refuses the model, crashes, takes too long, or is one whose output is not known.
    """

    def compiled(others: ModelSources) -> FrontEndResult:
        with opened(others) as session:
            return session.compiled({})

    return in_other_words(sources, compiled)


def in_other_words(sources: ModelSources, compiled: Callable[[ModelSources], FrontEndResult]) -> FrontEndResult:
    """What *compiled* makes of *sources*, in other words where these are refused. Raises DseError."""
    ways: list[_Way] = [*_OTHER_WORDS, (NOT_TAKEN, partial(with_redeclarations, sources.model))]
    while True:
        try:
            return compiled(sources)
        except DseError as refusal:
            said = " ".join(problem.what for problem in refusal.problems)
            found = next((way for way in ways if any(each in said for each in way[0])), None)
            if found is None:
                raise
        ways.remove(found)
        files = found[1]({**sources.parts, **sources.contents})
        contents = {name: files[name] for name in sources.contents}
        parts = {name: text for name, text in files.items() if name not in contents}
        sources = replace(sources, contents=contents, parts=parts)


_OTHER_WORDS: tuple[_Way, ...] = (
    ((ELEMENTS,), partial(with_equations, least=2)),  # first only signals with more than one such connection
    ((ELEMENTS,), partial(with_equations, least=1)),
    (REFUSED, with_members),
    ((OF_EXPRESSION,), with_variables),
    ((OPEN_LOOP,), without_open_loops),
)
"""What a refusal says, and how the sources are written for another try."""


@dataclass(frozen=True, slots=True)
class Session:
    """A front-end that has the sources before it."""

    sources: ModelSources
    front_end: FrontEnd
    folder: Path

    def compiled(self, changes: Mapping[str, str]) -> FrontEndResult:
        """The flat system of the model with the parameters in *changes* given as Modelica texts. Raises DseError."""
        try:
            result = read_answer(self.sources, self._flattened(_BASE, changes))
        except FrontEndDied as error:
            what = f"component '{self.sources.component}': {self.sources.model}: the Modelica front-end {error}"
            raise fail(what, self.sources.where) from error
        except FrontEndRefusal as error:
            raise DseError(*self._problems(str(error))) from error
        raise_if_any(misread(result))
        return result

    def trial(self, overlay: Mapping[str, bytes], changes: Mapping[str, str]) -> dict[str, Any]:
        """The front-end's answer with the contents *overlay* in place of some files.

        Raises FrontEndDied and FrontEndRefusal.
        """
        self.sources.lay_out(self.folder / _TRIAL, overlay)
        return self._flattened(_TRIAL, changes)

    def _flattened(self, folder: str, changes: Mapping[str, str]) -> dict[str, Any]:
        text = wrapper(self.sources.model, changes, libraries(self.sources))
        request = {"wrapper": text, "model": WRAPPER, "filename": _WRAPPER_FILE}
        return self.front_end.ask({**request, "folder": str(self.folder / folder)})

    def _problems(self, message: str) -> list[Problem]:
        files = [f"{FILES}/{name}" for name in sorted(self.sources.contents) if name.endswith(".mo")]
        found: list[Any] = []
        with contextlib.suppress(FrontEndDied, FrontEndRefusal):  # the refusal itself is told
            found = self.front_end.ask({"check": files, "folder": str(self.folder / _BASE)})["found"]
        return found_problems(self.sources, found) or [refusal(self.sources, message)]


def read_answer(
    sources: ModelSources, answer: Mapping[str, Any], structural: frozenset[str] = frozenset()
) -> FrontEndResult:
    """What the front-end says of *sources*. Raises DseError for an answer in another layout."""
    dae, flat = answer.get("dae"), answer.get("flat")
    schema = dae.get("schema_version") if isinstance(dae, dict) else None
    if not isinstance(dae, dict) or not isinstance(flat, dict) or schema != SCHEMA:
        what = f"component '{sources.component}': the Modelica front-end writes layout {schema}, not {SCHEMA}"
        raise fail(what, sources.where, "install the version of rumoca that dse asks for")
    texts = {
        number: SourceText(sources.spelled(path), text)
        for number, path, text in dae["source_map"]["files"]
        if path != _WRAPPER_FILE
    }
    described = [description for _, description in declarations(texts.values(), sources.model)]
    description = described[0] if len(described) == 1 else ""
    return FrontEndResult(sources.model, dae, flat, texts, structural, description)


@contextlib.contextmanager
def opened(sources: ModelSources) -> Iterator[Session]:
    """A front-end with the sources before it, for as long as the block lasts. Raises DseError for impossible names."""
    if not is_class_name(sources.model):
        what = f"component '{sources.component}': '{sources.model}' is not a name of a Modelica class"
        raise fail(what, sources.where, "model: Package.Model")
    with ScratchFolder() as scratch:
        folder = Path(scratch).resolve()
        cache = folder / "cache"
        cache.mkdir()
        with FrontEnd(folder, (FILES, f"../{LIBRARIES}"), cache) as front_end:
            sources.lay_out_parts(folder)
            sources.lay_out(folder / _BASE)
            yield Session(sources, front_end, folder)
