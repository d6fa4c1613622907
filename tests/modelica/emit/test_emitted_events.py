"""One pass of an event, reinit, relations, asserts: hand-made models as compiled C."""

from __future__ import annotations

import subprocess
from fractions import Fraction
from pathlib import Path

import pytest
from emitted_model import INCLUDES, Emitter
from model_maker import Maker, explicit

from dse.errors import Location
from dse.fmu.toolchain.compilation import LANGUAGE_OPTIONS
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.flat_model import Check, Clock, Reinitialization, Relation, Role, Trigger
from dse.modelica.solved_model import Activation, When

_AT = Location("ball.mo", 7, 3)


def ball() -> Maker:
    """A state h, a discrete n, relations h <= 0 and n == 2, a clock, whens of all kinds."""
    made = Maker()
    graph = made.graph
    h, n = made.variable("h"), made.variable("n", Role.DISCRETE)
    made.variable("d", Role.DISCRETE)
    made.states.append(Symbol("h"))
    held = graph.symbol(Symbol("0", referent=Referent.HELD))
    pre_n = graph.symbol(Symbol("n", referent=Referent.PRE))
    pre_h = graph.symbol(Symbol("h", referent=Referent.PRE))
    made.flat = {
        "relations": (
            Relation(graph.make("less_equal", h, graph.constant(0)), _AT),
            Relation(graph.make("equal", n, graph.constant(2))),
        ),
        "clocks": (Clock(Fraction(1, 10), Fraction(1, 4)),),
        "triggers": (
            Trigger((held,)),
            Trigger((), (0,)),
            Trigger((graph.make("greater", n, graph.constant(5)),), (), True),
        ),
        "reinitializations": (
            Reinitialization("h", -pre_h * 0.5, 0),
            Reinitialization("h", graph.constant(9.0), 1),
        ),
        "checks": (
            Check(graph.make("greater", h, graph.constant(-100)), 'h "left" the\nworld \\ ä ??/', where=_AT),
            Check(graph.make("less", h, graph.constant(50)), "high", is_warning=True),
            Check(graph.constant(0), "done", trigger=1, terminates=True),
        ),
    }
    made.put("derivatives", explicit("h", graph.constant(-1.0), 1))
    made.put(
        "event",
        Activation(0),
        Activation(1),
        When(Symbol("n"), ((0, pre_n + 1.0), (1, pre_n + 10.0))),
        Activation(2),
        When(Symbol("d"), ((2, n * 2.0), (None, graph.constant(-1.0)))),
    )
    made.put("initial", explicit("h", graph.constant(1.0)), When(Symbol("n"), ()), Activation(2))
    made.put("initial", When(Symbol("d"), ((2, n + 1.0), (None, graph.constant(-1.0)))))
    made.put("guesses", explicit("n", graph.constant(4.0)))
    return made


def test_whens_triggers_and_clocks_make_one_pass_of_an_event(emitted: Emitter) -> None:
    model = emitted(ball().solved())
    n, d = Symbol("n"), Symbol("d")
    model.start()
    pre, ticks, held = model.doubles("pre"), model.flags("ticks"), model.flags("held")
    is_true, was_true, is_active = model.flags("is_true"), model.flags("was_true"), model.flags("is_active")
    assert model.get(n) == 4.0
    pre[0] = 4.0
    held[0] = 1
    assert model.call("initial") == 0
    # The memory of all conditions is set; only what is active at the start is.
    assert (is_true[0], is_true[1]) == (1, 0)
    assert list(is_active[:3]) == [0, 0, 1]
    assert (model.get(n), model.get(d)) == (4.0, 5.0)
    was_true[0], was_true[1] = 1, 0
    model.call("event")
    assert (model.get(n), model.get(d)) == (4.0, -1.0)  # true before already
    was_true[0] = 0
    model.call("event")
    assert (model.get(n), list(is_active[:3])) == (5.0, [1, 0, 0])
    ticks[0] = 1
    model.call("event")
    assert (model.get(n), list(is_active[:3])) == (5.0, [1, 1, 0])  # the first active branch holds
    held[0] = 0
    model.call("event")
    assert (model.get(n), model.get(d)) == (14.0, 28.0)
    assert list(is_active[:3]) == [0, 1, 1]
    assert [model.library.test_clock(0, part) for part in range(3)] == [2, 5, 20]


def test_reinit_of_the_first_active_when_writes_the_state(emitted: Emitter) -> None:
    model = emitted(ball().solved())
    is_active = model.flags("is_active")
    for active, code, expected in (((1, 1), 1, -2.0), ((0, 1), 1, 9.0), ((0, 0), 0, 4.0)):
        model.set({Symbol("h"): 4.0})
        is_active[0], is_active[1] = active
        assert model.call("reinitialize") == code
        assert model.get(Symbol("h")) == expected


def test_relations_tell_the_difference_of_their_sides_and_their_truth(emitted: Emitter) -> None:
    model = emitted(ball().solved())
    for h, n in ((0.5, 2.0), (0.0, 3.0), (-0.5, 2.0)):
        model.set({Symbol("h"): h, Symbol("n"): n})
        assert model.call("relations") == 0
        assert model.double("crossing", 0) == h
        assert [model.library.test_truth(k) for k in (0, 1)] == [int(h <= 0), int(n == 2)]
        assert (model.double("crossing", 1) > 0) == (n == 2)


def test_asserts_tell_their_text_and_terminate_ends(emitted: Emitter) -> None:
    model = emitted(ball().solved())
    is_active = model.flags("is_active")
    for h, code, told in ((0.0, 0, []), (60.0, 0, ["1 1 high"]), (-200.0, 1, ['0 0 h "left" the\nworld \\ ä ??/'])):
        model.start()
        model.set({Symbol("h"): h})
        assert model.call("check") == code
        assert [model.text("told", k) for k in range(model.library.test_told_count())] == told
    is_active[1] = 0
    assert model.call("event_check") == 0
    is_active[1] = 1
    assert model.call("event_check") == 2


def test_clang_takes_the_code_as_gcc_does(emitted: Emitter, tmp_path: Path) -> None:
    zig = pytest.importorskip("ziglang", reason="the ziglang wheel, which carries clang, is not installed")
    model = emitted(ball().solved())
    for name, content in model.files.items():
        (tmp_path / name).write_bytes(content)
    (tmp_path / "unit.c").write_text('#include "model.h"\n', encoding="utf-8")
    compiler = str(Path(zig.__file__).parent / "zig")
    warnings = ["-Wall", "-Wextra", "-Werror", "-Wno-unused-function", "-Wno-unused-const-variable"]
    command = [compiler, "cc", *LANGUAGE_OPTIONS, *warnings, *INCLUDES, "-c"]
    done = subprocess.run(
        [*command, str(tmp_path / "unit.c"), "-o", str(tmp_path / "unit.o")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[:3000]
