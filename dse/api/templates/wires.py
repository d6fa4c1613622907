"""Connections between ports of the same name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from dse.domain.component import Causality, Interface, same_signal
from dse.domain.labels import array_of


def wires(places: Mapping[str, Interface]) -> Iterator[tuple[str, str]]:
    """For each input of *places* the output of its name and type, if one other place has such; arrays as a whole."""
    seen = set()
    for place, interface in places.items():
        for port in interface.ports:
            sources = [
                f"{other}.{array_of(output.name) or output.name}"
                for other, maker in places.items()
                for output in maker.ports
                if other != place
                and output.causality is Causality.OUTPUT
                and output.name == port.name
                and not same_signal(output.type, port.type)
            ]
            target = f"{place}.{array_of(port.name) or port.name}"
            if port.causality is Causality.INPUT and len(sources) == 1 and target not in seen:
                seen.add(target)
                yield sources[0], target
