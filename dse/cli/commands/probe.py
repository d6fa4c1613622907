"""``dse probe``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import FmiVersion, Format, Output, Sandbox
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.terminal import console, plain, plain_table, print_json, print_line, print_table, size_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dse.domain.facts import FmuFacts, FmuNumerics, Question
    from dse.domain.fmu import FmuModel

_TITLES = {
    "runs": "runs its default experiment",
    "repeats": "gives the same in another process",
    "resets": "reset equals fresh",
    "renews": "second instance equals the first",
    "coexists": "two in turns equal one alone",
    "threads": "two in threads equal one alone",
    "saves": "saved state leads to the same",
    "serializes": "and so does one saved as bytes",
    "varies step": "takes uneven steps",
    "feeds through": "outputs follow inputs without a step",
    "lasts": "instances in one process",
    "reloads": "loads and unloads in one process",
}
_STYLES = {"yes": "green", "no": "red", "unknown": "yellow"}
_GOOD_EITHER_WAY = ("feeds through",)


@app.command()
def probe(
    names: Annotated[
        list[str],
        typer.Argument(metavar="FMU...", help="FMU files, or components of the workspace.", show_default=False),
    ],
    output: Format = Output.TABLE,
    again: Annotated[bool, typer.Option("--again", help="Repeat experiments that were made before.")] = False,
    timeout: Annotated[float, typer.Option("--timeout", min=1.0, help="Seconds an experiment may take.")] = 30.0,
    version: FmiVersion = 2,
    sandbox: Sandbox = False,
) -> None:
    """Test how an FMU behaves.

    Is a reset FMU like a fresh one, a second instance like the first, a restored state the one that was saved? Does it
    support threads, uneven steps, thousands of instances? How much time does a step take, and how accurate is it? Every
    experiment runs in its own process, so an FMU may crash or hang.

    The results are kept in the cache, and all simulations use them: an FMU whose reset does not work is never reset.
    """
    from dse.api import facts_as_data, known_facts, model_of, numerics_as_data, probe_fmu, probe_numerics
    from dse.domain.facts import Answer, Question

    found: list[tuple[FmuFacts, FmuNumerics]] = []
    for name in names:
        model = model_of(name, version=version)
        facts = None if again else known_facts(model)
        if facts is None:
            with console(stderr=True).status(plain(f"probing {name}")) as status:

                def show(question: Question) -> None:
                    status.update(plain(f"probing {name}: {_TITLES[str(question)]}?"))  # noqa: B023  # called at once

                facts = probe_fmu(model, timeout=timeout, tell=show, sandbox=sandbox)
        with console(stderr=True).status(plain(f"probing {name}: how exact is it?")):
            numerics = probe_numerics(name, model, timeout=timeout, again=again, sandbox=sandbox)
        found.append((facts, numerics))
        if output is Output.TABLE:
            _show(name, model, facts, numerics)
    if output is Output.JSON:
        print_json([
            {"fmu": name, **facts_as_data(facts), "numerics": numerics_as_data(numerics)}
            for name, (facts, numerics) in zip(names, found, strict=True)
        ])  # fmt: skip
    failed = any(facts.answer(Question.RUNS) is not Answer.YES for facts, _ in found)
    raise typer.Exit(RUNS_FAILED if failed else DONE)


def _show(name: str, model: FmuModel, facts: FmuFacts, numerics: FmuNumerics) -> None:
    from rich.text import Text

    from dse.api import consequences
    from dse.domain.facts import Question

    kind = f"FMI {model.version}, {model.interface}"
    if not math.isnan(facts.step):
        kind += f", {facts.steps} steps of {facts.step:.6g} s"
    console().print(Text.assemble((plain(name), "bold"), f"  {kind}"), soft_wrap=True)
    table = plain_table("what", "answer", "detail", header=False)
    for question in Question:
        if question not in facts.answers:
            continue
        answer = facts.answers[question]
        style = "" if str(question) in _GOOD_EITHER_WAY else _STYLES[str(answer)]
        table.add_row(f"  {_TITLES[str(question)]}", Text(str(answer), style), plain(_detail(facts, question)))
    for what, number in _measured(facts):
        table.add_row(f"  {what}", "", number)
    for what, said, detail in _exactness(numerics):
        table.add_row(f"  {what}", Text(said, _STYLES.get(said, "")), plain(detail))
    print_table(table)
    for line in consequences(facts):
        print_line(f"  → {line}")


def _detail(facts: FmuFacts, question: Question) -> str:
    tried = {"lasts": facts.instances, "reloads": facts.loads}.get(str(question))
    reason = facts.reasons.get(question, "")
    if tried is None:
        return reason
    return f"{tried:,}, then it {reason}" if reason else f"{tried:,} tried"


def _measured(facts: FmuFacts) -> Iterator[tuple[str, str]]:
    if not math.isnan(facts.step_cost):
        yield "a step costs", _time(facts.step_cost)
    if not math.isnan(facts.memory):
        yield "an instance takes", size_text(facts.memory)
    if not math.isnan(facts.run_growth):
        yield "a run leaves behind", size_text(facts.run_growth)


def _exactness(numerics: FmuNumerics) -> Iterator[tuple[str, str, str]]:
    for lever, change in numerics.changes.items():
        yield f"answers to {lever}", "yes", f"by {change:.1g} of the outputs' range"
    if not math.isnan(numerics.inner_step):
        yield "steps inside by about", "", _time(numerics.inner_step)
    if numerics.exact:
        yield "its own error", "", f"none: {numerics.exact}"
    else:
        yield "its own error can be measured", "no" if numerics.unknown else "yes", numerics.unknown


def _time(seconds: float) -> str:
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"
