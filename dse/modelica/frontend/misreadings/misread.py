"""What the front-end is known to flatten wrongly without a word: found in the sources the model uses, and refused."""

from __future__ import annotations

import re
from collections.abc import Iterator

from dse.errors import Problem
from dse.modelica.frontend.misreadings.constants import mixed_up_constants
from dse.modelica.frontend.misreadings.modifications import misread_modifications
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.source_text import CLASS_KINDS, PREFIXES, occurring
from dse.modelica.frontend.sources import SourceText
from dse.modelica.frontend.used_classes import Used, used


def misread(result: FrontEndResult) -> Iterator[Problem]:
    """Each construct of the classes the model uses that rumoca 0.10.2 takes for something else."""
    read = used(result.sources.values(), result.model)
    names = [str(function["name"]) for function in result.dae["storage"]["functions"]]
    yield from misread_modifications(read)
    yield from _functions_of_one_name(read, names)
    yield from mixed_up_constants(read, result.model, [name.rpartition(".")[2] for name in names])
    yield from _outer_classes(read)


def _functions_of_one_name(read: Used, names: list[str]) -> Iterator[Problem]:
    """Functions are kept under the name they are called by, so that two of one name become one."""
    tops = {name for source in read.texts for name in _top(source)}
    for name in names:
        if "." in name and name.split(".", maxsplit=1)[0] in tops:
            continue
        last = name.rsplit(".", maxsplit=1)[-1]
        declared = re.compile(
            rf"\b(?:function|record)\s+(?:extends\s+)?({re.escape(last)})\b(?<!end {re.escape(last)})"
        )
        aliased = re.compile(rf"\bimport\s+({re.escape(last)})\s*=")
        places = [where for pattern in (declared, aliased) for _, _, where in occurring(read.texts, pattern)]
        if len(places) > 1:
            what = f"the function '{name}' may be one of {len(places)}, which the front-end cannot distinguish"
            yield Problem(what, places[0], f"call it by its full name; another is declared at {places[1]}")


def _top(source: SourceText) -> Iterator[str]:
    within = re.search(r"\bwithin\b\s*([\w.]*)\s*;", source.text)
    if within is not None and within[1]:
        yield within[1].split(".", maxsplit=1)[0]
        return
    first = re.search(rf"\b(?:{CLASS_KINDS})\s+(\w+)", source.text)
    if first is not None:
        yield first[1]


_OUTER = re.compile(rf"\bouter\s+{PREFIXES}({CLASS_KINDS})\b")


def _outer_classes(read: Used) -> Iterator[Problem]:
    """The class that is inner is not looked for."""
    for _, match, where in occurring(read.texts, _OUTER):
        what = f"an outer {match[1]}, for which the front-end does not take the inner one, is not supported"
        yield Problem(what, where, "make the class replaceable, and redeclare it")
