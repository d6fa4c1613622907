"""``dse findings``."""

from __future__ import annotations

from dse.cli.app import app
from dse.cli.arguments import Folder, Format, Output
from dse.cli.findings import print_findings
from dse.cli.terminal import print_json, status_line


@app.command()
def findings(folder: Folder, form: Format = Output.TABLE) -> None:
    """Say what was learnt from a study.

    How often requirements are met and where, how much may change, what matters; and what the runs do not tell, and why.

    Reads only the study folder; nothing is simulated.
    """
    from dataclasses import asdict

    from dse.api import Results

    with status_line() as tell:
        tell("reading the runs")
        found = Results(folder).findings(tell=lambda what: tell(f"looking for {what}"))
    if form is Output.JSON:
        print_json([asdict(each) for each in found])
    else:
        print_findings(found)
