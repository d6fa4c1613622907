"""Worker processes on this machine."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import Any, ClassVar

from pydantic import Field

from dse.exploration.executor import Pool
from dse.exploration.supervision.supervisor import Supervisor
from dse.exploration.work import Sink, Work
from dse.loading import ExecutorSection


class Local(ExecutorSection):
    """*workers* processes (0: one for each processor), each with *threads* runs at once where FMUs bear that.

    Where they do not, there are as many more processes instead. With *sandbox*, FMUs have no network and write in
    their scratch folder only.
    """

    name: ClassVar[str] = "local"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"workers": 1}, {"workers": 2}, {"workers": 1, "threads": 2})

    workers: int = Field(default=0, ge=0)
    threads: int = Field(default=1, ge=1)
    sandbox: bool = False

    def open(self, work: Work, sink: Sink) -> AbstractContextManager[Pool]:
        """A supervised pool: workers that die or hang cost the run they were in, and nothing else."""
        workers = self.workers or max(1, (os.cpu_count() or 1) // self.threads)
        return Supervisor(work, sink, workers, self.threads, sandboxed=self.sandbox)


EXECUTOR = Local
