"""What decides a run's result changes its address, and nothing else does."""

from __future__ import annotations

import importlib
import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from example_study import small_study
from hypothesis import given, settings, strategies as st

from dse.domain.bench import TestBench
from dse.domain.facts import Answer, FmuFacts, Question
from dse.domain.fmu import FmiInterface
from dse.domain.method import Algorithm, Coupling, Method
from dse.domain.study import Study
from dse.domain.system import Conversion, Element
from dse.loading import Workspace
from dse.metrics import Argument, Wants, compile_metrics, metric_function, same
from dse.testbench import PreparedBench, address_of, prepare_study
from dse.testbench.address import _code_of
from dse.testbench.definition import define

ROOT = Path(__file__).parents[2]

Change = Callable[[PreparedBench], PreparedBench]


@pytest.fixture(scope="module")
def study(tmp_path_factory) -> Study:
    folder = tmp_path_factory.mktemp("work")
    for name in ("components", "designs", "testbenches"):
        shutil.copytree(ROOT / name, folder / name)
    (folder / "small.pet.yaml").write_text(small_study(3, 2), encoding="utf-8")
    return Workspace.around(folder).study(str(folder / "small.pet.yaml"))


@pytest.fixture(scope="module")
def prepared(study, tmp_path_factory, built_before) -> Iterator[PreparedBench]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DSE_CACHE", str(built_before(tmp_path_factory.mktemp("cache"))))
        (bench,) = prepare_study(study).benches.values()
        yield bench


def key_of(prepared: PreparedBench) -> str:
    address = address_of(prepared)
    assert address is not None
    return address.key


def of_simulation(**changes: object) -> Change:
    return lambda p: replace(p, simulation=replace(p.simulation, **changes))


def of_method(**changes: object) -> Change:
    return of_simulation(method=replace(Method(), **changes))


def of_element(change: Callable[[Element], Element]) -> Change:
    def made(p: PreparedBench) -> PreparedBench:
        first, *others = p.system.elements
        return replace(p, system=replace(p.system, elements=(change(first), *others)))

    return made


def of_model(**changes: object) -> Change:
    return of_element(lambda element: replace(element, model=replace(element.model, **changes)))


def of_first_check(**changes: object) -> Change:
    def made(p: PreparedBench) -> PreparedBench:
        first, *others = p.program.checks
        return replace(p, program=replace(p.program, checks=(replace(first, **changes), *others)))

    return made


def of_program(**changes: Callable[[PreparedBench], object]) -> Change:
    return lambda p: replace(p, program=replace(p.program, **{name: make(p) for name, make in changes.items()}))


DECIDES: dict[str, Change] = {
    "another FMU": of_model(content_hash="0" * 64),
    "another interface": of_model(interface=FmiInterface.MODEL_EXCHANGE),
    "a text": of_element(lambda e: replace(e, texts={"file": "a.txt"})),
    "a binary": of_element(lambda e: replace(e, texts={"file": b"a.txt"})),
    "a conversion": of_element(lambda e: replace(e, conversions={"gap": Conversion(factor=2.0)})),
    "an output that is read": of_element(lambda e: replace(e, outputs=e.outputs[1:])),
    "a wire less": lambda p: replace(p, system=replace(p.system, wires=p.system.wires[1:])),
    "a wire's factor": lambda p: replace(
        p, system=replace(p.system, wires=(replace(p.system.wires[0], factor=2.0), *p.system.wires[1:]))
    ),
    "the stop": of_simulation(stop=59.0),
    "the step": of_simulation(step=0.02),
    "what FMUs are told": of_simulation(tolerance=1e-7),
    "the half step": of_simulation(check_step=True),
    "the times of waveforms": of_simulation(record_every=0.2),
    "the algorithm": of_method(algorithm=Algorithm.GAUSS_SEIDEL),
    "the coupling": of_method(coupling=Coupling.PROPAGATE),
    "the step of a part": of_method(steps={"sensor": 0.02}),
    "what is kept": lambda p: replace(p, recording=replace(p.recording, kept=p.recording.kept[1:])),
    "a bound": of_first_check(at_most=0.5),
    "another kind of bound": of_first_check(at_most=None, at_least=0.001),
    "no condition": of_first_check(exercised=None, condition_metrics=()),
    "a requirement's metric": of_first_check(metric=0),
    "a requirement's name": of_first_check(requirement="R9"),
    "a number in a formula": of_program(
        literals=lambda p: ((p.program.literals[0][0], 0.123), *p.program.literals[1:])
    ),
    "another function": of_program(
        instructions=lambda p: (replace(p.program.instructions[0], function=np.min), *p.program.instructions[1:])
    ),
    "a metric's name": of_program(metrics=lambda p: {f"{name}_": at for name, at in p.program.metrics.items()}),
}

