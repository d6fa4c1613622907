"""Classes of libraries under names that the front-end can distinguish; nothing else is changed.

rumoca 0.10.2 takes the variables of a class for those of the class around it, if that one extends it; and functions of
one name in several classes for one function. So a base that is encapsulated, and thus needs nothing of what is around
it, gets a file of its own; and a function of a model gets the model's name added to its own. Where the text leaves any
doubt about what a name is, nothing is done, and the guards of `misreadings` apply.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from dse.modelica.frontend.source_text import Change, SourceText, code, edited
from dse.modelica.frontend.used_classes import Class, Classes

_MODELS = ("model", "block")


def distinct(texts: Sequence[SourceText], own: Sequence[SourceText]) -> Iterator[tuple[SourceText, str]]:
    """*texts* of libraries with such classes renamed, and one more text for each that was taken out of its file.

    With each the path of the file it is from. What the model's *own* texts name keeps its name. Lines stay where they
    are; a new text has its class in the lines where it was, and is called after both classes.
    """
    found = Classes([SourceText(text.path, code(text.text)) for text in (*texts, *own)])
    changes: list[list[Change]] = [[] for _ in texts]
    for owner, new in _functions(found):
        if found.classes[owner].source < len(texts):
            changes[found.classes[owner].source] += new
    for number, text in enumerate(texts):
        apart = list(_bases(found, number))
        for base, name in apart:
            base_class = found.classes[base]
            short = base_class.name.rpartition(".")[2]
            content = text.text[base_class.start : base_class.end]
            content = re.sub(rf"\b{re.escape(short)}\b", name, content)
            within = f"within {base_class.name.rpartition('.')[0].rpartition('.')[0]};"
            before = "\n" * text.text.count("\n", 0, base_class.start)
            path = f"{text.path.rpartition('/')[0]}/{name}.mo"
            yield SourceText(path, f"{within}{before}{content}\n"), text.path
            changes[number].append((base_class.start, base_class.end, "\n" * content.count("\n")))
            uses = re.compile(rf"\bextends\s+({re.escape(short)})\b").finditer(found.texts[number].text)
            changes[number] += [(*use.span(1), name) for use in uses]
        yield replace(text, text=edited(text.text, changes[number])), text.path


def _bases(found: Classes, source: int) -> Iterator[tuple[int, str]]:
    """The encapsulated classes that the one class of a file declares and extends, and new names for them."""
    (top, *more) = [own for own in found.classes if own.source == source and not own.kind]
    outermost = top.inside
    if more or len(outermost) != 1 or found.classes[outermost[0]].kind not in _MODELS:
        return
    outer = found.classes[outermost[0]]
    text = found.texts[source].text
    for number in outer.inside:
        own = found.classes[number]
        short = own.name.rpartition(".")[2]
        is_apart = re.match(r"encapsulated\b", text[own.start : own.end]) is not None
        is_extended = re.search(rf"\bextends\s+{re.escape(short)}\b", text) is not None
        elsewhere = any(
            number != source and re.search(rf"\b{re.escape(short)}\b", each.text)
            for number, each in enumerate(found.texts)
        )
        if own.kind in _MODELS and is_apart and is_extended and not elsewhere:
            yield number, f"{outer.name.rpartition('.')[2]}_{short}"


def _functions(found: Classes) -> Iterator[tuple[int, list[Change]]]:
    """The models with functions of names that others have too, and the changes of text that rename them."""
    named: dict[str, list[int]] = {}
    for number, own in enumerate(found.classes):
        if own.kind == "function":
            named.setdefault(own.name.rpartition(".")[2], []).append(number)
    used = _used_elsewhere(found)
    for short, numbers in named.items():
        owners = {found.classes[number].around for number in numbers}
        texts = [found.texts[found.classes[number].source].text for number in numbers]
        heads = [
            text[found.classes[one].start : found.classes[one].body] for text, one in zip(texts, numbers, strict=True)
        ]
        is_redeclared = any(re.search(r"\b(?:redeclare|replaceable|extends)\b", head) for head in heads)
        if len(numbers) == 1 or len(owners) < len(numbers) or is_redeclared:
            continue
        for around in owners:
            outer = found.classes[around]
            last = outer.name.rpartition(".")[2]
            if outer.kind in _MODELS and last not in used:
                text = found.texts[outer.source].text
                changes = list(_renamed(text, outer, short, f"{short}_of_{last}"))
                if all(changes):
                    yield around, [change for change in changes if change is not None]


_USES = re.compile(r"\bextends\s+((?:\w+\s*\.\s*)*)(\w+)|=\s*((?:\w+\s*\.\s*)*)(\w+)\b|\b(\w+)\s*\.")


def _used_elsewhere(found: Classes) -> set[str]:
    """The last names of what is extended, or given in a redeclaration, and all names before a dot."""
    names: set[str] = set()
    for text in found.texts:
        for match in _USES.finditer(text.text):
            path = f"{match[1] or ''}{match[3] or ''}"
            names.update(re.findall(r"\w+", path), (match[2] or match[4] or match[5],))
    return names


def _renamed(text: str, outer: Class, name: str, new: str) -> Iterator[Change | None]:
    """The places of *name* in a class; None for one that may be anything but the function."""
    for match in re.compile(rf"\b{re.escape(name)}\b").finditer(text, outer.start, outer.end):
        start, end = match.span()
        before, after = text[max(start - 240, 0) : start].rstrip(), text[end : end + 40].lstrip()
        is_declared = re.search(r"\b(?:function|end)$", before) is not None
        is_derivative = before.endswith("=") and re.search(r"\bderivative\b[^;]{0,200}=$", before) is not None
        is_called = (
            after.startswith("(") and re.search(r"(?:[-+*/^=(,{\[]|\b(?:then|else|and|or|not))$", before) is not None
        )
        is_ok = is_declared or is_derivative or (is_called and not before.endswith("."))
        yield (start, end, new) if is_ok else None
