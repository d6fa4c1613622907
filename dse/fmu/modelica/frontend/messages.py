"""The front-end's messages as problems at places in the user's files."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from dse.errors import Location, Problem
from dse.fmu.modelica.frontend.sources import ModelSources, SourceText
from dse.fmu.modelica.frontend.text import declarations, found

_AT = re.compile(r"\s*\[(?P<file>[^\[\]]+?):(?P<line>\d+):(?P<column>\d+)\]")
_QUOTED = re.compile(r"['`\"]([A-Za-z_][\w.]*)['`\"]")


def found_problems(sources: ModelSources, folder: str, entries: Iterable[Any]) -> list[Problem]:
    """What the front-end says about single files, as lists of path, message, line, column and suggestion."""
    problems = []
    for path, message, line, column, suggestion in entries:
        lines = [text.strip() for text in str(message).splitlines() if text.strip()]
        what = next((text.lstrip("×x ").strip() for text in lines if text.startswith("×")), lines[0] if lines else "")
        helped = re.search(r"help: (.*(?:\n {6,}.*)*)", str(message))
        hint = " ".join(helped[1].split()) if helped else str(suggestion or "")
        drawn = re.search(r"╭─\[(.+):(\d+):(\d+)\]", str(message))
        place = (int(drawn[2]), int(drawn[3])) if drawn else (int(line or 0), int(column or 0))
        problems.append(Problem(what, Location(_spelled(sources, folder, str(path)), *place), hint))
    return problems


def refusal(sources: ModelSources, folder: str, message: str, wrapper: str) -> Problem:
    """One problem of a message about the whole model, where it says or, failing that, at the model."""
    first = message.split("\nRelated failures", maxsplit=1)[0].strip()
    where = None
    if match := _AT.search(first):
        first = (first[: match.start()] + first[match.end() :]).strip()
        if folder in match["file"] or sources.origins:
            spelled = _spelled(sources, folder, match["file"])
            is_own = wrapper.lower() not in spelled.lower().replace("_", "")
            where = Location(spelled, int(match["line"]), int(match["column"])) if is_own else None
    either = f"(?:{re.escape(wrapper)}|{re.escape(sources.model)})"
    first = re.sub(rf"^\w[\w ]* failed: {either} failed in \w+: |^{either} could not be compiled:? ?", "", first)
    first = re.sub(rf"\b{re.escape(wrapper)}\b", sources.model, first)
    located = where or _mentioned(sources, first) or model_location(sources)
    hint = ""
    if located is None:
        hint = "the model's full name, and a file or library that holds it, stand in 'source'"
    first, hint = _in_other_words(sources.model, first, hint)
    return Problem(f"component '{sources.component}': {sources.model}: {first}", located or sources.where, hint)


_REWORDED = (
    (r"base class not found: `{model}` does not exist", "no file or library holds this model", ""),
    (r"because resolve/parse failed", "the front-end sees no model in it", ""),
    (r"model '{model}' cannot extend (\w+) '{model}'.*", r"it is a \1, not a model", "name a model or block"),
    (r"missing source scope for imports:?", "the first result of a function is left out", "give it a variable"),
)


def _in_other_words(model: str, message: str, hint: str) -> tuple[str, str]:
    """Messages that say little, or speak of the wrapper, as what they mean here."""
    for pattern, words, other_hint in _REWORDED:
        match = re.match(pattern.replace("{model}", re.escape(model)), message)
        if match:
            return match.expand(words), other_hint or hint
    return message, hint


def model_location(sources: ModelSources) -> Location | None:
    """Where the model is declared, if one of the component's own files does."""
    places = declarations(_texts(sources), sources.model)
    return places[0].where if places else None


def _mentioned(sources: ModelSources, message: str) -> Location | None:
    """Where the only name the message quotes stands, if it stands in one place."""
    for name in _QUOTED.findall(message):
        if name == sources.model:
            continue
        pattern = re.compile(rf"(?<![\w.])({re.escape(name)})(?![\w])")
        places = [where for _, _, where in found(_texts(sources), pattern)]
        if len(places) == 1:
            return places[0]
    return None


def _texts(sources: ModelSources) -> list[SourceText]:
    return [
        SourceText(sources.origins[relative], content.decode("utf-8", "replace"))
        for relative, content in sources.contents.items()
    ]


def _spelled(sources: ModelSources, folder: str, path: str) -> str:
    relative = path.replace("\\", "/").removeprefix(f"{folder}/")
    return sources.origins.get(relative, path)
