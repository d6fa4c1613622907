"""Components of the kind simulink: ports by name, units, ranges, items, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import coded_texts as texts
import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from dse.domain.component import Causality, Component, Interface, Kind, Port, Type
from dse.errors import DseError
from dse.fmu.component_build import build
from dse.kinds._coded import Code, coded_files
from dse.loading.component.kind import KINDS
from dse.testing.kinds import lay_out, the_component

pytest.importorskip("clang.cindex")

INTERFACES = """\
interfaces:
  lag: {inputs: {u: m/s, on: bool}, outputs: {y: m/s, n: int}}
  machine:
    inputs: {speed: m/s, mode: "enum[Quick, Off, Slow]", small: int}
    outputs: {doubled: m/s, same: "enum[Off, Quick, Slow]", told: int}
"""
LAG = """\
component: lag
implements: lag
source: {kind: simulink, folder: lag_ert_rtw, step: 100 ms%s}
map: {u: speed, on: enable, y: filtered, n: count, gain: Gain}
parameters: {gain: {start: 2}}
"""
MACHINE = """\
component: machine
implements: machine
source: {kind: simulink, folder: lag_ert_rtw, step: 100 ms%s}
"""


def component(folder: Path, text: str, files: texts.Files, interfaces: str = INTERFACES) -> Any:
    part = text.split()[1]
    code = {f"{part}/lag_ert_rtw/{name}": content for name, content in files.items()}
    return the_component(lay_out({"interfaces.yaml": interfaces, f"{part}/component.yaml": text, **code}, folder))


def answers(
    component: Any,
    cache: Path,
    inputs: dict[str, list[float]],
    *outputs: str,
    told: list[str] | None = None,
    **starts: Any,
) -> np.ndarray:
    """One row a step: what another program gets of the FMU at the end of each; what it says is *told*."""
    said = [] if told is None else told
    fmu = build(component, cache=cache)
    count = len(next(iter(inputs.values())))
    kinds = {name: bool if isinstance(values[0], bool) else type(values[0]) for name, values in inputs.items()}
    rows = np.zeros(count, dtype=[("time", float), *((name, np.dtype(kind)) for name, kind in kinds.items())])
    rows["time"] = texts.STEP * np.arange(count)
    for name, values in inputs.items():
        rows[name] = values
    found = fmpy.simulate_fmu(
        str(fmu),
        stop_time=texts.STEP * count,
        output_interval=texts.STEP,
        input=rows,
        output=list(outputs),
        start_values=starts,
        logger=lambda _environment, _instance, _status, _category, message: said.append(message.decode()),
        fmi_type="CoSimulation",
    )
    return np.array([list(row)[1:] for row in found[1:]])


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


U = [0.5 * k for k in range(20)]


def test_ports_and_parameters_are_found_by_the_map_and_begin_with_their_values(tmp_path: Path, cache: Path) -> None:
    made = component(tmp_path, LAG % "", texts.whole_program())
    found = answers(made, cache, {"speed": U, "enable": [True] * 20}, "filtered", "count")
    assert found[:, 0] == pytest.approx(texts.lag(U, 2.0), rel=1e-12, abs=1e-12)
    assert list(found[:, 1]) == list(range(1, 21))
    tuned = answers(made, cache, {"speed": U, "enable": [True] * 20}, "filtered", Gain=5.0)
    assert tuned[:, 0] == pytest.approx(texts.lag(U, 5.0), rel=1e-12, abs=1e-12)


def test_numbers_in_the_code_have_the_unit_that_the_source_says(tmp_path: Path, cache: Path) -> None:
    made = component(tmp_path, LAG % ", in_code: {u: {unit: km/h}, y: {unit: km/h}}", texts.whole_program())
    found = answers(made, cache, {"speed": U, "enable": [True] * 20}, "filtered")
    # In is SI, in the code km/h, out is SI again.
    assert found[:, 0] == pytest.approx(texts.lag(U, 2.0), rel=1e-12, abs=1e-12)
    one = component(tmp_path / "one", LAG % ", in_code: {u: {unit: km/h}}", texts.whole_program())
    found = answers(one, cache, {"speed": U, "enable": [True] * 20}, "filtered")
    assert found[:, 0] == pytest.approx(texts.lag([3.6 * u for u in U], 2.0), rel=1e-12, abs=1e-12)


def test_fixed_point_has_the_scale_that_is_said_and_items_are_found_by_name(tmp_path: Path, cache: Path) -> None:
    scales = ", in_code: {speed: {scale: 0.0078125}, doubled: {scale: 0.0078125}}"
    made = component(tmp_path, MACHINE % scales, texts.whole_numbers())
    speeds = [0.5 * k for k in range(9)]
    found = answers(
        made, cache, {"speed": speeds, "mode": [0, 1, 2] * 3, "small": [255] * 9}, "doubled", "same", "told"
    )
    assert list(found[:, 0]) == [2 * speed for speed in speeds]  # all are whole multiples of 1/128
    assert list(found[:, 1]) == [1, 0, 2] * 3  # the same items, which the two types count otherwise
    assert list(found[:, 2]) == [255] * 9


@pytest.mark.parametrize(
    ("inputs", "what"),
    [
        ({"small": [256]}, "'small' is not between 0 and 255: it is 256"),
        ({"small": [-1]}, "'small' is not between 0 and 255: it is -1"),
        ({"mode": [3]}, "3 does not fit 'mode'"),
        ({"speed": [61.0]}, "'speed' is not between -10 and 60: it is 61"),
        ({"speed": [float("nan")]}, "'speed' is not between -10 and 60: it is nan"),
    ],
)
def test_a_value_that_means_nothing_to_the_code_ends_the_run(
    tmp_path: Path, cache: Path, inputs: dict[str, list[float]], what: str
) -> None:
    made = component(tmp_path, MACHINE % ", in_code: {speed: {min: -10, max: 60}}", texts.whole_numbers())
    told: list[str] = []
    rows = {name: 2 * values for name, values in {"speed": [1.0], "mode": [1], "small": [1], **inputs}.items()}
    with pytest.raises(FMICallException):
        answers(made, cache, rows, "told", told=told)
    assert what in "\n".join(told)


def test_what_the_model_says_of_an_error_ends_the_run(tmp_path: Path, cache: Path) -> None:
    made = component(tmp_path, LAG % "", texts.whole_program())
    told: list[str] = []
    with pytest.raises(FMICallException):
        answers(made, cache, {"speed": [1e6] * 20, "enable": [True] * 20}, "filtered", told=told)
    assert "the model reports 'over the top'" in told[0]


@pytest.mark.parametrize(
    ("text", "what", "hint"),
    [
        (LAG.replace("speed", "sped") % "", "the code has no input 'sped' for 'u'", "did you mean 'speed'?"),
        (LAG.replace("Gain", "Gian") % "", "the code has no parameter 'Gian' for 'gain'", "did you mean 'Gain'?"),
        (LAG % ", in_code: {v: {unit: m/s}}", "there is neither port nor parameter 'v'", None),
        (LAG % ", in_code: {u: {unit: kg}}", "'u' is in m/s, which kg cannot be", None),
        (LAG % ", in_code: {on: {scale: 2}}", "'on' is a bool: its numbers have neither unit nor scale", None),
        (LAG % ", in_code: {y: {max: 2}}", "'y' is an output: 'min' and 'max' are for what the code is given", None),
        (LAG % ", in_code: {u: {scale: 0}}", "the scale of 'u' is 0", None),
        (LAG % ", in_code: {u: {min: 2, max: 1}}", "'u' has a smallest value above its largest", None),
        (LAG % ", unused: [sped]", "the code has no input 'sped'", "did you mean 'speed'?"),
        (LAG % ", outputs_at: start", "'start' is neither 'end' nor 'raw'", None),
        (LAG % ", model: other", "there is no header 'other.h'", "its headers are lag.h, rtwtypes.h"),
    ],
)
def test_what_does_not_fit_the_code_is_told(
    tmp_path: Path, cache: Path, text: str, what: str, hint: str | None
) -> None:
    with pytest.raises(DseError) as caught:
        build(component(tmp_path, text, texts.whole_program()), cache=cache)
    (problem,) = caught.value.problems
    assert problem.what == what
    if hint is not None:
        assert problem.hint == hint


def test_an_input_that_nobody_gives_is_told_unless_it_is_unused(tmp_path: Path, cache: Path) -> None:
    interfaces = "interfaces:\n  lag: {inputs: {u: m/s}, outputs: {y: m/s}}\n"
    text = LAG.replace("on: enable, ", "").replace("n: count, ", "")
    with pytest.raises(DseError, match="nothing provides the code's input enable"):
        build(component(tmp_path, text % "", texts.whole_program(), interfaces), cache=cache)
    made = component(tmp_path / "other", text % ", unused: [enable]", texts.whole_program(), interfaces)
    assert list(answers(made, cache, {"speed": U}, "filtered")[:, 0]) == [0.0] * 20  # it is off


def test_a_quantity_that_is_a_whole_number_in_the_code_is_told_until_it_has_a_scale_or_a_unit(tmp_path: Path) -> None:
    def told(what: str, name: str) -> list[str]:
        made = component(tmp_path / name, MACHINE % what, texts.whole_numbers())
        return [problem.what for problem in KINDS.get("simulink", None).check(made, made.source)]

    assert told("", "one") == [
        "'speed' is a whole number in the code: without a scale it is rounded to whole units",
    ]
    assert told(", in_code: {speed: {scale: 0.0078125}}", "two") == []
    assert told(", in_code: {speed: {unit: km/h}}", "three") == []


def test_items_have_no_range(tmp_path: Path, cache: Path) -> None:
    made = component(tmp_path, MACHINE % ", in_code: {mode: {max: 1}}", texts.whole_numbers())
    with pytest.raises(DseError, match="'mode' has items, which are all there are: it has no 'min' and 'max'"):
        build(made, cache=cache)


def test_items_that_the_code_does_not_have_are_told(tmp_path: Path, cache: Path) -> None:
    interfaces = INTERFACES.replace("enum[Quick, Off, Slow]", "enum[Quik, Off]")
    with pytest.raises(DseError) as caught:
        build(component(tmp_path, MACHINE % "", texts.whole_numbers(), interfaces), cache=cache)
    (problem,) = caught.value.problems
    assert (problem.what, problem.hint) == (
        "'mode' has the item 'Quik', which Mode in the code does not have",
        "did you mean 'Quick'?",
    )


def test_functions_between_the_fmu_and_the_code_stay_short() -> None:
    # Compilers take the square of the time for twice as many statements.
    ports = [Port(f"p{n}", Causality.INPUT, Type(Kind.INTEGER)) for n in range(1000)]
    component = Component("many", Interface("many", tuple(ports)))
    code = coded_files(component, {port.name: Code(low=0.0) for port in ports}, b"")["outer.c"]
    functions = re.findall(r"^[^#\n]*\) \{\n(.*?)^\}", code, re.MULTILINE | re.DOTALL)
    assert max(text.count(";") for text in functions) <= 2 * 64
    assert [int(place) for place in re.findall(r"self->ask\[(\d+)\] = self->in.p\1;", code)] == list(range(1000))
    assert re.findall(r"^    (step_\d+)\(self\);", code, re.MULTILINE) == re.findall(
        r"static void (step_\d+)\(outer \*self\)", code
    )
