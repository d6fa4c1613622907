"""The front-end's messages as problems at places in the user's files."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from dse.errors import Location, Problem
from dse.modelica.frontend.literal import WRAPPER
from dse.modelica.frontend.source_text import SourceText, code, declarations, found
from dse.modelica.frontend.sources import FILES, ModelSources, libraries

_AT = re.compile(r"\s*\[(?P<file>[^\[\]]+?):(?P<line>\d+):(?P<column>\d+)\]")
_QUOTED = re.compile(r"['`\"]([A-Za-z_][\w.]*)['`\"]")


def found_problems(sources: ModelSources, entries: Iterable[Any]) -> list[Problem]:
    """What the front-end says about single files, as lists of path, message, line, column and suggestion."""
    problems = []
    for path, message, line, column, suggestion in entries:
        lines = [text.strip() for text in str(message).splitlines() if text.strip()]
        what = next((text.lstrip("×x ").strip() for text in lines if text.startswith("×")), lines[0] if lines else "")
        helped = re.search(r"help: (.*(?:\n {6,}.*)*)", str(message))
        hint = " ".join(helped[1].split()) if helped else ""
        # The front-end gives names to signs.
        hint = re.sub(rf"\b({'|'.join(_SIGNS)})\b", lambda match: _SIGNS[match[0]], hint) or str(suggestion or "")
        drawn = re.search(r"╭─\[(.+):(\d+):(\d+)\]", str(message))
        place = (int(drawn[2]), int(drawn[3])) if drawn else (int(line or 0), int(column or 0))
        problems.append(Problem(what, Location(sources.spelled(str(path)), *place), hint))
    return problems


# fmt: off
_SIGNS = {
    "dotstar": ".*", "dotplus": ".+", "dotminus": ".-", "dotslash": "./", "dotcircumflex": ".^", "circumflex": "^",
    "lt": "<", "ltequ": "<=", "gt": ">", "gtequ": ">=", "equequ": "==", "ltgt": "<>",
}
# fmt: on


def refusal(sources: ModelSources, message: str) -> Problem:
    """One problem of a message about the whole model, where it says or, failing that, at the model."""
    first = _most_telling(message)
    where = None
    if match := _AT.search(first):
        first = (first[: match.start()] + first[match.end() :]).strip()
        if FILES in match["file"] or sources.origins:
            spelled = sources.spelled(match["file"])
            is_own = WRAPPER.lower() not in spelled.lower().replace("_", "")
            where = Location(spelled, int(match["line"]), int(match["column"])) if is_own else None
    either = f"(?:{re.escape(WRAPPER)}|{re.escape(sources.model)})"
    first = re.sub(rf"^\w[\w ]* failed: {either} failed in \w+: |^{either} could not be compiled:? ?", "", first)
    first = re.sub(rf"\b{re.escape(WRAPPER)}\b", sources.model, first)
    said = in_other_words(sources.model, first)
    located = where or (_construct(sources, said.place) if said.place else None) or _mentioned(sources, first)
    located = located or model_location(sources)
    hint = said.hint
    if located is None and not hint:
        hint = "'source' gives the model's full name and a file or library that contains it"
    first = said.what
    if first == NOT_THERE and (package := _within(sources)):
        hint = f"the file has 'within {package}', so its full name is {package}.{sources.model.rpartition('.')[2]}"
    missing = re.match(r"unresolved type reference: '(\w+)\.", first)
    if missing is not None and declarations(_texts(sources), missing[1]):
        hint = f"if '{missing[1]}' inherits it: name it where it is declared"
    elif missing is not None and missing[1] not in libraries(sources):
        hint = f"if '{missing[1]}' is a library: name it in 'files', or the folder that holds it in 'modelica_path'"
    return Problem(f"component '{sources.component}': {sources.model}: {first}", located or sources.where, hint)


def _most_telling(message: str) -> str:
    """One of the failures that *message* tells: what has an unknown type has unknown parts, and not the reverse."""
    first, _, related = message.partition("\nRelated failures")
    types = re.search(r"unresolved type reference: [^\n]*", first + related)
    return types[0] if types and "unresolved component reference" in first else first.strip()


def model_location(sources: ModelSources) -> Location | None:
    """Where the model is declared, if one of the component's own files does."""
    places = declarations(_texts(sources), sources.model)
    return places[0][0] if places else None


def _mentioned(sources: ModelSources, message: str) -> Location | None:
    """Where the only name the message quotes stands, if it stands in one place."""
    for name in _QUOTED.findall(message):
        if name == sources.model:
            continue
        place = _only(sources, rf"(?<![\w.])({re.escape(name)})(?![\w])")
        if place is not None:
            return place
    return None


def _within(sources: ModelSources) -> str:
    """The package that the file says it is within which declares a model of that name."""
    for text in _texts(sources):
        within = re.search(r"\bwithin\s+([\w.]+)\s*;", code(text.text))
        if within is not None and declarations([text], sources.model):
            return within[1]
    return ""


def _construct(sources: ModelSources, pattern: str) -> Location | None:
    """The first place of *pattern* in the file of the model, or the only one in all files."""
    model = model_location(sources)
    own = [text for text in _texts(sources) if model is not None and text.path == model.file]
    first = next((where for _, _, where in found(own, re.compile(pattern))), None)
    return first or _only(sources, pattern)


def _only(sources: ModelSources, pattern: str) -> Location | None:
    """Where *pattern* occurs, if that is in one place."""
    places = [where for _, _, where in found(_texts(sources), re.compile(pattern))]
    return places[0] if len(places) == 1 else None


