"""The world that all drives of a server share: its seats, its simulated drivers, and who may watch."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api import SharedDrive, open_shared_drive, shared_without
from dse.domain.bench import TestBench
from dse.errors import DseError

if TYPE_CHECKING:
    from dse.live import Script

_LOOK_EVERY = 0.5


class SharedDrives:
    """One world on *bench* with *most* seats. *simulated* of them drive as the bench's own driver does, one more for
    each of *scripts*; they begin with the first person, and again until the last one has left.

    A car that is late is waited for *grace* s. All may be called from any thread.
    """

    def __init__(
        self,
        bench: TestBench,
        most: int,
        *,
        configuration: str = "",
        simulated: int = 0,
        scripts: Sequence[Path] = (),
        grace: float = 0.05,
    ) -> None:
        from dse.live import Script, SharedWorld

        self.bench = bench
        self.left_out = shared_without(bench, configuration or None)
        """What of the bench the world lacks, as a sentence."""
        self._configuration = configuration
        self._people: list[SharedDrive] = []
        self._simulated: dict[str, SharedDrive] = {}
        self._wanted: dict[str, Path | Script] = {
            **{f"simulated {number}": Script((), ()) for number in range(1, simulated + 1)},
            **{f"script {file.stem}": file for file in scripts},
        }
        self._lock = threading.Lock()
        self._begun, self._closed = threading.Event(), threading.Event()
        self.problem = ""
        """Why a simulated driver does not drive."""
        self.world = SharedWorld(bench.simulation.step, most=most, grace=grace)
        self._thread = threading.Thread(target=self._simulate, daemon=True)
        self._thread.start()

    def open(self, bench: TestBench, configuration: str, driver: str) -> SharedDrive:
        """A seat for a person. Raises DseError."""
        live = open_shared_drive(bench, self.world, configuration or None, driver=driver)
        with self._lock:
            self._people.append(live)
        return live

    def begin(self) -> None:
        """Somebody drives."""
        self._begun.set()

    def seats(self) -> list[dict[str, object]]:
        """Who is in the world, as plain data, by number; times in s, speeds in m/s."""
        found = []
        for live in self._on():
            place = live.seating.place
            newest = live.session.newest if live.has_begun else None
            found.append(
                {
                    "number": place.number,
                    "driver": live.driver,
                    "simulated": live.is_simulated,
                    "configuration": live.driver_in_loop.configuration.id,
                    "time": newest.time if newest else None,
                    "speed": place.state.speed if place.state else None,
                    "stopped": place.is_lost,
                    "overruns": place.overruns,
                }
            )
        return sorted(found, key=lambda seat: int(str(seat["number"])))

    def drive(self, number: str) -> SharedDrive | None:
        """The drive in the seat with that number, to be watched; None if there is none that has begun."""
        return next((e for e in self._on() if e.has_begun and str(e.seating.place.number) == number), None)

    def data(self) -> Mapping[str, object]:
        """What a page is told of the world."""
        world = {"type": "world", "bench": self.bench.name, "most": self.world.most, "seats": self.seats()}
        more = {"problem": self.problem or self.world.problem, "note": self.left_out}
        return world | {name: text for name, text in more.items() if text}

    def close(self) -> None:
        """End the simulated drives, and the world."""
        self._closed.set()
        self._begun.set()
        self._thread.join()
        for live in self._on():
            live.close()
        self.world.close()

    def _on(self) -> list[SharedDrive]:
        with self._lock:
            self._people = [each for each in self._people if each.ended is None and each.is_in_world]
            return [*self._people, *(each for each in self._simulated.values() if each.ended is None)]

    def _simulate(self) -> None:
        while not self._closed.wait(_LOOK_EVERY):
            self._begun.wait()
            is_driven = any(not each.is_simulated for each in self._on())
            for name, script in self._wanted.items():
                if self._closed.is_set():
                    break
                known = self._simulated.get(name)
                if is_driven and (known is None or known.ended):
                    self._renew(name, script)
                elif known and not is_driven and not known.ended:
                    known.finish()
            if not is_driven:
                self._begun.clear()
                if self._closed.is_set():
                    return

    def _renew(self, name: str, script: Path | Script) -> None:
        wanted = self._configuration or None
        try:
            live = open_shared_drive(self.bench, self.world, wanted, driver=name, script=script)
        except DseError as error:
            self.problem = f"{name}: {error.problems[0].what}"
            return
        self.problem = ""
        live.start()
        with self._lock:
            self._simulated[name] = live
