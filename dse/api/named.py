"""What a workspace has of one kind, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, TypeVar

from dse.api.presentation.html import table

T = TypeVar("T")


class Named(Mapping[str, T]):
    """Things by name, each read when it is first asked for. An unknown name is a DseError that hints at the nearest."""

    def __init__(self, what: str, names: Callable[[], Iterable[str]], read: Callable[[str], T]) -> None:
        self._what = what
        self._names = names
        self._read = read
        self._known: dict[str, T] = {}

    def __getitem__(self, name: str) -> T:
        if name not in self._known:
            self._known[name] = self._read(name)
        return self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in set(self._names())

    def get(self, name: str, default: Any = None) -> Any:
        """What is called *name*, *default* if there is none. Raises DseError if it is there and cannot be read."""
        return self[name] if name in self else default  # noqa: SIM401  # this is get

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._names()))

    def __len__(self) -> int:
        return len(set(self._names()))

    def __repr__(self) -> str:
        return f"<{self._what}: {', '.join(self) or 'none'}>"

    def _repr_html_(self) -> str:
        return table(self._what, (), [[name] for name in self])
