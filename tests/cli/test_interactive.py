"""The terminal page, driven by a pilot that presses keys."""

from __future__ import annotations

import asyncio
import sys

import pytest
from textual.widgets import OptionList, Static

from dse.cli.interactive.interactive import choices_yaml, choose, outcome
from dse.cli.interactive.picker import Picker
from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.configurations.ids import IdentifiedChoices
from dse.space.space import open_space
from dse.units import parse_quantity


def part(name, cost=1):
    return Part(Component(name, Interface("any", ()), properties={"cost": parse_quantity(f"{cost} EUR")}))


HYBRID = Compound("hybrid", {"engine": Alternative((part("d", 4), part("e", 5)))})
SPACE = DesignSpace(
    "car",
    Compound(
        "car",
        {
            "s": Alternative((part("a"), part("b"))),
            "p": Alternative((part("bev"), HYBRID)),
            "o": Optional(part("w")),
        },
    ),
    tuple(
        Constraint(text, parse_expression(text))
        for text in ("s is a implies p is hybrid", "p is hybrid implies o is absent", "sum(cost) <= 9 EUR")
    ),
)


class Seen:
    """What the page showed after each group of keys."""

    def __init__(self):
        self.decisions, self.options, self.count, self.summary, self.notes = [], [], [], [], []

    def look(self, app):
        for name, into in (("decisions", self.decisions), ("options", self.options)):
            lines = app.query_one(f"#{name}", OptionList)
            into.append([str(lines.get_option_at_index(i).prompt) for i in range(lines.option_count)])
        self.count.append(str(app.query_one("#count", Static).render()))
        self.summary.append(str(app.query_one("#summary", Static).render()))
        self.notes.append([note.message for note in app._notifications])


def driven(*groups, space=SPACE):
    """The page's result, and what it showed at first and after each group of keys."""
    app, seen = Picker(space, open_space(space).picking()), Seen()

    async def drive():
        async with app.run_test(size=(110, 30)) as pilot:
            for keys in ((), *groups):
                await pilot.press(*keys)
                if not app.is_running:
                    break
                await app.workers.wait_for_complete()
                await pilot.pause()
                seen.look(app)

    asyncio.run(drive())
    return app.return_value and dict(app.return_value.choices), seen


def test_the_page_shows_decisions_options_counts_and_sums():
    _, seen = driven(("q",))
    assert "6 configurations left, 3 of 3 decisions open" in seen.count[0]
    assert [line.split()[0] for line in seen.decisions[0]] == ["s", "p", "o"]
    assert [line.split()[0] for line in seen.options[0]] == ["a", "b"]
    assert seen.options[0][0].endswith("33.3 %  2")
    assert "sum(cost) 2 … 6 EUR" in seen.summary[0]
    assert "3 constraints" in seen.summary[0]


def test_a_pick_fills_in_what_follows_and_brings_nested_decisions():
    _, seen = driven(("enter", "enter"), ("q",))
    assert [line.strip() for line in seen.decisions[1]] == [
        "s  ● a",
        "p  ○ hybrid (forced)",
        "p.engine  2 options",
        "o  ○ (left out) (forced)",
    ]
    assert "1 of 4 decisions open" in seen.count[1]


@pytest.mark.thorough
def test_an_impossible_option_cannot_be_picked():
    _, seen = driven(("enter", "enter"), ("down", "enter"), ("up", "up", "enter"), ("q",))
    assert seen.options[2][0].endswith("–  0")
    assert seen.decisions[3][1].endswith("hybrid (forced)") or seen.decisions[3][1].endswith("● hybrid")


@pytest.mark.thorough
def test_steps_are_undone_taken_back_and_reset():
    _, seen = driven(("enter", "enter"), ("u",), ("enter", "enter"), ("backspace",), ("enter", "enter"), ("r",), ("q",))
    opened = seen.decisions[0]
    assert seen.decisions[1] != opened
    assert seen.decisions[2] == seen.decisions[4] == seen.decisions[6] == opened


def test_the_search_narrows_the_list():
    _, seen = driven(("slash", "o"), ("escape",), ("q",))
    assert [line.split()[0] for line in seen.decisions[1]] == ["o"]
    assert len(seen.decisions[2]) == 3


@pytest.mark.thorough
def test_finishing_needs_everything_decided_and_gives_the_configuration():
    choices, seen = driven(("enter", "enter"), ("f",), ("down", "down", "enter", "down", "enter"), ("f",))
    assert any("p.engine" in note for note in seen.notes[2])
    assert choices == {"s": "a", "p": "hybrid", "p.engine": "e"}
    assert choices in [dict(c.choices) for c in open_space(SPACE).configurations()]


def test_the_first_that_is_left_can_be_taken():
    choices, _ = driven(("c",))
    assert choices == dict(next(open_space(SPACE).configurations()).choices)


def test_leaving_gives_nothing():
    assert driven(("q",))[0] is None


def test_the_outcome_names_the_configuration_and_its_choices():
    first = next(open_space(SPACE).configurations())
    chosen = IdentifiedChoices(first.choices)
    assert outcome(chosen) == f"configuration {first.id}\n--choose s=a --choose p=hybrid --choose p.engine=d"
    assert choices_yaml(SPACE, chosen).splitlines() == [
        "design: car",
        f"configuration: {first.id}",
        "choices:",
        "  s: a",
        "  p: hybrid",
        "  p.engine: d",
    ]


def test_without_a_terminal_it_is_refused(dse):
    done = dse("enumerate", "acc_vehicle", "--interactive")
    assert done.returncode == 1
    assert "--interactive needs a terminal" in done.stderr


@pytest.mark.parametrize("key", ["u", "backspace", "r"])
def test_there_is_nothing_to_take_back_at_first(key):
    _, seen = driven((key,), ("q",))
    assert seen.decisions[0] == seen.decisions[1]


def test_without_the_extra_the_error_names_it(monkeypatch):
    for stream in (sys.stdin, sys.stdout):
        monkeypatch.setattr(stream, "isatty", lambda: True)
    monkeypatch.delitem(sys.modules, "dse.cli.interactive.picker")
    monkeypatch.setitem(sys.modules, "textual.app", None)
    with pytest.raises(DseError, match="--interactive needs textual") as error:
        choose(open_space(SPACE), None)
    assert "dse-workbench[interactive]" in error.value.problems[0].hint
