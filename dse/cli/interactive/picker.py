"""The terminal page of ``dse enumerate --interactive``: decisions on the left, what they can be on the right."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from rich.text import Text
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.widgets import Footer, Input, OptionList, Static
from textual.widgets.option_list import Option as Line

from dse.cli.spaces import short, tally_text
from dse.domain.design import DesignSpace
from dse.errors import DseError, some_of
from dse.space import IdentifiedChoices, Option, Picking, Range, Tally

LEFT_OUT = "(left out)"
"""How a part that is left out is called."""

_BAR = 16
_PARTS = " ▏▎▍▌▋▊▉█"
_NAMED = 8


class Picker(App[IdentifiedChoices]):
    """Picks one configuration of *space*; returns it, or None if the user leaves."""

    TITLE = "dse enumerate --interactive"
    ENABLE_COMMAND_PALETTE = False
    CSS = """
    #count { padding: 0 1; height: 2; background: $panel; }
    #decisions { width: 45%; height: 1fr; border: round $primary; }
    #options { width: 55%; height: 1fr; border: round $primary; }
    OptionList:focus { border: round $accent; }
    #summary { padding: 0 1; height: auto; max-height: 9; background: $panel; }
    #search { display: none; }
    #search.shown { display: block; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("u", "undo", "Undo"),
        Binding("backspace,delete", "unpick", "Take back"),
        Binding("r", "reset", "Reset"),
        Binding("slash", "search", "Search"),
        Binding("f", "finish", "Finish"),
        Binding("c", "complete", "Take the first left"),
        Binding("q", "leave", "Leave"),
        Binding("escape", "close_search", "Close search", show=False),
    ]

    def __init__(self, space: DesignSpace, picking: Picking) -> None:
        super().__init__()
        self.space = space
        self.picking = picking
        self.history: list[Picking] = []
        self.options: tuple[Option, ...] = ()
        self.ranges: tuple[Range, ...] = ()
        self.current: int | None = None
        self._depths = _depths(picking)

    def compose(self) -> ComposeResult:
        """The widgets, from top to bottom."""
        yield Static(id="count")
        yield Input(placeholder="part of a place's name", id="search")
        with Horizontal():
            decisions, options = OptionList(id="decisions"), OptionList(id="options")
            decisions.border_title, options.border_title = "decisions", "options"
            yield decisions
            yield options
        yield Static(id="summary")
        yield Footer()

    def on_mount(self) -> None:
        """Show what there is before anything is picked."""
        self.query_one("#decisions").focus()
        self._move_to(self.picking)

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Another decision is looked at: show what it can be."""
        if event.option_list.id == "decisions" and event.option_id is not None:
            number = int(event.option_id)
            if number != self.current:
                self.current = number
                self._calculate()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Enter: from a decision to its options, from an option to the next open decision."""
        if event.option_list.id == "decisions":
            self.query_one("#options").focus()
        elif self.current is not None and event.option_id is not None:
            value = int(event.option_id)
            if self.picking.picked(self.current) != value:
                self._step(self.picking.pick(self.current, value))
            self.query_one("#decisions").focus()

    def on_input_changed(self, event: Input.Changed) -> None:
        """Show only the decisions that have what was typed in their path."""
        self._show_decisions(event.value)

    def on_input_submitted(self) -> None:
        """Back to the decisions that were found."""
        self.query_one("#decisions").focus()

    def action_undo(self) -> None:
        """Take back the last step."""
        if self.history:
            self._move_to(self.history.pop())

    def action_unpick(self) -> None:
        """Take back the pick of the current decision."""
        if self.current is not None and self.picking.picked(self.current) is not None:
            self._step(self.picking.unpick(self.current))

    def action_reset(self) -> None:
        """Take back everything."""
        if self.picking.picks:
            self._step(self.picking.reset())

    def action_search(self) -> None:
        """Open the search."""
        search = self.query_one("#search", Input)
        search.add_class("shown")
        search.focus()

    def action_close_search(self) -> None:
        """Close the search and show all decisions again."""
        search = self.query_one("#search", Input)
        search.value = ""
        search.remove_class("shown")
        self.query_one("#decisions").focus()

    def action_finish(self) -> None:
        """Leave with the configuration, if a single one is left."""
        if self.picking.is_complete:
            self.action_complete()
            return
        paths = [self.picking.variables[number].path for number in self.picking.open]
        listed = ", ".join(paths[:_NAMED]) + (", …" if len(paths) > _NAMED else "")
        self.notify(f"still open: {listed}" if paths else "nothing is left", severity="warning")

    def action_complete(self) -> None:
        """Leave with the first configuration that is left."""
        self._work(self._first_left)

    def action_leave(self) -> None:
        """Leave without a configuration."""
        self.exit(None)

    def _first_left(self) -> Callable[[], None]:
        chosen = self.picking.first()
        if chosen is None:
            return lambda: self.notify("nothing is left", severity="warning")
        return lambda: self.exit(chosen)

    def _step(self, picking: Picking) -> None:
        self.history.append(self.picking)
        self._move_to(picking)

    def _move_to(self, picking: Picking) -> None:
        self.picking = picking
        self._calculate()

    def _calculate(self) -> None:
        picking, current = self.picking, self.current

        def calculated() -> Callable[[], None]:
            decisions = picking.decisions
            shown = current if current in decisions else next(iter(decisions), None)
            options = picking.options(shown) if shown is not None else ()
            ranges = picking.ranges()
            return lambda: self._show(picking, shown, options, ranges)

        self._work(calculated)

    def _work(self, calculate: Callable[[], Callable[[], None]]) -> None:
        """Calculate beside the page, then do what *calculate* returned; a later call takes the place of an earlier."""
        self.query_one("#options").border_subtitle = "counting …"

        def work() -> None:
            try:
                done = calculate()
            except DseError as error:
                what = str(error)
                done = lambda: self.notify(what, severity="error")  # noqa: E731  # one line says it
            self.call_from_thread(done)

        self.run_worker(work, thread=True, exclusive=True, group="calculation")

    def _show(
        self, picking: Picking, current: int | None, options: tuple[Option, ...], ranges: tuple[Range, ...]
    ) -> None:
        if picking is not self.picking or (
            self.current is not None and current != self.current and self.current in picking.decisions
        ):
            return  # The user has gone on meanwhile.
        self.current, self.options, self.ranges = current, options, ranges
        self._show_count()
        self._show_decisions(self.query_one("#search", Input).value)
        self._show_options()
        self.query_one("#summary", Static).update(self._summary())

    def _show_count(self) -> None:
        text = Text.assemble(
            (self.space.title or self.space.name, "bold"),
            "\n",
            (tally_text(self.picking.left), "bold green" if self.picking.left.value else "bold red"),
            f" configurations left, {len(self.picking.open)} of {len(self.picking.decisions)} decisions open",
        )
        self.query_one("#count", Static).update(text)

    def _show_decisions(self, wanted: str) -> None:
        decisions = self.query_one("#decisions", OptionList)
        variables = self.picking.variables
        found = [number for number in self.picking.decisions if wanted.lower() in variables[number].path.lower()]
        with self.prevent(OptionList.OptionHighlighted):
            decisions.clear_options()
            decisions.add_options([Line(self._decision(number), id=str(number)) for number in found])
            if self.current in found:
                decisions.highlighted = found.index(self.current)

    def _decision(self, number: int) -> Text:
        variable = self.picking.variables[number]
        value = self.picking.settled(number)
        text = Text("  " * self._depths[number] + variable.path)
        if value is None:
            return text.append(f"  {len(variable.values)} options", "dim")
        name = variable.values[value] or LEFT_OUT
        if self.picking.picked(number) is not None:
            return text.append("  ● ", "bold green").append(name, "bold green")
        return text.append("  ○ ", "yellow").append(f"{name} (forced)", "yellow")

    def _show_options(self) -> None:
        options = self.query_one("#options", OptionList)
        options.clear_options()
        options.border_subtitle = ""
        if self.current is None:
            options.border_title = "nothing to decide"
            return
        options.border_title = self.picking.variables[self.current].path
        settled = self.picking.settled(self.current)
        most = max((option.tally.value for option in self.options), default=0)
        width = max((len(option.name or LEFT_OUT) for option in self.options), default=0)
        whole = sum(option.tally.value for option in self.options)
        for option in self.options:
            mark = "● " if option.value == settled else "  "
            line = Text(mark + (option.name or LEFT_OUT).ljust(width + 2))
            line.append(_bar(option.tally.value, most), "green")
            line.append(f" {_percent(option.tally.value, whole):>6}  {_brief(option.tally)}")
            options.add_option(Line(line, id=str(option.value), disabled=not option.is_possible))
        possible = (number for number, option in enumerate(self.options) if option.is_possible)
        options.highlighted = settled if settled is not None else next(possible, None)

    def _summary(self) -> Text:
        text = Text()
        for found in self.ranges:
            unit = str(found.total.unit)
            text.append(f"sum({found.total.name})", "bold")
            text.append(f" {found.low:g} … {found.high:g} {unit}".rstrip())
            text.append("\n" if found.exact else "  (bounds)\n", "dim")
        names = [constraint.name for constraint in self.space.constraints]
        return text.append(f"{len(names)} constraints: {some_of(names, _NAMED)}" if names else "no constraints", "dim")


def _depths(picking: Picking) -> list[int]:
    depths: list[int] = []
    for variable in picking.variables:
        depths.append(0 if variable.parent is None else depths[variable.parent[0]] + 1)
    return depths


def _bar(part: int, most: int) -> str:
    eighths = part * _BAR * 8 // most if most else 0
    if part and not eighths:
        eighths = 1
    full, rest = divmod(eighths, 8)
    return ("█" * full + (_PARTS[rest] if rest else "")).ljust(_BAR)


def _percent(part: int, whole: int) -> str:
    if not whole or not part:
        return "–"
    share = part * 1000 // whole / 10
    return f"{share:.1f} %" if share else "<0.1 %"


def _brief(tally: Tally) -> str:
    if tally.exact:
        return f"{tally.value:,}" if tally.value < 10**9 else short(tally.value)
    return f"≈ {short(tally.value)}"
