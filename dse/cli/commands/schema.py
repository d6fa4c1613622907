"""``dse schema``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.completion import kinds_of_files
from dse.cli.terminal import print_line


@app.command()
def schema(
    kind: Annotated[
        str | None,
        typer.Argument(
            metavar="[KIND]",
            autocompletion=kinds_of_files,
            help="component, interfaces, components, design, bench, road or study.",
        ),
    ] = None,
    folder: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Write KIND.json, or the schemas of all kinds, here."),
    ] = None,
) -> None:
    """Print the JSON Schema of a kind of file, for editors.

    It includes all installed component kinds, samplers and executors. A file refers to its schema in the first line:
    # yaml-language-server: $schema=../schemas/study.json. 'dse schema -o schemas' updates those of a workspace.
    """
    from dse.errors import closest
    from dse.loading import FILE_KINDS, file_schema
    from dse.scratch import make_folder, write_whole

    if kind is not None and kind not in FILE_KINDS:
        raise typer.BadParameter(f"there is no '{kind}': {closest(kind, FILE_KINDS)}", param_hint="KIND")
    if folder is None and kind is None:
        raise typer.BadParameter(f"name one of {', '.join(FILE_KINDS)}, or a folder with -o", param_hint="KIND")
    wanted = FILE_KINDS if kind is None else (kind,)
    texts = {name: json.dumps(file_schema(name), indent=1, ensure_ascii=False) + "\n" for name in wanted}
    if folder is None:
        typer.echo("".join(texts.values()), nl=False)
        return
    make_folder(folder)
    for name, text in texts.items():
        write_whole(folder / f"{name}.json", text)
        print_line(str(folder / f"{name}.json"))
