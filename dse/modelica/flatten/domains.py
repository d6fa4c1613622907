"""Loop domains: the points over which a for-loop, a comprehension or a family of equations runs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from dse.errors import fail
from dse.modelica.flatten.document import Document, fields

_MOST_POINTS = 1_000_000


def points(document: Document, domain: int) -> Iterator[tuple[int, ...]]:
    """Values of the counters of *domain*, the last one fastest."""
    return itertools.product(*ranges(document, domain))


def shape(document: Document, domain: int) -> tuple[int, ...]:
    """How many values each counter of *domain* takes."""
    return tuple(len(counter) for counter in ranges(document, domain))


def ranges(document: Document, domain: int) -> Sequence[range]:
    """The values of each counter of *domain*. Raises DseError for bounds that are no numbers."""
    record = document.lists["domains"][domain]
    where = document.where(record.get("provenance"))
    fields(record, "parent domain", "a loop's domain", where)
    fields(record["domain"], "binders", "a loop's domain", where)
    found = []
    total = 1
    for place, binder in enumerate(record["domain"]["binders"]):
        fields(binder, "id display_name lower upper step", "a loop's counter", where)
        first, last, step = binder["lower"], binder["upper"], binder["step"]
        if not all(isinstance(item, int) for item in (first, last, step)) or step == 0 or binder["id"] != place:
            raise fail(f"a loop over '{binder['display_name']}' without fixed whole bounds is not supported", where)
        found.append(range(first, last + (1 if step > 0 else -1), step))
        total *= len(found[-1])
    if total > _MOST_POINTS:
        raise fail(f"a loop of {total} turns is not supported (at most {_MOST_POINTS})", where)
    return found


def check_counters(document: Document, domain: int, function: int) -> None:
    """Raise DseError if a counter of *domain* has the name of a variable of function number *function*.

    The front-end takes the variable for the counter then. Negative: there is no function.
    """
    if function < 0:
        return
    record, called = document.lists["domains"][domain], document.lists["functions"][function]
    taken = {variable["name"] for variable in (*called["outputs"], *called["locals"])}
    for binder in record["domain"]["binders"]:
        if binder["display_name"] in taken:
            what = f"the loop counter '{binder['display_name']}' with the name of a variable of '{called['name']}'"
            where = document.where(record.get("provenance")) or document.where(called.get("declaration"))
            raise fail(f"{what} is not supported", where, "give it another name")
