"""A line to workers elsewhere."""

from __future__ import annotations

from concurrent.futures import Future
from typing import Protocol

from dse.exploration.remote.messages import Answer


class Transport(Protocol):
    """Takes messages to workers.

    A future fails with BrokenExecutor or CancelledError if all that is under way is lost, with another exception if its
    worker was.
    """

    def slots(self) -> int:
        """How many messages are carried out at once at present; quick."""

    def send(self, content: bytes, worker: str) -> Future[Answer]:
        """Have `work_on` called with *content*, best by *worker* if that is not ""."""

    def renew(self, error: BaseException) -> None:
        """Connect again after all was lost for *error*; DseError if that cannot be."""
