"""``dse drive``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Listen, ServerPort
from dse.cli.terminal import print_line, show_page

Bench = Annotated[str, typer.Argument(metavar="[BENCH]", help="The bench to drive first; default: chosen on the page.")]
Which = Annotated[
    str,
    typer.Option("--configuration", metavar="ID", help="The car, by the start of its id; default: chosen on the page."),
]
Folder = Annotated[Path, typer.Option("--drives", metavar="DIR", help="Where drives are kept.")]
Most = Annotated[
    int, typer.Option("--most", min=1, max=64, help="Maximum number of simultaneous drivers; others wait.")
]
Replayed = Annotated[
    tuple[Path, int] | None,
    typer.Option("--replay", metavar="DIR RUN", help="Only show this run of a study, or of a folder of drives."),
]
Shared = Annotated[bool, typer.Option("--shared", help="All drive in one world, and see each other; needs BENCH.")]
Simulated = Annotated[
    int,
    typer.Option("--simulated", min=0, max=63, help="Seats of the shared world driven by the bench's own driver."),
]
Scripts = Annotated[
    list[Path] | None,
    typer.Option("--script", metavar="FILE", help="A seat driven by a CSV file: time, then controls. Repeatable."),
]
Browser = Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")]


@app.command()
def drive(
    bench: Bench = "",
    configuration: Which = "",
    drives: Folder = Path("out/drives"),
    listen: Listen = "",
    port: ServerPort = 8470,
    most: Most = 8,
    shared: Shared = False,
    simulated: Simulated = 0,
    script: Scripts = None,
    replay: Replayed = None,
    browser: Browser = True,
) -> None:
    """Drive a bench yourself, in the browser, in real time.

    Choose a car, drive it with keyboard, gamepad or touch, and change gains as you go. Drives are kept with their
    metrics and verdicts, as any run, and can be repeated bit for bit. Only this machine can reach it, unless --listen
    is given; then the printed address contains a token. Ctrl-C ends it.

    With --shared, all who open the page drive in one world, as traffic for each other. It can have simulated drivers
    (--simulated, --script), and every page can watch a drive. --most includes them.

    With --replay, the same view shows an earlier run, in a page that needs no server.
    """
    if replay is not None:
        _show(*replay, browser)
        return
    from urllib.parse import urlencode

    from dse.api import Drives, open as open_workspace
    from dse.serving import Announced, LiveDrives, SharedDrives, StudyIndex, serve

    workspace, scripts = open_workspace(Path()), script or []
    world = None
    if shared:
        noun = workspace.benches[bench].noun if bench in workspace.benches else None
        if noun is None:
            raise typer.BadParameter("a shared world needs the name of a bench", param_hint="BENCH")
        world = SharedDrives(noun, most, configuration=configuration, simulated=simulated, scripts=scripts)
        if world.left_out:
            print_line(f"shared {world.left_out}", stderr=True)
    elif simulated or scripts:
        raise typer.BadParameter("needs --shared", param_hint="--simulated" if simulated else "--script")
    on = LiveDrives(workspace, Drives(drives, workspace.files), most, world)
    wanted = {name: value for name, value in (("bench", bench), ("configuration", configuration)) if value}
    if bench:
        on.require(bench, configuration)
    drives.mkdir(parents=True, exist_ok=True)

    def announce(announced: Announced) -> None:
        address = announced.address + (f"#{urlencode(wanted)}" if wanted else "")
        print_line(address, style="bold")
        if announced.has_token:
            print_line("whoever has this address may drive and look; nothing on the way is encrypted", stderr=True)
        print_line("Ctrl-C ends it", stderr=True)
        if browser:
            show_page(address)

    serve(StudyIndex(drives), listen=listen, port=port, tell=announce, drives=on)


def _show(folder: Path, run: int, browser: bool) -> None:
    from dse.api import Results
    from dse.cli.arguments import named_folder
    from dse.cli.terminal import status_line

    with status_line() as announce:
        page = Results(named_folder(folder)).replay_page(run, tell=announce)
    print_line(str(page))
    if browser:
        show_page(page.absolute().as_uri())
