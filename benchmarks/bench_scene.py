"""How fast the scene is drawn without a graphics card, at 1280 x 720, with 0, 20 and 60 other vehicles.

    python benchmarks/bench_scene.py [--roads town motorway] [--others 0 20 60] [--views chase driver] [--seconds 8]

Processor time of the browser for a picture in full detail and in the least, which other work on the machine hardly
changes; draw calls and triangles of one in full detail; and pictures per second while a replay plays, where the page
chooses resolution and detail (the last two numbers).
"""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, CDPSession, Page, sync_playwright

from dse.report import Scene, scene_page
from dse.report.drawing.road_picture import Strip
from dse.report.scene.data import Ground, Host

SECONDS, SPEED, LANE = 40.0, 14.0, 3.5
LEAST = 1  # the page's name of the least detail, and of the most
MOST = 4


def made_up(kind: str, others: int) -> Scene:
    """A straight road of two lanes each way on which everything moves, the *others* from 60 m behind to 300 m ahead."""
    time = np.linspace(0.0, SECONDS, 401)
    zero = 0 * time
    x = np.linspace(-300, 1200, 151)
    host = {**dict.fromkeys(("y", "z", "heading", "roll", "pitch", "steering"), zero), "x": SPEED * time}
    return Scene(
        f"{others} others, {kind}",
        "",
        time,
        Ground(tuple(_lane(x, number) for number in range(-2, 2)), (), kind=kind),
        Host({**host, "speed": SPEED + zero}, 4.5, 1.8, 2.3),
        tuple(_other(number, others, time) for number in range(others)),
        (),
        dict.fromkeys(("fog", "rain", "snow", "darkness"), zero),
        (),
    )


def _lane(x: np.ndarray, number: int) -> Strip:
    low, high = (np.column_stack([x, 0 * x + LANE * side]) for side in (number, number + 1))
    left, right = (high, low) if number < 0 else (low[::-1], high[::-1])
    return Strip(left, right, 0 * x, 0 * x, is_driven=True, is_inside=False)


def _other(number: int, of: int, time: np.ndarray) -> dict[str, np.ndarray]:
    lane = (-2, 1, -1, 0)[number % 4]
    length, width, height = ((4.6, 1.84, 1.46), (4.0, 1.75, 1.5), (4.8, 1.9, 1.7), (16.0, 2.55, 3.9))[number % 4]
    ahead = 10 + 290 * (number + 0.5) / of if number % 5 else -30.0 - 2 * number
    return {
        "id": number + 0 * time,
        "class": (2.0 if length > 8 else 1.0) + 0 * time,
        "length": length + 0 * time,
        "width": width + 0 * time,
        "height": height + 0 * time,
        "x": ahead + SPEED * time,
        "y": LANE * (lane + 0.5) + 0 * time,
        "z": 0 * time,
        "heading": (np.pi if lane >= 0 else 0.0) + 0 * time,
        "speed": SPEED + 0 * time,
    }


COUNT = """() => {
  const drawn = { calls: 0, triangles: 0 };
  for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"]) {
    const was = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...given) {
      drawn.calls++;
      const count = name.startsWith("drawElements") ? given[1] : given[2];
      drawn.triangles += (count / 3) * (name.endsWith("Instanced") ? given.at(-1) : 1);
      return was.apply(this, given);
    };
  }
  window.drawn = drawn;
}"""

STEPS = """async ([count, asked]) => {
  const frame = () => new Promise(done => requestAnimationFrame(done));
  for (let i = 0; i < count; i++) {
    location.hash = `${asked}&t=${(5 + i / 25).toFixed(3)}`;
    await frame();
    await frame();
  }
}"""


def processor(session: CDPSession) -> float:
    """Seconds that all processes of the browser have taken."""
    return float(sum(each["cpuTime"] for each in session.send("SystemInfo.getProcessInfo")["processInfo"]))


def per_picture(page: Page, session: CDPSession, asked: str, count: int = 25) -> tuple[float, float, float]:
    """Milliseconds of processor time, draw calls and thousands of triangles for a picture."""
    page.goto(f"{page.url.split('#')[0]}#picture&t=4&{asked}")
    page.reload()
    page.wait_for_selector("html[data-ready]", timeout=120_000)
    page.evaluate(STEPS, [5, f"picture&{asked}"])
    page.evaluate("Object.assign(drawn, { calls: 0, triangles: 0 })")
    page.evaluate("document.documentElement.dataset.frames = 0")
    before = processor(session)
    page.evaluate(STEPS, [count, f"picture&{asked}"])
    page.wait_for_timeout(300)
    spent = processor(session) - before
    frames, calls, triangles = page.evaluate(
        "[Number(document.documentElement.dataset.frames), drawn.calls, drawn.triangles]"
    )
    return 1e3 * spent / frames, calls / frames, triangles / 1e3 / frames


def played(page: Page, session: CDPSession, view: str, seconds: float) -> tuple[float, float, str]:
    """Pictures a second while it plays, milliseconds of processor time for each, and what they are drawn with."""
    page.goto(f"{page.url.split('#')[0]}#picture&view={view}")
    page.reload()
    page.wait_for_selector("html[data-ready]", timeout=120_000)
    page.wait_for_timeout(5000)  # until the page knows the machine
    count = "[performance.now() / 1000, Number(document.documentElement.dataset.frames)]"
    (begun, was), before = page.evaluate(count), processor(session)
    page.wait_for_timeout(1000 * seconds)
    (ended, now), after = page.evaluate(count), processor(session)
    drawn = page.evaluate("document.documentElement.dataset.drawn ?? ''")
    return (now - was) / (ended - begun), 1e3 * (after - before) / max(now - was, 1), drawn


def measure(browser: Browser, file: Path, view: str, seconds: float) -> str:
    page = browser.new_page(viewport={"width": 1280, "height": 720})
    session = browser.new_browser_cdp_session()
    page.add_init_script(f"({COUNT})()")
    page.goto(f"{file.as_uri()}#picture")
    page.wait_for_selector("html[data-ready]", timeout=120_000)
    beside = 1280 - page.evaluate("document.querySelector('.stage').clientWidth")
    page.set_viewport_size({"width": 1280 + beside, "height": 720})
    most, calls, triangles = per_picture(page, session, f"view={view}&detail={MOST}")
    least, *_ = per_picture(page, session, f"view={view}&detail={LEAST}")
    rate, spent, drawn = played(page, session, view, seconds)
    page.close()
    return (
        f"{most:7.1f} ms {least:7.1f} ms {calls:6.0f} {triangles:7.1f}k {rate:6.1f}/s {spent:6.1f} ms {drawn:>14} "
        f"load {os.getloadavg()[0]:.1f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--roads", nargs="+", default=["town", "motorway"])
    parser.add_argument("--others", nargs="+", type=int, default=[0, 20, 60])
    parser.add_argument("--views", nargs="+", default=["chase", "driver"])
    parser.add_argument("--seconds", type=float, default=8.0)
    given = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    print(f"{'road':>10} {'others':>6} {'view':>7} {'most':>10} {'least':>10}  calls    triangles     played")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for road in given.roads:
            for others in given.others:
                file = Path(folder) / "scene.html"
                file.write_text(scene_page(made_up(road, others)), encoding="utf-8")
                for view in given.views:
                    print(f"{road:>10} {others:>6} {view:>7} {measure(browser, file, view, given.seconds)}", flush=True)
        browser.close()


if __name__ == "__main__":
    main()
