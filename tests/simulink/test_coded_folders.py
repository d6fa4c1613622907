"""What lies around a model: what it refers to, shares, calls and leaves out, and how long it says that it steps."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Callable, Mapping
from pathlib import Path

import coded_texts as texts
import coded_trees as trees
import pytest
from coded_copies import Copy
from workspaces import written

from dse.errors import DseError
from dse.simulink import Style, build_library, read_model

pytest.importorskip("clang.cindex")

U = [2.0 + (k % 5) for k in range(30)]


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


def outputs(folder: Path, cache: Path, sources: tuple[Path, ...] = ()) -> list[float]:
    model = read_model(folder, step=texts.STEP, sources=sources)
    # A new file each time: those before stay loaded.
    copy = Copy(model, build_library(model, cache=cache), cache / f"{len(list(cache.glob('*.so')))}.so")
    copy.start()
    enabled = {"enable": 1.0} if any(port.name == "enable" for port in model.interface.inputs) else {}
    found = [copy.step(speed=u, **enabled)["filtered"] for u in U]
    copy.end()
    return found


LAG = pytest.approx(texts.lag(U), rel=1e-12, abs=1e-12)


def test_a_unit_whose_header_needs_what_is_not_there_is_left_out(tmp_path: Path, cache: Path) -> None:
    assert outputs(written(tmp_path, trees.with_board()), cache) == LAG


def test_what_was_left_out_is_told_with_what_calls_it(tmp_path: Path, cache: Path) -> None:
    with pytest.raises(DseError) as raised:
        outputs(written(tmp_path, trees.that_blinks()), cache)
    told = str(raised.value)
    assert "'blink' is called but not defined" in told
    assert "board.h:1:10: the code includes 'stm32f4xx.h'" in told
    assert "drivers of a board" in told


def test_logs_and_external_mode_do_nothing_and_no_time_ends_the_run(tmp_path: Path, cache: Path) -> None:
    assert outputs(written(tmp_path, trees.logged(final=3 * texts.STEP)), cache) == LAG


def test_logs_that_the_folder_declares_do_nothing_either(tmp_path: Path, cache: Path) -> None:
    assert outputs(written(tmp_path, trees.with_own_headers()), cache) == LAG


def test_variables_that_the_code_leaves_to_others_are_ports_and_parameters(tmp_path: Path, cache: Path) -> None:
    model = read_model(written(tmp_path, trees.imported()), step=texts.STEP)
    made = model.interface
    assert [(port.name, port.expression) for port in made.inputs] == [("speed", "speed"), ("enable", "(*enable)")]
    assert [port.name for port in made.parameters] == ["Gain"]
    assert made.warnings == ["the value of 'Gain' is not in the code: it begins as 0"]
    copy = Copy(model, build_library(model, cache=cache), tmp_path / "copy.so")
    assert copy.parameter("Gain") == 0.0
    copy.start(Gain=texts.GAIN)
    assert [copy.step(speed=u, enable=1.0)["filtered"] for u in U] == LAG


def test_variables_that_a_source_defines_keep_its_values(tmp_path: Path, cache: Path) -> None:
    folder = written(tmp_path / "lag", trees.imported())
    own = written(tmp_path, {"values.c": f"double Gain = {texts.GAIN};\n"}) / "values.c"
    assert outputs(folder, cache, (own,)) == LAG


@pytest.mark.parametrize("files", [trees.written_elsewhere(), trees.told_by_comments()])
def test_which_way_a_variable_goes_is_told_by_the_models_own_code(
    files: Mapping[str, str], tmp_path: Path, cache: Path
) -> None:
    made = read_model(written(tmp_path, files), step=texts.STEP).interface
    assert [[port.name for port in ports] for ports in (made.inputs, made.outputs)] == [
        ["speed", "enable"],
        ["filtered"],
    ]
    assert outputs(tmp_path, cache) == LAG


@pytest.mark.parametrize("target", ["ert", "grt", "ert_shrlib"])
def test_models_that_a_model_refers_to_are_found_beside_it(target: str, tmp_path: Path, cache: Path) -> None:
    top = written(tmp_path, trees.referring(target)) / f"lag_{target}_rtw"
    model = read_model(top, step=texts.STEP)
    assert set(model.folder.places) == {f"slprj/{target}/_sharedutils", f"slprj/{target}/child"}
    assert outputs(top, cache) == LAG


def test_a_model_that_others_refer_to_is_no_model_by_itself(tmp_path: Path) -> None:
    tree = written(tmp_path, trees.referring())
    with pytest.raises(DseError, match="no model that Simulink's coder wrote"):
        read_model(tree / "slprj/ert/child")
    (tree / "slprj/ert/child/child.h").unlink()
    with pytest.raises(DseError, match=r"lag\.h:\d+:\d+: the code includes 'child\.h'"):
        read_model(tree / trees.TOP)


def test_code_without_any_trace_of_the_coder_is_refused_with_the_option_that_imports_it(tmp_path: Path) -> None:
    bare = {file: re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL) for file, text in texts.whole_program().items()}
    folder = written(tmp_path, {file: text.replace("RTW_HEADER_", "MY_") for file, text in bare.items()})
    with pytest.raises(DseError, match=r"no model that Simulink's coder wrote.*\n.*if it is lag: --model lag"):
        read_model(folder)
    assert read_model(folder, "lag", step=texts.STEP).interface.inputs


@pytest.mark.thorough
def test_the_users_functions_are_found_in_the_sources_that_are_given(tmp_path: Path, cache: Path) -> None:
    tree = written(tmp_path, trees.calling())
    with pytest.raises(DseError, match=r"lag\.c:\d+:\d+: the code includes 'users\.h'.*\n.*sources: "):
        outputs(tree / trees.TOP, cache)
    assert outputs(tree / trees.TOP, cache, (tree / "mine",)) == LAG
    assert outputs(tree / trees.TOP, cache, (tree / "mine/users.h", tree / "mine/users.c")) == LAG
    with pytest.raises(DseError, match="'users_gain' is called but not defined"):
        outputs(tree / trees.TOP, cache, (tree / "mine/users.h",))
    with pytest.raises(DseError, match=r"yours: there is no such file or folder"):
        read_model(tree / trees.TOP, sources=(tree / "yours",), step=texts.STEP)


def test_a_source_of_the_user_that_does_not_compile_is_not_left_out(tmp_path: Path, cache: Path) -> None:
    tree = written(tmp_path, trees.calling())
    (tree / "mine/more.c").write_text("int broken(void) {\n", encoding="utf-8")
    with pytest.raises(DseError, match=r"mine/more\.c:\d+:\d+: "):
        outputs(tree / trees.TOP, cache, (tree / "mine",))


def test_the_same_file_in_two_places_is_compiled_once(tmp_path: Path, cache: Path) -> None:
    tree = written(tmp_path, trees.calling())
    for name in ("users.c", "users.h"):
        (tree / trees.TOP / name).write_bytes((tree / "mine" / name).read_bytes())
    assert outputs(tree / trees.TOP, cache, (tree / "mine",)) == LAG


def test_code_that_makes_its_own_memory_is_let_make_and_free_it(tmp_path: Path, cache: Path) -> None:
    model = read_model(written(tmp_path, trees.constructed()), step=texts.STEP)
    made = model.interface
    assert (made.style, made.terminate) == (Style.REUSABLE, "lag_terminate(m->made)")
    assert [port.name for port in (*made.inputs, *made.outputs, *made.parameters)] == [
        "speed",
        "enable",
        "filtered",
        "Gain",
    ]
    assert outputs(tmp_path, cache) == LAG


def test_a_signal_that_comes_from_zero_rises_once(tmp_path: Path, cache: Path) -> None:
    model = read_model(written(tmp_path, trees.triggered()), step=texts.STEP)
    copy = Copy(model, build_library(model, cache=cache), tmp_path / "copy.so")
    copy.start()
    found = [copy.step(speed=u) for u in (1, -1, 0, 1, 0, 1, -1, 1)]
    assert [each["risen"] for each in found] == [0, 0, 1, 1, 1, 2, 2, 3]
    assert [each["fallen"] for each in found] == [0, 1, 1, 1, 2, 2, 3, 3]


def test_code_without_comments_is_known_by_its_guard(tmp_path: Path, cache: Path) -> None:
    bare = {name: re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL) for name, text in texts.whole_program().items()}
    assert read_model(written(tmp_path, bare), step=texts.STEP).folder.model == "lag"
    with pytest.raises(DseError, match="nothing in the code gives the length of a step"):
        read_model(tmp_path)


def test_a_model_without_ports_says_so(tmp_path: Path) -> None:
    files = dict(texts.whole_program())
    files["lag.h"] = files["lag.h"].replace("ExtU_lag_T", "A_lag_T").replace("ExtY_lag_T", "Z_lag_T")
    files["lag.c"] = files["lag.c"].replace("ExtU_lag_T", "A_lag_T").replace("ExtY_lag_T", "Z_lag_T")
    assert "no ports" in read_model(written(tmp_path, files), step=texts.STEP).interface.warnings[0]


def rated(*periods: str) -> dict[str, str]:
    files = dict(texts.two_rates())
    for place, period in enumerate(periods):
        files["lag.c"] = re.sub(rf"(step{place}\(void\).*?\[)[^\]]*", rf"\g<1>{period}", files["lag.c"])
    return files


def test_rates_that_are_no_multiples_run_on_what_they_have_in_common(tmp_path: Path, cache: Path) -> None:
    model = read_model(written(tmp_path, rated("0.2s, 0.0s", "0.3s, 0.0s")), step=0.1)
    assert (model.timing.step, model.timing.rates) == (0.1, (2, 3))
    copy = Copy(model, build_library(model, cache=cache), tmp_path / "copy.so")
    copy.start()
    found = [copy.step(speed=1.0) for _ in range(7)]
    assert [each["quick"] for each in found] == [1, 1, 2, 2, 3, 3, 4]
    assert [each["slow"] for each in found] == [1, 1, 1, 2, 2, 2, 4]


def test_all_tasks_run_of_a_step_that_is_told_which(tmp_path: Path, cache: Path) -> None:
    model = read_model(written(tmp_path, trees.tasks()))
    assert (model.timing.step, model.timing.rates) == (0.1, (1, 3))
    copy = Copy(model, build_library(model, cache=cache), tmp_path / "copy.so")
    copy.start()
    found = [copy.step(speed=1.0) for _ in range(5)]
    assert [each["quick"] for each in found] == [1, 2, 3, 4, 5]
    assert [each["slow"] for each in found] == [1, 1, 1, 4, 4]


def test_the_first_of_several_rates_may_integrate(tmp_path: Path, cache: Path) -> None:
    files = {name: text.replace("lag_step(", "lag_step0(") for name, text in texts.continuous(3).items()}
    files["lag.h"] = files["lag.h"].replace(
        "extern void lag_step0(void);", "extern void lag_step0(void);\nextern void lag_step1(void);"
    )
    files["lag.c"] = files["lag.c"].replace(
        "void lag_step0(void)\n", "void lag_step0(void) /* Sample time: [0.1s, 0.0s] */\n"
    )
    files["lag.c"] += "void lag_step1(void) /* Sample time: [0.2s, 0.0s] */\n{\n}\n"
    assert outputs(written(tmp_path, files), cache) == pytest.approx(texts.lag_by_ode(3, U), rel=1e-12, abs=1e-12)


def test_a_solver_that_is_not_found_is_warned_of(tmp_path: Path) -> None:
    files = {name: text.replace("solverInfo", "itsSolver") for name, text in texts.continuous(1).items()}
    assert "its solver was not found" in read_model(written(tmp_path, files)).interface.warnings[-1]


def test_rates_that_a_main_program_schedules_are_refused(tmp_path: Path) -> None:
    files = dict(texts.whole_program())
    macro = "#define rtmIsSampleHit(rtm, sti, tid) ((rtm)->Timing.sampleHits[(rtm)->Timing.sampleTimeTaskIDPtr[sti]])\n"
    files["lag.h"] = files["lag.h"].replace("typedef struct", macro + "typedef struct", 1)
    files["lag.c"] = files["lag.c"].replace("if (lag_U.enable)", "if (rtmIsSampleHit(lag_M, 1, 0))")
    with pytest.raises(DseError, match="a main program that is not here determines when its rates run"):
        read_model(written(tmp_path, files))


def test_functions_for_others_to_call_are_no_step(tmp_path: Path) -> None:
    files = {name: text.replace("lag_step", "trigger") for name, text in texts.whole_program().items()}
    (tmp_path / "ert_main.c").write_text('#include "lag.h"\n', encoding="utf-8")
    with pytest.raises(DseError, match="'lag' has no step: it exports functions for others to call: trigger"):
        read_model(written(tmp_path, files))


@pytest.mark.parametrize(
    ("header", "hint"),
    [
        ("lag_types.h", "take all that was generated: this folder, and slprj beside it"),
        ("simstruc.h", "it needs S-functions, which MATLAB runs"),
        ("nesl_rtw.h", "it needs Simscape's run-time library"),
        ("MW_SPI.h", "it needs drivers of a board"),
        ("mine.h", "name where it is: sources"),
    ],
)
def test_headers_that_are_not_there_are_told_with_what_needs_them(header: str, hint: str, tmp_path: Path) -> None:
    files = dict(texts.whole_program())
    files["lag.h"] = files["lag.h"].replace('#include "rtwtypes.h"', f'#include "rtwtypes.h"\n#include "{header}"')
    with pytest.raises(DseError, match=rf"lag\.h:\d+:\d+: the code includes '{header}'") as raised:
        read_model(written(tmp_path, files))
    assert hint in str(raised.value)


@pytest.mark.parametrize(
    ("periods", "step", "told"),
    [
        (("0.2s, 0.0s", "0.3s, 0.1s"), None, r"'lag_step1' runs every 0\.3 s, but first at 0\.1 s"),
        (("0.1s, 0.0s", "0.1000001s, 0.0s"), None, r"no step in common: 0\.1 s, 0\.1"),
        (("0.1s, 0.0s", "-1.0s, 0.0s"), None, "nothing in the code gives how often 'lag_step1' runs"),
        (("0.1s, 0.0s", "0.2s, 0.0s"), 0.2, r"need a step of 0\.1 s, but 'step' gives 0\.2 s"),
    ],
)
def test_rates_that_cannot_be_run_are_refused(
    periods: tuple[str, str], step: float | None, told: str, tmp_path: Path
) -> None:
    with pytest.raises(DseError, match=told):
        read_model(written(tmp_path, rated(*periods)), step=step)


def test_functions_without_comments_run_at_the_steps_that_are_given(tmp_path: Path, cache: Path) -> None:
    model = read_model(written(tmp_path, texts.uncommented_rates()), rates={"lag_step0": 0.02, "lag_step1": 0.05})
    assert (model.timing.step, model.timing.rates, model.timing.source) == (0.01, (2, 5), "'steps'")
    assert not model.interface.warnings
    copy = Copy(model, build_library(model, cache=cache), tmp_path / "copy.so")
    copy.start()
    found = [copy.step(speed=1.0) for _ in range(11)]
    assert [each["quick"] for each in found] == [1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6]
    assert [each["slow"] for each in found] == [1, 1, 1, 1, 1, 3, 3, 3, 3, 3, 6]


@pytest.mark.parametrize(
    ("files", "rates", "told"),
    [
        (
            texts.uncommented_rates,
            {"lag_step0": 0.02},
            r"'lag_step1' runs\n.*steps: {lag_step0: 0\.02 s, lag_step1: TIME} ",
        ),
        (
            texts.uncommented_rates,
            {"lag_step0": 0.02, "lag_stpe1": 0.05},
            r"'lag_stpe1' is not a .*\n.*did you mean 'lag_step1'",
        ),
        (texts.two_rates, {"lag_step0": 0.02}, r"a step of 0\.1 s for 'lag_step0', but 'steps' gives 0\.02 s"),
        (texts.whole_program, {"lag_step": 0.02}, "no function of its own for each rate, so 'lag_step' has no step"),
    ],
)
def test_steps_that_do_not_fit_the_functions_are_refused_by_name(
    files: Callable[[], Mapping[str, str]], rates: Mapping[str, float], told: str, tmp_path: Path
) -> None:
    with pytest.raises(DseError, match=told):
        read_model(written(tmp_path, files()), rates=rates)


def descriptor(folder: Path, *rows: tuple[float, float, int]) -> None:
    with sqlite3.connect(folder / "codedescriptor.dmr") as base:
        base.execute('create table "C$TimingInterface$1" ("P$SamplePeriod", "P$SampleOffset", "P$TimingMode")')
        base.executemany('insert into "C$TimingInterface$1" values (?, ?, ?)', rows)
    base.close()


def test_a_step_that_only_a_comment_tells_has_to_be_said(tmp_path: Path) -> None:
    folder = written(tmp_path, texts.whole_program())
    with pytest.raises(DseError, match=r"that it steps every 0\.1 s is only in the comment of its step") as caught:
        read_model(folder)
    hint = "set the model's step, if that is right: step: 0.1 s (import: --step)"
    assert caught.value.problems[0].hint == hint
    assert not read_model(folder, step=0.1).interface.warnings
    descriptor(folder, (0.1, 0.0, 2), (0.0, 0.0, 3))
    model = read_model(folder)
    assert (model.timing.source, model.interface.warnings) == ("codedescriptor.dmr", [])


@pytest.mark.parametrize(
    "said",
    [
        "period 0.02 seconds (the model's base sample time)",
        "period 0.02 seconds (the\n * model's base sample time)",
        "period 0.02 seconds (base rate of the model)",
    ],
)
def test_the_main_program_of_a_model_tells_its_base_rate(tmp_path: Path, said: str) -> None:
    main = f"/*\n * Attach this to a timer with {said}.\n */\n"
    files = {**texts.whole_program(), "ert_main.c": f'{main}#include "lag.h"\nint main(void) {{ return 0; }}\n'}
    timing = read_model(written(tmp_path, files)).timing
    assert (timing.step, timing.source) == (0.02, "its main program")
    other = {**files, "lag.h": files["lag.h"], "ert_main.c": files["ert_main.c"].replace('"lag.h"', '"other.h"')}
    with pytest.raises(DseError, match="is only in the comment of its step"):
        read_model(written(tmp_path / "other", other))


def test_a_parameter_with_a_long_comment_is_found(tmp_path: Path) -> None:
    files = dict(texts.exported())
    places = "\n".join(f" * '<S{n}>/A block with a name of its own'" for n in range(40))
    files["lag.h"] = files["lag.h"].replace("* Referenced by: '<Root>/Gain'", f"* Referenced by:\n{places}")
    made = read_model(written(tmp_path, files), step=texts.STEP).interface
    assert [port.name for port in made.parameters] == ["Gain"]


def test_the_base_of_several_periods_is_what_they_have_in_common(tmp_path: Path) -> None:
    folder = written(tmp_path, texts.whole_program())
    descriptor(folder, (0.2, 0.0, 2), (0.3, 0.0, 2), (float("inf"), 0.0, 2), (0.05, 0.0, 3))
    assert read_model(folder).timing.step == pytest.approx(0.1, rel=1e-15)


def test_a_descriptor_and_a_scheduler_that_disagree_are_refused(tmp_path: Path) -> None:
    folder = written(tmp_path, texts.scheduled())
    descriptor(folder, (0.5, 0.0, 2))
    with pytest.raises(DseError, match=r"several steps: 0\.5 s \(codedescriptor\.dmr\), 0\.1 s \(its scheduler\)"):
        read_model(folder)
    assert read_model(folder, step=0.1).timing.step == 0.1
