"""An executor over ``concurrent.futures``: the same few lines serve any other, also of other machines."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager
from functools import partial
from multiprocessing import get_context
from typing import Any, ClassVar

from pydantic import Field

from dse.plugins import ExecutorSection, FuturesExecutor, Pool, Sink, Work


class Futures(ExecutorSection):
    """*workers* processes, each with about a second's worth of runs at a time."""

    name: ClassVar[str] = "futures"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"workers": 2},)

    workers: int = Field(default=2, ge=1)

    def open(self, work: Work, sink: Sink) -> AbstractContextManager[Pool]:
        """The processes end with the block, after what they are at."""
        make = partial(ProcessPoolExecutor, self.workers, mp_context=get_context("spawn"))
        return FuturesExecutor(make).open(work, sink)
