"""Finding out what an FMU really does: one experiment after the other, each in a process of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import nan

from dse.cosim.binding.layout import kernel
from dse.cosim.probing import experiments, stress
from dse.cosim.probing.child import Experiment, ExperimentOutcome, ProbeLimits, attempt
from dse.cosim.probing.excitation import Excitation, driven, excitation_of
from dse.cosim.probing.subject import Trajectory
from dse.domain.facts import Answer, FmuFacts, Question
from dse.domain.fmu import FmuModel

_STRENGTHS = (1.0, 0.05, 0.0)
_MEASURING = 0.3
_THREADING = 1.0
_STRAINING = 5.0

Tell = Callable[[Question], None]
"""Told of every question before its experiment begins."""

_COMPARING = (
    Question.RESETS, Question.RENEWS, Question.COEXISTS, Question.THREADS, Question.SAVES, Question.SERIALIZES,
)  # fmt: skip


def probe(
    model: FmuModel,
    platform: str,
    *,
    limits: ProbeLimits | None = None,
    tell: Tell = lambda _: None,
    only: frozenset[Question] = frozenset(Question),
    sandboxed: bool = False,
) -> FmuFacts:
    """What the FMU does; never raises for what an FMU does, be it a crash. Takes some seconds.

    Raises DseError if the kernel is not there.

    Only the questions of *only* are asked, besides those that must be answered first. *sandboxed* has each experiment
    made in a sandbox; DseError where there is none.
    """
    kernel()  # that it is missing is no fact about an FMU
    return _Probe(model, platform, limits or ProbeLimits(), tell, only, sandboxed).facts()


@dataclass
class _Probe:
    model: FmuModel
    platform: str
    limits: ProbeLimits
    tell: Tell
    only: frozenset[Question]
    sandboxed: bool
    answers: dict[Question, Answer] = field(default_factory=dict)
    reasons: dict[Question, str] = field(default_factory=dict)

    def facts(self) -> FmuFacts:
        model = self.model
        facts = FmuFacts(
            model.content_hash, self.platform, model.identifier, model.version, model.manner,
            self.answers, self.reasons,
        )  # fmt: skip
        found = self._find_drive()
        if found is None:
            return facts
        drive, expected = found
        facts = replace(facts, step=drive.step, steps=drive.steps, drive=drive.strength)
        other, expected_other = self._find_other(drive, expected)
        self._same(Question.REPEATS, experiments.repeated_run, drive, expected, anew=True)
        if self.answers.get(Question.REPEATS) is Answer.NO:
            self._skip("it is not deterministic", *_COMPARING)
        else:
            self._compare_instances(drive, other, expected, expected_other)
            self._compare_states(drive, expected)
        self._try_steps(drive)
        self._try_inputs(drive, other)
        return self._strain(facts, drive)

    def _find_drive(self) -> tuple[Excitation, Trajectory] | None:
        self.tell(Question.RUNS)
        why = ""
        hung = False
        for strength in _STRENGTHS if driven(self.model) else _STRENGTHS[-1:]:
            if hung and strength:
                continue  # waiting once is enough
            drive = replace(excitation_of(self.model), strength=strength)
            outcome = self._attempt(experiments.plain_run, drive)
            if not outcome.failure:
                self.answers[Question.RUNS] = Answer.YES
                if why:
                    part = f"varied by {strength:.0%} of the usual" if strength else "held"
                    self.reasons[Question.RUNS] = f"with inputs {part}; else: {why}"
                return drive, outcome.result
            why, hung = why or outcome.failure, outcome.hung
        self._settle(Question.RUNS, outcome)
        return None

    def _find_other(self, drive: Excitation, expected: Trajectory) -> tuple[Excitation, Trajectory]:
        other = replace(drive, seed=1)
        outcome = self._attempt(experiments.plain_run, other)
        return (drive, expected) if outcome.failure else (other, outcome.result)

    def _compare_instances(
        self, drive: Excitation, other: Excitation, expected: Trajectory, expected_other: Trajectory
    ) -> None:
        self._same(Question.RESETS, experiments.reset_run, drive, other, expected)
        self._same(Question.RENEWS, experiments.second_run, drive, other, expected)
        if self.model.capabilities.once_per_process:
            self._skip(
                "it declares that it can be instantiated only once per process", Question.COEXISTS, Question.THREADS
            )
            return
        self._same(Question.COEXISTS, experiments.runs_in_turns, drive, other, (expected, expected_other))
        if Answer.NO in (self.answers.get(Question.RENEWS), self.answers.get(Question.COEXISTS)):
            self.answers[Question.THREADS] = Answer.NO
            self.reasons[Question.THREADS] = "its instances disturb each other even without threads"
        else:
            self._same(Question.THREADS, stress.runs_in_threads, drive, other, _THREADING)

    def _compare_states(self, drive: Excitation, expected: Trajectory) -> None:
        if not self.model.capabilities.can_save_state:
            self._skip("it does not offer to", Question.SAVES, Question.SERIALIZES)
            return
        self._same(Question.SAVES, experiments.run_from_saved_state, drive, expected)
        if self.model.exchange is None:
            self._same(Question.SERIALIZES, experiments.run_from_serialized_state, drive, expected)
        else:
            self._skip("the solver's own memory is not among the FMU's bytes", Question.SERIALIZES)

    def _try_steps(self, drive: Excitation) -> None:
        if self.model.capabilities.can_handle_variable_step:
            self._same(Question.VARIES_STEP, experiments.run_in_uneven_steps, drive)
        else:
            self._skip("it does not offer to", Question.VARIES_STEP)

    def _try_inputs(self, drive: Excitation, other: Excitation) -> None:
        question = Question.FEEDS_THROUGH
        if not driven(self.model):
            self._skip("it has no inputs", question)
        elif question in self.only:
            self.tell(question)
            outcome = self._attempt(experiments.feed_through, drive, replace(other, seed=1))
            self._settle(question, outcome)
            if outcome.failure:
                self.answers[question] = Answer.UNKNOWN
            elif not outcome.result:
                self.answers[question] = Answer.NO

    def _strain(self, facts: FmuFacts, drive: Excitation) -> FmuFacts:
        if Question.LASTS in self.only:
            self.tell(Question.LASTS)
            lasted = self._attempt(stress.instances_in_a_row, drive, _STRAINING, limits=self._longer())
            self._settle(Question.LASTS, lasted)
            memory, run_growth = (nan, nan) if lasted.failure else lasted.result
            cost = self._attempt(stress.cost_of_a_step, drive, _MEASURING)
            facts = replace(
                facts,
                instances=lasted.count,
                memory=memory,
                run_growth=run_growth,
                step_cost=nan if cost.failure else cost.result,
            )
        if Question.RELOADS in self.only:
            self.tell(Question.RELOADS)
            loaded = self._attempt(experiments.load_again_and_again, _STRAINING, limits=self._longer())
            self._settle(Question.RELOADS, loaded)
            facts = replace(facts, loads=loaded.count)
        return facts

    def _same(self, question: Question, experiment: Experiment, *arguments: object, anew: bool = False) -> None:
        """Keep whether the experiment found no difference and ended well."""
        if question in self.only:
            self.tell(question)
            outcome = self._attempt(experiment, *arguments, anew=anew)
            self._settle(question, outcome, outcome.result or "")

    def _settle(self, question: Question, outcome: ExperimentOutcome, difference: str = "") -> None:
        against = outcome.failure or difference
        self.answers[question] = Answer.UNKNOWN if outcome.unclear else Answer.NO if against else Answer.YES
        if against:
            self.reasons[question] = against

    def _skip(self, why: str, *questions: Question) -> None:
        for question in questions:
            self.answers[question], self.reasons[question] = Answer.UNKNOWN, why

    def _attempt(
        self, experiment: Experiment, *arguments: object, limits: ProbeLimits | None = None, anew: bool = False
    ) -> ExperimentOutcome:
        limits = limits or self.limits
        return attempt(experiment, self.model, *arguments, limits=limits, anew=anew, sandboxed=self.sandboxed)

    def _longer(self) -> ProbeLimits:
        return replace(self.limits, time=self.limits.time + _STRAINING)
