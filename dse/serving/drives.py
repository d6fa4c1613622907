"""The drives that are on: opened, begun, looked after if their page goes away, and kept when they have ended."""

from __future__ import annotations

import math
import secrets
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from dse.api import Dealership, LiveDrive, Workspace, open_drive, read_choices_text
from dse.domain.bench import TestBench
from dse.domain.design import DesignSpace
from dse.errors import DseError, fail

MOST_AT_ONCE = 8
PAGE_GONE = 30.0
"""Seconds after which a drive ends whose page has not come back."""
_FORGOTTEN = 600.0

Keep = Callable[[LiveDrive], str]
"""Keeps a drive that counts; gives its id, "" if it was not kept."""


@dataclass(slots=True)
class Held:
    """A drive under the *token* that its page has. *pages* are connected now, the last since or until *changed*."""

    token: str
    live: LiveDrive
    pages: int = 0
    changed: float = field(default_factory=time.monotonic)
    ended: Mapping[str, object] | None = None


class Drives:
    """At most *most* drives of the benches of *workspace* at once; those that count are given to *keep*.

    Tokens are chosen here and are the only way to a drive. All may be called from any thread.
    """

    def __init__(self, workspace: Workspace, keep: Keep | None = None, most: int = MOST_AT_ONCE) -> None:
        self._workspace, self._keep, self._most = workspace, keep, most
        self._held: dict[str, Held] = {}
        self._lock, self._asking = threading.RLock(), threading.RLock()
        self._opening = 0
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

    def open(self, bench: str, chosen: str, configuration: str, driver: str) -> str:
        """The token of a new drive, ready to begin. Raises DseError, also where there are as many as there may be."""
        with self._lock:
            self._sweep()
            if self._opening + sum(each.live.ended is None for each in self._held.values()) >= self._most:
                raise fail(f"{self._most} drives are on already", hint="wait until one of them has come to its end")
            self._opening += 1
        try:
            noun = self._bench(bench)
            if chosen:
                configuration = self._chosen(noun.design, chosen)
            live = open_drive(noun, configuration or None, driver=driver)
            token = secrets.token_urlsafe(18)
            with self._lock:
                self._held[token] = Held(token, live)
            return token
        finally:
            with self._lock:
                self._opening -= 1

    def enter(self, token: str) -> Held | None:
        """A page has come for the drive *token*: it begins if it has not. None if there is no such drive."""
        with self._lock:
            held = self._held.get(token)
            if held is None:
                return None
            held.pages += 1
            held.changed = time.monotonic()
        held.live.start()
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
        with self._lock:
            if held.ended is None:
                held.ended = self._end(held)
            return held.ended

    def __enter__(self) -> Drives:
        threading.Thread(target=self._watch, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End all."""
        self._closed.set()
        with self._lock:
            held, self._held = [*self._held.values()], {}
        for each in held:
            each.live.close()

    def _watch(self) -> None:
        while not self._closed.wait(1.0):
            self.watch()

    def _end(self, held: Held) -> Mapping[str, object]:
        ended = held.live.ended
        assert ended is not None  # noqa: S101  # asked before
        told: dict[str, object] = {"type": "ended", "why": str(ended.why), "text": ended.text, "drive": None}
        if ended.run is not None and held.live.result is not None:
            titles = {each.name: each.title or each.name for each in held.live.bench.requirements}
            told["verdicts"] = [
                {"name": each.requirement, "title": titles[each.requirement], "verdict": str(each.verdict)}
                for each in ended.run.judgements
            ]
            if self._keep is not None:
                try:
                    told["drive"] = self._keep(held.live) or None
                except DseError as error:
                    told["text"] = f"{ended.text}; it could not be kept: {error}"
        if ended.pace is not None:
            told["pace"] = {name: getattr(ended.pace, name) for name in ("steps", "overruns", "median", "p99")}
        return {"verdicts": [], **told}

    def _names(self) -> list[str]:
        return [name for name in self._workspace.benches if not name.startswith("_")]

    def _bench(self, name: str) -> TestBench:
        """Only by a name in the list: elsewhere a name may be a path."""
        with self._asking:
            if name not in self._names():
                raise fail("there is no such bench here")
            return self._workspace.benches[name].noun

    def _dealership(self, design: DesignSpace) -> Dealership:
        return self._dealerships.setdefault(design.name, Dealership(design))

    def _chosen(self, design: DesignSpace, chosen: str) -> str:
        with self._asking:
            offer = self._dealership(design).offer(read_choices_text(chosen))
        if not offer.configuration:
            raise fail(f"{offer.left:,} configurations of '{design.name}' are left: choose until there is one")
        return offer.configuration

    def _sweep(self) -> None:
        """Forget those that were never begun, and those that ended long ago."""
        for token, held in [*self._held.items()]:
            patience = PAGE_GONE if not held.live.has_begun else _FORGOTTEN if held.live.ended else math.inf
            if not held.pages and self._age(held) > patience:
                del self._held[token]

    @staticmethod
    def _age(held: Held) -> float:
        return time.monotonic() - held.changed
