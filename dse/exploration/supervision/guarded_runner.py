"""The runner of the configuration at hand in a worker, with what guards the process around it. A thread has its own."""

from __future__ import annotations

import os
import pickle
import time
import traceback

from dse.domain.run import Outcome, Run, RunRequest
from dse.errors import DseError, FreshProcessNeeded
from dse.exploration.failures import checked_run, failed_run, in_words
from dse.exploration.supervision.heartbeat import Heartbeat, Phase
from dse.exploration.supervision.messages import Fault, Setup
from dse.exploration.supervision.open_files import are_many_open
from dse.exploration.supervision.process_state import ProcessState
from dse.exploration.work import Batch, Runner


class GuardedRunner:
    """Simulates one configuration after the other; the one before is closed.

    *fault* is what failed here and may be good in another process: what was done here before may be to blame.
    """

    def __init__(self, setup: Setup, heart: Heartbeat) -> None:
        self.runs = 0
        self.fault: Fault | None = None
        self._setup = setup
        self._heart = heart
        self._progress = heart.block
        self._configuration = ""
        self._runner: Runner | None = None
        self._problem = ""
        self._spent = False
        self._state = ProcessState()
        self._process = os.getpid()

    @property
    def runs_left(self) -> int | None:
        """How many more runs of the configuration at hand the process may make; 0 if it must not go on at all."""
        if self._spent:
            return 0
        return None if self._runner is None else self._runner.runs_left

    def load(self, batch: Batch) -> None:
        """Have the runner of the configuration of *batch* ready."""
        if self._configuration == batch.configuration:
            return
        if self.runs and self._state.is_marked:
            self._spent = True
            return
        self._heart.beat(Phase.LEAVING, batch.identity)
        self.clear()
        self._progress[:] = bytes(len(self._progress))
        self._heart.beat(Phase.LOADING, batch.identity)
        start = time.perf_counter()
        try:
            prepared = pickle.loads(self._setup.file(batch.configuration).read_bytes())  # noqa: S301  # our supervisor's
            self._state.begin(prepared.memory)
            self._runner = self._setup.make_runner(prepared, self._progress)
        except DseError as error:
            # A fresh process would say the same: each of its runs fails, other configurations go on.
            self._spent |= self.runs > 0 and (isinstance(error, FreshProcessNeeded) or are_many_open())
            self._problem = in_words(error)
        except Exception as error:  # noqa: BLE001  # that may be the process, or the moment
            self._spent = True
            self.fault = Fault(None, in_words(error), time.perf_counter() - start)
        self._leave_if_copied()
        self._state.restore()
        self._configuration = batch.configuration

    def run(self, batch: Batch, request: RunRequest) -> Run | None:
        """Simulate *request*; what the simulation says that it failed of is a failed run. None if it is to be left to
        a fresh process.
        """
        self.load(batch)
        if self._spent:
            return None
        self.runs += 1
        if self._runner is None:
            return failed_run(request, self._problem)
        self._progress[:] = bytes(len(self._progress))
        self._heart.beat(Phase.RUNNING, batch.identity, request.number)
        start = time.perf_counter()
        doubt = False
        try:
            run = checked_run(self._runner.run(request, keep=batch.keep), self._setup.measures)
        except Exception as error:  # noqa: BLE001  # a failed run is a row, not the end of the study
            run, doubt = failed_run(request, in_words(error)), not isinstance(error, DseError)
            # What state the simulation is in now is anyone's guess: the next run starts with a new one.
            self._leave_if_copied()
            self.clear()
        self._leave_if_copied()
        self._state.restore()
        failed = run.outcome is Outcome.FAILED
        harm = self._state.harm(now=failed)
        if are_many_open():
            harm = "there were too many open files"
        if failed and (doubt or harm):
            self._spent = True
            words = f"{run.problem}; {harm}" if harm else run.problem
            self.fault = Fault(request.number, words, time.perf_counter() - start)
            return None
        self._spent |= bool(harm)
        return run

    def put_back(self) -> None:
        """Undo what runs have done to the limits of the process, as far as that is allowed."""
        self._spent |= bool(self._state.harm(now=True))

    def rest(self) -> None:
        """Tell that nothing is simulated here for now."""
        self._heart.beat(Phase.WAITING)

    def clear(self) -> None:
        """Close the runner, if there is one."""
        self._spent = self.runs_left == 0
        runner, self._runner, self._configuration = self._runner, None, ""
        if runner is not None:
            try:
                runner.close()
            except Exception:  # noqa: BLE001  # its runs are done and stored; all that is lost is the tidying up
                traceback.print_exc()
            self._leave_if_copied()

    def _leave_if_copied(self) -> None:
        # An FMU has made a copy of the process (fork) that went on: there must not be a second worker on the channel.
        if os.getpid() != self._process:
            os._exit(0)
