"""What the front-end refuses, in other words that mean the same.

Loops and comprehensions over an enumeration, ``for e in Kind loop``, are counted by numbers, ``for e in 1:3 loop``: the
front-end takes no type as a range. As an index, a value of an enumeration and its number are the same; the front-end
refuses a number where the enumeration itself is needed.

Connections of one signal to elements of several vectors are equations. rumoca 0.10.2 refuses them where the signal is
discrete: ``connect(a.y, sum.u[1]); connect(a.y, product.u[2]);``. For signals, ``sum.u[1] = a.y`` is the same. It is
not for pins and flanges, for which the front-end finds too many equations; so this is done only to sources that it
refused for that reason.

Derivatives of expressions, ``der(a - b)``, are derivatives of variables that are declared for them. rumoca 0.10.2
refuses the first, and takes ``{der(a), der(b)}`` for ``der({a, b})``. A variable for the expression is differentiated
by index reduction, as in any model.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import partial

from dse.modelica.frontend.source_text import Change, arguments, changed, code, edited
from dse.modelica.frontend.syntax import Element, read_tree

_ENUMERATION = re.compile(r"\btype\s+(\w+)\s*=\s*enumeration\s*\(((?:[^()]|\([^()]*\))*)\)")
_RANGE = re.compile(r"\bin\s+((?:\w+\s*\.\s*)*(\w+))(?=\s*(?:\bloop\b|[,})]))")


def counted(contents: Mapping[str, bytes], others: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files *contents* with such loops counted. The enumerations may be declared in *others* too.

    One that shares its name with an enumeration of another size, or with a variable, is left alone.
    """
    everything = [code(text.decode("utf-8", "replace")) for text in (*others.values(), *contents.values())]
    wanted = {match[2] for text in everything for match in _RANGE.finditer(text)}
    if not wanted:
        return dict(contents)
    sizes: dict[str, set[int]] = {}
    for text in everything:
        for match in _ENUMERATION.finditer(text):
            sizes.setdefault(match[1], set()).add(len(arguments(match[2])))
    variables = re.compile(
        rf"[\w\]]\s+({'|'.join(map(re.escape, sorted(wanted)))})\s*(?:[;\[(,]|=(?!\s*enumeration\b))"
    )
    taken = {match[1] for text in everything for match in variables.finditer(text)}
    counts = {name: sizes[name].pop() for name in wanted - taken if len(sizes.get(name, ())) == 1}
    return changed(contents, partial(_counted, counts))


def _counted(counts: Mapping[str, int], text: str) -> str:
    ranges = [match for match in _RANGE.finditer(code(text)) if match[2] in counts]
    return edited(text, [(*match.span(1), f"1:{counts[match[2]]}") for match in ranges])


ELEMENTS = "element assignments must cover a discrete coordinate exactly once"
"""What the front-end's refusal of such connections says."""
_PATH = r"[A-Za-z_]\w*(?:\s*\.\s*[A-Za-z_]\w*)*"
_CONNECT = re.compile(
    rf"\bconnect\s*\(\s*(?P<one>{_PATH})(?P<a>\s*\[[\w\s]+\])?\s*,\s*(?P<other>{_PATH})(?P<b>\s*\[[\w\s]+\])?\s*\)"
)


def with_equations(files: Mapping[str, bytes], least: int) -> dict[str, bytes]:
    """*files* with such connections, of signals that have at *least* so many, as equations as long."""
    return changed(files, partial(_connected, least))


def _connected(least: int, text: str) -> str:
    found = [match for match in _CONNECT.finditer(code(text)) if (match["a"] is None) != (match["b"] is None)]
    used = Counter(_signal(match) for match in found)
    often = [match for match in found if used[_signal(match)] >= least]
    return edited(text, [(*match.span(), _equation(match).ljust(len(match[0]))) for match in often])


def _signal(match: re.Match[str]) -> str:
    return re.sub(r"\s", "", match["one"] if match["b"] else match["other"])


def _equation(match: re.Match[str]) -> str:
    if match["b"]:
        return f"{match['other']}{match['b']} = {match['one']}"
    return f"{match['one']}{match['a']} = {match['other']}"


OF_EXPRESSION = "der(...) must have exactly one resolved variable-reference operand"
"""What the front-end's refusal says."""


def with_variables(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """*files* with such variables. Derivatives in loops and comprehensions stay as they are."""
    return changed(files, _changed)


def _changed(text: str) -> str:
    tree = read_tree(text)
    models = [own for own in tree.elements if own.kind in ("model", "block", "class")] if tree else []
    return edited(text, [change for own in models if own.elements for change in _variables(own)])


def _variables(own: Element) -> Iterator[Change]:
    tree = own.tree
    words, starts, at, loops, number = tree.words, tree.starts, own.named, 0, 0
    inner = {each.start: each.end for each in own.elements if each.elements}
    while at < own.end:
        at = inner.get(at, at)
        loops += (words[at] == "loop") - (words[at - 1] == "end" and words[at] in ("for", "while"))
        if words[at] in ("(", "[", "{") and "for" in words[at : tree.closing[at]]:
            at = tree.closing[at]
        elif words[at] == "der" and words[at + 1] == "(" and not loops:
            start, end = at + 2, tree.closing[at + 1]
            if words[start] == "{" and tree.closing[start] == end - 1:
                parts = (f"der({' '.join(part)})" for part in tree.parts(start))
                yield starts[at], starts[end] + 1, f"{{{', '.join(parts)}}}"
            elif not {*"+-*/^("}.isdisjoint(words[start:end]) and "[" not in words[start:end]:
                number += 1
                name, head = f"dse_{own.name}_{number}", starts[own.named + 1]
                yield head, head, f"Real {name} = {' '.join(words[start:end])}; "
                yield starts[start], starts[end], name
            at = end
        at += 1
