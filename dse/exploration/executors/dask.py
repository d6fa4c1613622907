"""Workers of a Dask cluster, on any number of machines."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator, Mapping
from concurrent.futures import CancelledError, Future
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.errors import DseError, fail, remedy
from dse.exploration.executor import Pool
from dse.exploration.remote.dispatcher import Dispatcher
from dse.exploration.remote.messages import Answer
from dse.exploration.remote.worker import work_on
from dse.exploration.work import Sink, Work
from dse.loading import ExecutorSection

if TYPE_CHECKING:
    import distributed

_CONNECT_SECONDS = 30.0


class Dask(ExecutorSection):
    """The workers of the scheduler at *address*; without, *workers* processes on this machine (0: one a processor)."""

    name: ClassVar[str] = "dask"
    short: ClassVar[str] = "address"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"workers": 2},)

    address: str = ""
    workers: int = Field(default=0, ge=0)

    @contextmanager
    def open(self, work: Work, sink: Sink) -> Iterator[Pool]:
        """Workers may come and go; what one had that went is made by another."""
        try:
            import distributed
        except ImportError as error:
            raise fail("the executor 'dask' needs distributed", hint="pip install 'dse-workbench[dask]'") from error
        with ExitStack() as stack:
            stack.enter_context(_quiet())
            address = self.address
            if not address:
                try:
                    cluster = distributed.LocalCluster(
                        n_workers=self.workers or os.cpu_count() or 1,
                        threads_per_worker=1,
                        dashboard_address="127.0.0.1:0",
                        silence_logs=logging.CRITICAL,
                    )
                except (OSError, RuntimeError) as error:
                    raise _not_started(error) from error
                address = stack.enter_context(cluster).scheduler_address
            line = stack.enter_context(_DaskTransport(address))
            yield stack.enter_context(Dispatcher(line, work, sink))


class _DaskTransport:
    """A line over the scheduler at *address*."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._client = self._connected()
        self._threads = 0

    def slots(self) -> int:
        """The threads of all workers."""
        if self._client.status == "running":
            with suppress(OSError, TimeoutError):
                self._threads = sum(self._client.nthreads().values())
        return self._threads

    def send(self, content: bytes, worker: str) -> Future[Answer]:
        """Results come as they are there; what a worker had that ended goes to another, some times, before it fails."""
        ours: Future[Answer] = Future()

        def pass_on(theirs: distributed.Future) -> None:
            if not ours.set_running_or_notify_cancel():
                theirs.cancel()
                return
            try:
                if theirs.status == "finished":
                    ours.set_result(theirs.result())
                elif theirs.status == "error":
                    ours.set_exception(theirs.exception())
                else:
                    ours.set_exception(CancelledError("the scheduler does not know the work any more"))
            except BaseException as error:  # noqa: BLE001  # it was there, but cannot be had
                ours.set_exception(CancelledError(str(error)))
            finally:
                theirs.release()

        if self._client.status != "running":
            raise CancelledError("the connection to the scheduler was lost")
        only = {"workers": [worker], "allow_other_workers": True} if worker else {}
        future = self._client.submit(work_on, content, pure=False, **only)
        future.add_done_callback(pass_on)
        return ours

    def renew(self, error: BaseException) -> None:
        """Connect to the scheduler that is there now."""
        del error
        if self._client.status != "running":
            with suppress(Exception):
                self._client.close(timeout=1)
            self._client = self._connected()

    def __enter__(self) -> _DaskTransport:
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(Exception):
            self._client.close(timeout=5)

    def _connected(self) -> distributed.Client:
        import distributed

        try:
            return distributed.Client(self._address, timeout=_CONNECT_SECONDS, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            what = f"the Dask scheduler at {self._address} does not answer: {error or type(error).__name__}"
            raise fail(what, hint="finished runs are stored: the same command resumes when it does") from error


def _not_started(error: BaseException) -> DseError:
    """Workers of this machine cannot be started; what Dask raises has the system's reason among its causes."""
    cause: BaseException | None = error
    while cause is not None and not isinstance(cause, OSError):
        cause = cause.__cause__ or cause.__context__
    what = f"Dask cannot start workers on this machine: {cause or error}"
    return fail(what, hint=remedy(cause.errno if cause else None, "the executor 'local' needs no Dask"))


@contextmanager
def _quiet() -> Iterator[None]:
    """What Dask logs of workers and connections that are lost would stand between a progress bar and its message."""
    log = logging.getLogger("distributed")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        log.setLevel(level)


EXECUTOR = Dask
