"""``dse findings``."""

from __future__ import annotations

from dse.cli.app import app
from dse.cli.arguments import Folder, Format, Output
from dse.cli.choice import show_choice
from dse.cli.terminal import print_findings, print_json, status_line


@app.command()
def findings(folder: Folder, form: Format = Output.TABLE) -> None:
    """Show which design of a study to take, and the findings.

    How often and where requirements are met, how much each variable may change, which variables matter; and which
    findings are withheld, and why.

    Reads only the study folder; nothing is simulated.
    """
    from dataclasses import asdict

    from dse.api import Results

    with status_line() as tell:
        tell("reading the runs")
        results = Results(folder)
        found = results.findings(tell=lambda what: tell(f"looking for {what}"))
        choice = None if form is Output.JSON else results.choice()
    if form is Output.JSON:
        print_json([asdict(each) for each in found])
    else:
        show_choice(choice, results.definition)
        print_findings(found)
