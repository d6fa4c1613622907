"""Pictures of a scene's page, taken by a Chromium of the machine that is told what to show through a pipe."""

from __future__ import annotations

import base64
import fcntl
import json
import os
import select
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from dse.errors import DseError, Location, fail
from dse.json_data import read_json
from dse.report.page.pdf import OPTIONS, browser_for, rights
from dse.scratch import ScratchFolder

_PATIENCE = 60.0
"""Seconds that one answer may take; a frame takes a tenth of one without a graphics card."""

_MOST_ANSWER = 1 << 28
_HINT = "name another Chromium in the environment variable CHROMIUM"
_DRAWN = (*OPTIONS, "--remote-debugging-pipe", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--mute-audio")

# Whoever looks waits until the page has drawn the moment, and the browser the page.
_SHOW = """new Promise((done) => {
  const page = document.documentElement;
  const look = () => Math.abs(Number(page.dataset.at ?? -1) - TIME) < 1e-6 && page.dataset.view === "VIEW"
    ? requestAnimationFrame(() => requestAnimationFrame(() => done(true)))
    : requestAnimationFrame(look);
  location.hash = "t=TIME&view=VIEW&picture";
  look();
})"""
_OPENED = """(() => {
  const read = document.getElementById("document");
  const problem = document.querySelector("#scene .problem");
  if (problem) return { problem: problem.textContent };
  if (!read || !document.documentElement.dataset.ready) return null;
  const { steps, step } = JSON.parse(read.textContent);
  return { seconds: Math.max(steps - 1, 0) * step };
})()"""


class Camera:
    """Takes pictures of a page that is open; *seconds* is when its run ends."""

    def __init__(self, pipe: _Pipe, session: str, seconds: float) -> None:
        self._pipe = pipe
        self._session = session
        self.seconds = seconds

    def picture(self, moment: float, view: str) -> bytes:
        """A PNG of *moment* in s, by the camera *view*. Raises DseError if the browser fails."""
        asked = _SHOW.replace("TIME", repr(min(moment, self.seconds))).replace("VIEW", view)
        self._pipe.value(self._session, asked)
        taken = self._pipe.ask("Page.captureScreenshot", self._session, format="png")
        return base64.b64decode(taken["data"])


@contextmanager
def camera_on(page: str, size: tuple[int, int]) -> Iterator[Camera]:
    """A camera on the scene whose *page* it is, *size* pixels wide and high. Nothing is fetched.

    Raises DseError if there is no Chromium (``$CHROMIUM``, else one on the path), or if it cannot show the page.
    """
    browser = browser_for("a picture of a scene")
    if not hasattr(os, "posix_spawn"):
        raise fail("pictures of scenes are not taken on this system: its browsers cannot be controlled through pipes")
    with ScratchFolder() as scratch:
        file = Path(scratch, "scene.html")
        file.write_text(page, encoding="utf-8")
        with _started(browser, Path(scratch, "profile")) as pipe:
            target = pipe.ask("Target.createTarget", url="about:blank")["targetId"]
            session = pipe.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            shape = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": False}
            pipe.ask("Emulation.setDeviceMetricsOverride", session, **shape)
            pipe.ask("Page.navigate", session, url=f"{file.as_uri()}#t=0&picture")
            yield Camera(pipe, session, _seconds(pipe, session, browser))


def _seconds(pipe: _Pipe, session: str, browser: str) -> float:
    """When the run of the page that is being opened ends. Raises DseError if it says that it cannot be shown."""
    until = time.monotonic() + _PATIENCE
    while (opened := pipe.value(session, _OPENED)) is None:
        if time.monotonic() > until:
            raise fail(f"the page was not open within {_PATIENCE:g} s", Location(browser), _HINT)
        time.sleep(0.02)
    if problem := opened.get("problem"):
        raise fail(str(problem)[:300], Location(browser), _HINT)
    return float(opened["seconds"])


class _Pipe:
    """Asks a browser, and reads what it answers: JSON with a zero byte behind, on a descriptor for each way."""

    def __init__(self, browser: str, to: int, of: int) -> None:
        self._where = Location(browser)
        self._to, self._of = to, of
        self._read = b""
        self._asked = 0

    def value(self, session: str, script: str) -> Any:
        """What the page in *session* makes of *script*, waited for; None if it goes over to another one meanwhile."""
        told = {"expression": script, "awaitPromise": True, "returnByValue": True}
        answer = self.ask("Runtime.evaluate", session, **told)
        if "exceptionDetails" in answer:
            return None
        return answer["result"].get("value")

    def ask(self, method: str, session: str = "", **told: object) -> dict[str, Any]:
        """The answer to *method*. Raises DseError if there is none, or if it is refused."""
        self._asked += 1
        message = {"id": self._asked, "method": method, "params": told, **({"sessionId": session} if session else {})}
        until = time.monotonic() + _PATIENCE
        try:
            self._write(json.dumps(message).encode() + b"\0")
            while True:
                answer = read_json(self._message(until))
                if dict(answer).get("id") == self._asked:
                    break
        except (OSError, ValueError, TypeError) as error:
            raise fail(f"the browser does not answer ({method}): {error}", self._where, _HINT) from error
        if "error" in answer:
            raise fail(f"the browser refuses {method}: {answer['error'].get('message')}", self._where, _HINT)
        result: dict[str, Any] = answer["result"]
        return result

    def _write(self, message: bytes) -> None:
        while message:
            message = message[os.write(self._to, message) :]

    def _message(self, until: float) -> bytes:
        while b"\0" not in self._read:
            left = until - time.monotonic()
            if left <= 0 or not select.select([self._of], [], [], left)[0]:
                raise TimeoutError(f"nothing within {_PATIENCE:g} s")
            part = os.read(self._of, 1 << 16)
            if not part:
                raise ConnectionError("it has ended")
            self._read += part
            if len(self._read) > _MOST_ANSWER:
                raise ValueError("it prints too much")
        message, _, self._read = self._read.partition(b"\0")
        return message


@contextmanager
def _started(browser: str, profile: Path) -> Iterator[_Pipe]:
    """The browser with its ends of two pipes as descriptors 3 and 4, where it looks for them; it is gone afterwards."""
    ours: list[int] = []
    try:
        theirs_in, to = _high(os.pipe())
        of, theirs_out = _high(os.pipe())
        ours += [to, of]
        command = [browser, *_DRAWN, *rights(), f"--user-data-dir={profile}"]
        actions = [
            (os.POSIX_SPAWN_DUP2, theirs_in, 3),
            (os.POSIX_SPAWN_DUP2, theirs_out, 4),
            (os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0),
            (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
            (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0),
        ]
        try:
            process = os.posix_spawn(browser, command, dict(os.environ), file_actions=actions, setpgroup=0)
        except OSError as error:
            raise fail(f"cannot be started: {error.strerror or error}", Location(browser), _HINT) from error
        finally:
            os.close(theirs_in)
            os.close(theirs_out)
        pipe = _Pipe(browser, to, of)
        try:
            yield pipe
        finally:
            _end(process, pipe)
    finally:
        for each in ours:
            os.close(each)


def _end(process: int, pipe: _Pipe) -> None:
    """Ask the browser to go, then see that it and all that it started are gone."""
    with suppress(DseError):
        pipe.ask("Browser.close")
    for _ in range(100):
        if os.waitpid(process, os.WNOHANG)[0]:
            break
        time.sleep(0.02)
    else:
        with suppress(ProcessLookupError):
            os.killpg(process, signal.SIGKILL)
        os.waitpid(process, 0)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process, signal.SIGKILL)


def _high(ends: tuple[int, int]) -> tuple[int, int]:
    """Both *ends* of a pipe with numbers that nobody wants to have."""
    high = tuple(fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in ends)
    for end in ends:
        os.close(end)
    return high[0], high[1]
