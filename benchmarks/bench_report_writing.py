"""What it costs to write the report of a study folder: processor time by part, and the most memory.

    python benchmarks/bench_report_writing.py out/acc_gains [...]

One process a folder, so that no import is paid by another one.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path


def measure(folder: Path) -> str:
    """A line on *folder*, of this process."""
    marks = [0.0, time.process_time()]
    from dse.report.content.reading import read_content
    from dse.report.figure import shown_figures
    from dse.report.insight.reading import read_insight
    from dse.report.page.html import page_of

    marks.append(time.process_time())
    content = read_content(folder)
    marks.append(time.process_time())
    content = replace(content, insight=read_insight(folder))
    marks.append(time.process_time())
    text = page_of(content, shown_figures(content))
    marks.append(time.process_time())
    parts = [later - earlier for earlier, later in pairwise(marks)]
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    cells = "".join(f"{part:8.2f}" for part in [*parts[1:], marks[-1]])
    return f"{folder.name:20}{len(content.runs):8}{cells} s {megabytes:6.0f} MB {len(text) / 1e6:6.2f} MB"


def main(folders: list[str]) -> None:
    """Prints one line for each folder."""
    if folders[0] == "--one":
        print(measure(Path(folders[1])))
        return
    heads = "".join(f"{head:>8}" for head in ("runs", "imports", "content", "insight", "page", "all"))
    print(f"{'study':20}{heads}       memory     file")
    for folder in folders:
        subprocess.run([sys.executable, __file__, "--one", folder], check=True)


if __name__ == "__main__":
    main(sys.argv[1:])
