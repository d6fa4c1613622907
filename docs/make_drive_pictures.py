"""Makes the pictures of the test drive and of the replay in docs/images: a run is simulated, and a car is driven.

The pages see a picture every 16 ms, however long one takes, so that they draw in full detail without a graphics card.
"""

from __future__ import annotations

import shutil
import socket
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

import dse
from dse.api import Drives, open as open_workspace
from dse.domain.study import Selection
from dse.serving.application import application
from dse.serving.drives import LiveDrives
from dse.serving.guard import Limits
from dse.serving.server import server_of
from dse.serving.study_index import StudyIndex
from dse.testbench import bench_study

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
BENCH = "drive_motorway"
PATIENCE = 300_000  # ms: all is built first
EVEN_FRAMES = """(() => {
  const real = requestAnimationFrame.bind(window);
  let [now, last] = [0, -1];
  window.requestAnimationFrame = (call) =>
    real((time) => {
      if (time !== last) now += 16;
      last = time;
      call(now);
    });
})()"""


def main() -> None:
    """Write docs/images/replay.png, dealership.png and drive.png."""
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        sys.exit("needs chromium")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        take_replay(browser, Path(folder))
        take_drive(browser, Path(folder))
        browser.close()


def take_replay(browser: Browser, folder: Path) -> None:
    """A run of a bench in town."""
    bench = dse.open(ROOT).benches["drive_town"]
    selection = Selection((bench.design.list(1)[0].id,))
    study = dse.Study.of(bench_study(bench.noun, selection)).explore(folder / "town")
    file = study.write_scene(0, folder / "replay.html", source=ROOT / "testbenches" / "drive_town.yaml")
    page = opened(browser, f"{file.as_uri()}#t=11", 1100, 620)
    page.wait_for_function("() => document.documentElement.dataset.frames > 0")
    take(page, "replay")


def take_drive(browser: Browser, folder: Path) -> None:
    """A car that is chosen, and then driven by its cruise control and lane keeping."""
    with served(folder / "drives") as address:
        page = opened(browser, f"{address}/drive#bench={BENCH}&chosen=sensor:object_radar_long", 1280, 860)
        page.wait_for_selector(".alternative.out")
        page.fill("#driver", "Ada")
        page.locator(".alternative.out").first.hover()
        take(page, "dealership")
        page.set_viewport_size({"width": 1280, "height": 720})
        page.get_by_role("button", name="Choose the rest for me").click()
        page.click("button.go:not([disabled])")
        page.wait_for_function("() => document.documentElement.dataset.frames > 2")
        page.wait_for_function("() => parseFloat(document.querySelector('.pace').textContent) > 30")
        take(page, "drive")
        page.keyboard.press("End")
        page.wait_for_selector(".verdicts .badge")


def opened(browser: Browser, address: str, width: int, height: int) -> Page:
    """A page of the size at the address."""
    page = browser.new_page(viewport={"width": width, "height": height})
    page.set_default_timeout(PATIENCE)
    page.add_init_script(EVEN_FRAMES)
    page.goto(address)
    return page


def take(page: Page, name: str) -> None:
    """Write the picture in 256 colours, once nothing changes any more."""
    page.wait_for_timeout(1000)
    taken = Image.open(BytesIO(page.screenshot())).convert("RGB")
    taken.quantize(256).save(IMAGES / f"{name}.png", optimize=True)


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a server of test drives."""
    folder.mkdir()
    workspace = open_workspace(ROOT)
    on = LiveDrives(workspace, Drives(folder, workspace.files), 1)
    server = server_of(application(StudyIndex(folder), drives=on), Limits())
    with on, socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            yield f"http://127.0.0.1:{listener.getsockname()[1]}"
        finally:
            server.should_exit = True
            thread.join()


if __name__ == "__main__":
    main()