def _texts(sources: ModelSources) -> list[SourceText]:
    return [
        SourceText(sources.origins[relative], content.decode("utf-8", "replace"))
        for relative, content in sources.contents.items()
    ]


@dataclass(frozen=True, slots=True)
class Wording:
    """What is wrong, a way out, and a pattern of the text that it is about (empty: none is known)."""

    what: str
    hint: str = ""
    place: str = ""


NOT_THERE = "no file or library holds this model"
_SIZES = r"[^\]]*"
_UNBALANCED = (
    "if the numbers should agree: the front-end miscounts variables that are 'inner' below the top level, connectors "
    "that are 'outer', arrays of components that an 'extends' modifies, and parameters bound to a function of an array "
    "(write 1*f(x))"
)
# Patterns of messages, then the parts of a `Wording`, which may refer to their groups. {model}: the model's name.
# fmt: off
_WORDINGS = (
    (r"base class not found: `{model}` does not exist", NOT_THERE),
    (r"Failed to load source root .* has `within (?P<said>[^;`]*);` but expected `within (?P<true>[^;`]*);`",
     r"the file has 'within \g<said>', but is in the folder of '\g<true>'", "correct the line, or move the file",
     r"\b(within)\s+\g<said>\s*;"),
    (r"because resolve/parse failed", "the front-end sees no model in it"),
    (r"model '{model}' cannot extend (?P<kind>\w+) '{model}'.*", r"it is a \g<kind>, not a model",
     "name a model or block"),
    (r"missing source scope for imports:?", "the first result of a function is left out", "give it a variable"),
    (r"(?P<what>unbalanced model: \d+ equations?, \d+ unknowns?).*", r"\g<what>", _UNBALANCED),
    (r"reinit\(\) can only be applied to state variables: (?P<name>\w+)\[.*\] is not a state",
     r"a reinit of '\g<name>[…]', an element of an array, is not supported",
     "declare the states one by one, each with a name of its own", r"\b(reinit)\s*\(\s*\g<name>\s*\["),
    (r".*duplicate condition clock owner key", "several samples as conditions of one when-clause are not supported",
     "write a when-clause for each, and add up what they count", r"\b(when)\s*\{[^}]*\bsample\b[^}]*\bsample\b"),
    (r"unsupported Flat semantic owner `function shape proof`: `(?P<name>\w+)`: declared rank 0 .*",
     r"an array of records whose field '\g<name>' is given as an array is not supported",
     "give an array of records: {Data(a = 1), Data(a = 2)}", r"[(,]\s*(\g<name>)\s*=\s*\{"),
    (r"unsupported Flat semantic owner `when assignment`: `(?P<name>\w+)\[.*\]` is not a discrete coordinate",
     r"an assignment to '\g<name>[…]', an element of an array, in a when-clause is not supported",
     "assign the whole array in one when-clause, or declare the variables one by one",
     rf"\b(\g<name>)\s*\[{_SIZES}\]\s*:?=(?!=)"),
    (r"unsupported Flat semantic owner `function (?:statement|loop reduction)`: `(?P<name>[^`]*)` .*",
     r"a statement of function '\g<name>' is not supported: a loop by while, or one that is left by break",
     "loop by for, or bound the loop by a counter: while … and n < 30 loop n := n + 1; …"),
    (r"unsupported Flat semantic owner `when function-call outputs`.*",
     "a function with several results in a when-clause is not supported",
     "call it in an equation outside, and assign its results in the when-clause"),
    (r"unsupported model algorithm in canonical DAE: a multi-output algorithm .*",
     "a multi-output algorithm of a model (one that computes several results) is not supported",
     "write equations, or a function that is called by an equation"),
    (r"unsupported model algorithm in canonical DAE: sequential read of `(?P<name>[^`]*)`.*",
     r"a model algorithm that reads '\g<name>' between two of its assignments is not supported",
     "use another variable for the value between, or a function"),
    (r"unsupported runtime operator `(?P<name>\w+)`: no checked canonical owner .*",
     r"the function '\g<name>' is not supported", "write out what it means here"),
    (r"unsupported equation form: for-equation range must be .*, got `(?P<name>[\w.]+)`.*",
     r"a for-equation over '\g<name>' is not supported", "count with whole numbers: for i in 1:n loop",
     r"\b(for)\s+\w+\s+in\s+\g<name>\b"),
    (r"unsupported equation form: for-equation range must be .*",
     "a for-equation over other things than whole numbers from a first to a last is not supported",
     "count with whole numbers: for i in 1:n loop", r"\b(for)\s+\w+\s+in\s*\{"),
    (r"redeclaration of `(?P<name>[^`]*)` violates \w+: `(?P<new>[^`]*)` is not a subtype of `(?P<old>[^`]*)`",
     r"the redeclaration of '\g<name>' by '\g<new>', which does not extend '\g<old>', is not supported",
     "let it extend the same class", r"\bredeclare\b[^;,=]*\b(\g<name>)\b"),
)
# fmt: on


def in_other_words(model: str, message: str) -> Wording:
    """*message* about *model* in words of Modelica, or as it is if they are not known."""
    for pattern, *parts in _WORDINGS:
        match = re.match(pattern.replace("{model}", re.escape(model)), message)
        if match is not None:
            wording = Wording(*parts)
            place = wording.place
            for name, text in match.groupdict().items():
                place = place.replace(f"\\g<{name}>", re.escape(text or ""))
            return Wording(match.expand(wording.what), wording.hint, place)
    return Wording(message)
