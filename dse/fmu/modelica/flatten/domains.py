"""Loop domains: the points over which a for-loop, a comprehension or a family of equations runs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from dse.errors import fail
from dse.fmu.modelica.flatten.document import Document, fields

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
