"""The drives that are on: opened, begun, looked after if their page goes away, and kept when they have ended."""

from __future__ import annotations

import math
import secrets
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field

from dse.api import Dealership, Drives, LiveDrive, Workspace, open_drive, read_choices_text, study_name
from dse.domain.bench import TestBench
from dse.domain.design import DesignSpace
from dse.domain.drive import Drive
from dse.errors import DseError, closest, fail
from dse.serving.shared_drives import SharedDrives

MOST_AT_ONCE = 8
PAGE_GONE = 30.0
"""Seconds after which a drive ends whose page has not come back."""
_FORGOTTEN = 600.0
_LEAVING = 10.0


@dataclass(slots=True)
class Held:
    """A drive of *browser* under the *token* that its page has. *pages* are connected now, the last since or until
    *changed*."""

    token: str
    live: LiveDrive
    browser: str = ""
    pages: int = 0
    changed: float = field(default_factory=time.monotonic)
    ended: Mapping[str, object] | None = None
    ending: threading.Lock = field(default_factory=threading.Lock)


class LiveDrives:
    """At most *most* drives of the benches of *workspace* at once; those that count are *kept*, if they are to be. All
    are in one world if that is *shared*.

    Tokens are chosen here and are the only way to a drive. All may be called from any thread.
    """

    def __init__(
        self,
        workspace: Workspace,
        kept: Drives | None = None,
        most: int = MOST_AT_ONCE,
        shared: SharedDrives | None = None,
    ) -> None:
        self.shared = shared
        self._workspace, self._kept, self.most = workspace, kept, most
        self._held: dict[str, Held] = {}
        self._lock, self._asking, self._keeping = threading.RLock(), threading.RLock(), threading.Lock()
        self._opening = 0
        self._pending: list[threading.Thread] = []
        self._problems: dict[str, DseError] = {}  # by study: why drives are not in it
        self._closed = threading.Event()
        self._dealerships: dict[str, Dealership] = {}

    @property
    def benches(self) -> list[dict[str, str]]:
        """The benches that can be driven; one that cannot be read is none of them."""
        from dse.live import can_be_driven

        found = []
        for name in self._names():
            try:
                bench = self._bench(name)
            except DseError:
                continue
            if can_be_driven(bench):
                found.append({"name": name, "title": bench.title or name, "design": bench.design.name})
        return found

    def require(self, bench: str, configuration: str) -> None:
        """DseError unless *bench* can be driven with the configuration whose id starts so."""
        from dse.live import driver_of
        from dse.testbench import one_configuration

        noun = self._bench(bench)
        driver_of(noun)
        one_configuration(noun.design, configuration or None)

    def offer(self, bench: str, chosen: str) -> Mapping[str, object]:
        """What can still be chosen of the bench's design, as plain data. Raises DseError."""
        noun = self._bench(bench)
        with self._asking:
            return self._dealership(noun.design).offer(read_choices_text(chosen)).data()

    def open(self, bench: str, chosen: str, configuration: str, driver: str, browser: str = "") -> str:
        """The token of a new drive, ready to begin. Raises DseError, also where there are as many as there may be, and
        where *browser* has a seat of the shared world: it leaves one whose page is gone."""
        if self.shared and browser:
            self._leave_seat(browser)
        with self._lock:
            self._sweep()
            if self._opening + sum(each.live.ended is None for each in self._held.values()) >= self.most:
                raise fail(f"{self.most} drives are already running", hint="wait until one of them has ended")
            self._opening += 1
        try:
            noun = self._bench(bench)
            if chosen:
                configuration = self._chosen(noun.design, chosen)
            live = self._opened(noun, configuration, driver)
            token = secrets.token_urlsafe(18)
            with self._lock:
                self._held[token] = Held(token, live, browser)
            return token
        finally:
            with self._lock:
                self._opening -= 1

    def _leave_seat(self, browser: str) -> None:
        """DseError if *browser* has a page open that drives."""
        with self._lock:
            own = [each for each in self._held.values() if each.browser == browser and each.live.ended is None]
            if any(each.pages for each in own):
                raise fail(
                    "this browser already has a seat of this world",
                    hint="finish that drive first, or use another browser",
                )
            for each in own:
                del self._held[each.token]
        for each in own:
            if each.live.has_begun:
                each.live.finish()
                each.live.session.wait(_LEAVING)
                self.told(each)
            else:
                each.live.close()

    def _opened(self, bench: TestBench, configuration: str, driver: str) -> LiveDrive:
        if self.shared:
            return self.shared.open(bench, configuration, driver)
        return open_drive(bench, configuration or None, driver=driver)

    def boards(self) -> list[dict[str, object]]:
        """The score boards, as plain data."""
        return [each.data() for each in self._kept.boards()] if self._kept else []

    def is_keeping(self, drive: str) -> bool:
        """Whether the drive with this id is being made a run."""
        return any(each.name == drive and each.is_alive() for each in self._pending)

    def study_of(self, drive: str) -> str:
        """The name of the study that has the drive with this id. DseError if there is none."""
        found = self._kept.recorded().get(drive) if self._kept else None
        if found is None:
            raise fail("there is no such drive")
        name = study_name(found)
        if name in self._problems:
            raise self._problems[name]
        return name

    def enter(self, token: str) -> Held | None:
        """A page has come for the drive *token*: it begins if it has not. None if there is no such drive."""
        with self._lock:
            held = self._held.get(token)
            if held is None:
                return None
            held.pages += 1
            held.changed = time.monotonic()
        held.live.start()
        if self.shared:
            self.shared.begin()
        return held

    def leave(self, held: Held) -> None:
        """A page has gone."""
        with self._lock:
            held.pages -= 1
            held.changed = time.monotonic()

    def watch(self) -> None:
        """End the drives whose pages are gone for good; to be called now and then."""
        with self._lock:
            self._sweep()
            gone = [each for each in self._held.values() if not each.pages and self._age(each) > PAGE_GONE]
        for held in gone:
            held.live.finish()
            self.told(held)

    def told(self, held: Held) -> Mapping[str, object] | None:
        """What its page is told of the end of a drive, which is kept now if it counts; None before the end."""
        ended = held.live.ended
        if ended is None:
            return None
        with held.ending:  # a drive is kept once, which takes a while
            if held.ended is None:
                held.ended = self._end(held)
            return held.ended

    def __enter__(self) -> LiveDrives:
        threading.Thread(target=self._watch, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End all."""
        self._closed.set()
        if self.shared:
            self.shared.close()
        with self._lock:
            held, self._held = [*self._held.values()], {}
        for each in held:
            each.live.close()
        self._settle()

    def _keep(self, kept: Drives, drive: Drive) -> None:
        with self._keeping:
            try:
                kept.add(drive)  # and with it all that were driven on its bench before
                self._problems.pop(study_name(drive), None)
            except DseError as error:
                self._problems[study_name(drive)] = error

    def _settle(self) -> None:
        """Wait until what was driven is in its study."""
        while self._pending:
            self._pending[0].join()
            self._pending = [each for each in self._pending if each.is_alive()]

    def _watch(self) -> None:
        with suppress(DseError):
            _ = self.benches  # read before anybody waits for them
        while not self._closed.wait(1.0):
            self.watch()

    def _end(self, held: Held) -> Mapping[str, object]:
        ended = held.live.ended
        assert ended is not None  # noqa: S101  # asked before
        told: dict[str, object] = {"type": "ended", "why": str(ended.why), "text": ended.text, "drive": None}
        result = held.live.result
        if ended.run is not None and result is not None:
            titles = {each.name: each.title or each.name for each in held.live.bench.requirements}
            told["verdicts"] = [
                {
                    "name": each.requirement,
                    "title": titles[each.requirement],
                    "verdict": str(each.verdict),
                    "margin": each.margin if math.isfinite(each.margin) else None,
                }
                for each in ended.run.judgements
            ]
            if self._kept is not None and len(result.time) > 1:
                try:
                    told["drive"] = drive = self._kept.record(result)
                    # As a run it is made again, which takes its time: who wants to see it waits, nobody else.
                    work = threading.Thread(target=self._keep, args=(self._kept, result), name=drive)
                    work.start()
                    self._pending.append(work)
                except DseError as error:
                    told["text"] = f"{ended.text}; it could not be stored: {error}"
        if ended.pace is not None:
            told["pace"] = {name: getattr(ended.pace, name) for name in ("steps", "overruns", "median", "p99")}
        return {"verdicts": [], **told}

    def _names(self) -> list[str]:
        if self.shared:
            return [self.shared.bench.name]
        return [name for name in self._workspace.benches if not name.startswith("_")]

    def _bench(self, name: str) -> TestBench:
        """Only by a name in the list: elsewhere a name may be a path."""
        with self._asking:
            if name not in self._names():
                raise fail(f"there is no test bench '{name}' to drive", hint=closest(name, self._names()))
            return self._workspace.benches[name].noun

    def _dealership(self, design: DesignSpace) -> Dealership:
        return self._dealerships.setdefault(design.name, Dealership(design))

    def _chosen(self, design: DesignSpace, chosen: str) -> str:
        with self._asking:
            offer = self._dealership(design).offer(read_choices_text(chosen))
        if not offer.configuration:
            raise fail(f"{offer.left:,} configurations of '{design.name}' are possible: choose until one is left")
        return offer.configuration

    def _sweep(self) -> None:
        """Forget those that were never begun, and those that ended long ago."""
        for token, held in [*self._held.items()]:
            patience = PAGE_GONE if not held.live.has_begun else _FORGOTTEN if held.live.ended else math.inf
            if not held.pages and self._age(held) > patience:
                del self._held[token]
                if not held.live.has_begun:
                    held.live.close()

    @staticmethod
    def _age(held: Held) -> float:
        return time.monotonic() - held.changed
