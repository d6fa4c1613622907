"""The front-end's own words as what they mean to who wrote the model."""

from __future__ import annotations

import re
from dataclasses import dataclass


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
    "that are 'outer', and arrays of components that an 'extends' modifies"
)
# Patterns of messages, then a Wording whose texts may refer to their groups. {model}: the model's name.
_WORDINGS = (
    (r"base class not found: `{model}` does not exist", Wording(NOT_THERE)),
    (
        r"Failed to load source root .* has `within (?P<said>[^;`]*);` but expected `within (?P<true>[^;`]*);`",
        Wording(
            r"the file says 'within \g<said>', but lies in the folder of '\g<true>'",
            "correct the line, or move the file",
            r"\b(within)\s+\g<said>\s*;",
        ),
    ),
    (r"because resolve/parse failed", Wording("the front-end sees no model in it")),
    (
        r"model '{model}' cannot extend (?P<kind>\w+) '{model}'.*",
        Wording(r"it is a \g<kind>, not a model", "name a model or block"),
    ),
    (
        r"missing source scope for imports:?",
        Wording("the first result of a function is left out", "give it a variable"),
    ),
    (
        r"(?P<what>unbalanced model: \d+ equations?, \d+ unknowns?).*",
        Wording(r"\g<what>", _UNBALANCED),
    ),
    (
        r"reinit\(\) can only be applied to state variables: (?P<name>\w+)\[.*\] is not a state",
        Wording(
            r"a reinit of '\g<name>[…]', an element of an array, is not supported",
            "declare the states one by one, each with a name of its own",
            r"\b(reinit)\s*\(\s*\g<name>\s*\[",
        ),
    ),
    (
        r".*duplicate condition clock owner key",
        Wording(
            "several samples as conditions of one when-clause are not supported",
            "write a when-clause for each, and add up what they count",
            r"\b(when)\s*\{[^}]*\bsample\b[^}]*\bsample\b",
        ),
    ),
    (
        r"unsupported Flat semantic owner `function shape proof`: `(?P<name>\w+)`: declared rank 0 .*",
        Wording(
            r"an array of records whose field '\g<name>' is given as an array is not supported",
            "give an array of records: {Data(a = 1), Data(a = 2)}",
            r"[(,]\s*(\g<name>)\s*=\s*\{",
        ),
    ),
    (
        r"unsupported Flat semantic owner `when assignment`: `(?P<name>\w+)\[.*\]` is not a discrete coordinate",
        Wording(
            r"an assignment to '\g<name>[…]', an element of an array, in a when-clause is not supported",
            "assign the whole array in one when-clause, or declare the variables one by one",
            rf"\b(\g<name>)\s*\[{_SIZES}\]\s*:?=(?!=)",
        ),
    ),
    (
        r"unsupported Flat semantic owner `function statement`: `(?P<name>[^`]*)` contains .*",
        Wording(
            r"a statement of function '\g<name>' is not supported: a loop by while, or one that is left by break",
            "loop by for, or bound the loop by a counter: while … and n < 30 loop n := n + 1; …",
        ),
    ),
    (
        r"unsupported Flat semantic owner `when function-call outputs`.*",
        Wording(
            "a function with several results in a when-clause is not supported",
            "call it in an equation outside, and assign its results in the when-clause",
        ),
    ),
    (
        r"unsupported model algorithm in canonical DAE: a multi-output algorithm .*",
        Wording(
            "a multi-output algorithm of a model (one that computes several results) is not supported",
            "write equations, or a function that is called by an equation",
        ),
    ),
    (
        r"unsupported model algorithm in canonical DAE: sequential read of `(?P<name>[^`]*)`.*",
        Wording(
            r"a model algorithm that reads '\g<name>' between two of its assignments is not supported",
            "use another variable for the value between, or a function",
        ),
    ),
    (
        r"unsupported runtime operator `(?P<name>\w+)`: no checked canonical owner .*",
        Wording(r"the function '\g<name>' is not supported", "write out what it means here"),
    ),
    (
        r"unsupported equation form: for-equation range must be .*, got `(?P<name>[\w.]+)`.*",
        Wording(
            r"a for-equation over '\g<name>' is not supported",
            "count with whole numbers: for i in 1:n loop",
            r"\b(for)\s+\w+\s+in\s+\g<name>\b",
        ),
    ),
    (
        r"unsupported equation form: for-equation range must be .*",
        Wording(
            "a for-equation over other things than whole numbers from a first to a last is not supported",
            "count with whole numbers: for i in 1:n loop",
            r"\b(for)\s+\w+\s+in\s*\{",
        ),
    ),
    (
        r"redeclaration of `(?P<name>[^`]*)` violates \w+: `(?P<new>[^`]*)` is not a subtype of `(?P<old>[^`]*)`",
        Wording(
            r"the redeclaration of '\g<name>' by '\g<new>', which does not extend '\g<old>', is not supported",
            "let it extend the same class",
            r"\bredeclare\b[^;,=]*\b(\g<name>)\b",
        ),
    ),
)


def in_other_words(model: str, message: str) -> Wording:
    """*message* about *model* in words of Modelica, or as it is if they are not known."""
    for pattern, wording in _WORDINGS:
        match = re.match(pattern.replace("{model}", re.escape(model)), message)
        if match is not None:
            place = wording.place
            for name, text in match.groupdict().items():
                place = place.replace(f"\\g<{name}>", re.escape(text or ""))
            return Wording(match.expand(wording.what), wording.hint, place)
    return Wording(message)