SAME: dict[str, Change] = {
    "places of files": of_model(
        archive=Path("/elsewhere/x.fmu"), folder=Path("/elsewhere"), library=Path("/elsewhere/x.so")
    ),
    "titles of FMUs": of_model(title="another"),
    "the system's name": lambda p: replace(p, system=replace(p.system, name="another")),
    "the configuration's id": lambda p: replace(p, configuration=replace(p.configuration, choices={"a": "b"})),
    "the order of wires": lambda p: replace(p, system=replace(p.system, wires=p.system.wires[::-1])),
    "the order of settings": lambda p: replace(p, settings=dict(reversed(p.settings.items()))),
    "the order of columns": lambda p: replace(p, recording=replace(p.recording, kept=p.recording.kept[::-1])),
    "the order of checks": of_program(checks=lambda p: p.program.checks[::-1]),
    "limits": of_simulation(timeout=1.0, memory=1e9, where=None),
    "threads": lambda p: replace(p, thread_safe=not p.thread_safe),
    "facts": lambda p: replace(
        p, facts={p.system.elements[0].name: FmuFacts("", "", "", 2, "", {Question.RESETS: Answer.NO})}
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SAME)
def test_what_decides_nothing_does_not_matter(prepared, name):
    assert address_of(SAME[name](prepared)) == address_of(prepared)


@given(data=st.data())
@settings(max_examples=100)
def test_each_thing_that_decides_matters_whatever_else_is_changed(prepared, data):
    idle = data.draw(st.lists(st.sampled_from(sorted(SAME)), unique=True))
    one, two = data.draw(st.lists(st.sampled_from(sorted(DECIDES)), min_size=2, max_size=2, unique=True))
    keys = []
    for changes in ([], [one], [two]):
        changed = prepared
        for name in changes:
            changed = DECIDES[name](changed)
        keys.append(key_of(changed))
        for name in idle:
            changed = SAME[name](changed)
        assert key_of(changed) == keys[-1]
    assert len(set(keys)) == 3


@pytest.mark.parametrize("name", DECIDES)
def test_each_thing_that_decides_matters(prepared, name):
    assert key_of(DECIDES[name](prepared)) != key_of(prepared)


@pytest.mark.usefixtures("prepared")  # FMUs built once
def test_what_fmus_are_told_reaches_them_and_is_kept_with_the_study(study):
    told = replace(study, bench=replace(study.bench, simulation=replace(study.bench.simulation, tolerance=1e-8)))
    benches = prepare_study(told).benches
    assert {e.model.experiment.tolerance for bench in benches.values() for e in bench.system.elements} == {1e-8}
    assert define(told, benches).simulation.method == {"fmu_tolerance": 1e-8}


def test_the_order_of_metrics_does_not_matter(study, prepared):
    def program(bench: TestBench) -> PreparedBench:
        types = {name: setting.type for name, setting in prepared.settings.items()}
        from dse.testbench.wired_bench import wire_bench

        wired = wire_bench(bench, prepared.configuration)
        made = compile_metrics(bench.metrics, bench.requirements, types | wired.types, frozenset(wired.signals))
        return replace(prepared, program=made)

    bench = study.bench
    turned = replace(bench, metrics=bench.metrics[::-1], requirements=bench.requirements[::-1])
    assert key_of(program(turned)) == key_of(program(bench)) == key_of(prepared)
    assert program(turned).program.metrics != program(bench).program.metrics


def test_a_run_has_one_name_whether_a_value_is_the_benchs_or_the_points(study, prepared):
    """The same values, once as the point of a study, once as what the bench says."""
    name, setting = "controller.kp_speed", 2.5
    address = address_of(prepared)
    assert address is not None
    by_point = address.of([name], np.array([[setting]]))
    told = replace(study, bench=replace(study.bench, parameters={**study.bench.parameters, name: setting}))
    (other,) = prepare_study(told).benches.values()
    by_bench = address_of(other)
    assert by_bench is not None
    assert by_bench.key == address.key
    assert by_bench.of([], np.zeros((1, 0))).tolist() == by_point.tolist()
    assert by_point.tolist() != address.of([], np.zeros((1, 0))).tolist()


def test_a_value_that_metrics_use_matters_to_them(prepared):
    """A target is no input of an FMU where it is only compared with; it names the run all the same."""
    address = address_of(prepared)
    assert address is not None
    assert len(address.places["controller.set_speed"]) == 2


def test_runs_that_hang_on_more_than_is_known_have_no_address(prepared):
    tool = of_element(
        lambda e: replace(e, model=replace(e.model, capabilities=replace(e.model.capabilities, needs_tool=True)))
    )
    assert address_of(tool(prepared)) is None
    name = prepared.system.elements[0].name
    chance = FmuFacts("", "", "", 2, "", {Question.REPEATS: Answer.NO})
    assert address_of(replace(prepared, facts={name: chance})) is None


def test_of_a_file_that_a_text_names_the_content_matters(prepared, tmp_path):
    def key(place: str, content: str) -> str:
        (tmp_path / place).write_text(content, encoding="utf-8")
        return key_of(of_element(lambda e: replace(e, texts={"file": str(tmp_path / place)}))(prepared))

    assert key("one.csv", "1,2") == key("two.csv", "1,2") != key("one.csv", "1,3")


def test_the_code_of_a_metric_function_matters(prepared, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))

    def key(body: str) -> str:
        (tmp_path / "changing_peak.py").write_text(f"def peak(x):\n    return {body}\n", encoding="utf-8")
        sys.modules.pop("changing_peak", None)
        importlib.invalidate_caches()
        _code_of.cache_clear()
        function = importlib.import_module("changing_peak").peak
        assert metric_function(function, [Argument("x", Wants.WAVEFORM, any_unit=True)], same)
        first, *others = prepared.program.instructions
        return key_of(
            replace(
                prepared, program=replace(prepared.program, instructions=(replace(first, function=function), *others))
            )
        )

    one, two, again = key("x.max()"), key("float(x.max())"), key("x.max()")
    assert one == again != two
