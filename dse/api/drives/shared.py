"""A drive among others: a seat in a world that several people share."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.drives.live import LiveDrive, View, _value, drivable, opened, wire
from dse.errors import DseError, Location, fail
from dse.formats import shown

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.live import Patience, Place, Script, Session, SharedWorld, Sharing, Sights

_MOST_LINES = 100_000


@dataclass(frozen=True, slots=True)
class Seating:
    """Where a drive takes place: its *place* in *world*, and what *script* drives there, if one does."""

    world: SharedWorld
    place: Place
    sharing: Sharing
    sights: Sights
    script: Script | None = None


class SharedDrive(LiveDrive):
    """A `LiveDrive` whose car is in a world with others. Its record has their cars, so that it can be repeated."""

    seating: Seating

    @property
    def settings(self) -> Mapping[str, float]:
        """Where it started."""
        return {_start(self.seating.sharing): self.seating.place.start}

    @property
    def is_simulated(self) -> bool:
        """Whether a script or the bench's own driver drives."""
        return self.seating.script is not None

    @property
    def is_in_world(self) -> bool:
        """Whether its seat is still its own."""
        return self.seating.place in self.seating.world.places

    def close(self) -> None:
        """End it at once, wait until its process is gone, and leave the world."""
        super().close()
        self.seating.world.leave(self.seating.place)

    def _begun(self, patience: Patience | None) -> Session:
        from dse.live import SeatSession

        seating = self.seating
        return SeatSession(
            self._prepared,
            self.driver_in_loop,
            self._first,
            patience,
            world=seating.world,
            place=seating.place,
            sights=seating.sights,
            script=seating.script,
        )


def open_shared_drive(
    bench: TestBench,
    world: SharedWorld,
    configuration: str | None = None,
    *,
    driver: str = "",
    script: Path | Script | None = None,
    fmi: int = 2,
) -> SharedDrive:
    """Have all ready to drive *bench* in *world*, with the configuration whose id starts so, or the first.

    With a *script*, a file as `read_script` takes it, no person drives. Raises DseError if the bench cannot be driven
    or shared, or if the world has no place.
    """
    from dse.live import MOTION, Car, Sights, sharing_of, traffic_left_out, traffic_of, without_traffic

    chosen = drivable(bench, configuration)
    sharing = sharing_of(bench, chosen)
    wired = wire(without_traffic(bench, sharing), chosen)
    view = View(wired, bench.simulation.stop)
    if not world.has_traffic and (traffic := traffic_of(bench, chosen, sharing, version=fmi)):
        traffic.take_part(world)
    left_out = traffic_left_out(bench, chosen, sharing)
    view.document["subtitle"] = "shared, without the bench's traffic" if left_out else "shared"
    car = next((n.removesuffix(".motion.heading") for n in wired.signals if n.endswith(".motion.heading")), "")
    if not car:
        raise fail(f"bench '{bench.name}' cannot be shared: no part gives 'motion', which others see", bench.where)
    seen = [f"{car}.motion.{axis}" for axis in MOTION]
    seen += [f"{sharing.road}.lane.{name}" for name in ("station", "offset")]
    also = [name for name in seen if name in wired.signals and name not in view.wanted]
    host, start = view.host, wired.settings[_start(sharing)].value
    others = Car(host.length, host.width, place=host.front - host.length / 2)
    place = world.admit(others, float(start), sharing.fields, sharing.places)
    place.has_clock = sharing.has_clock
    try:
        placed = replace(bench, parameters={**bench.parameters, _start(sharing): place.start})
        parts = opened(placed, chosen, view, also, sharing, fmi=fmi)
        live = SharedDrive(*parts, driver, bench)
        if isinstance(script, Path):
            script = read_script(script, live)
        sights = Sights.of(parts[0].seen, car, sharing.road)
        live.seating = Seating(world, place, sharing, sights, script)
    except BaseException:
        world.leave(place)
        raise
    return live


def shared_without(bench: TestBench, configuration: str | None = None) -> str:
    """What a world shared on *bench* lacks, as a sentence; "" for nothing. Raises DseError if it cannot be shared."""
    from dse.live import sharing_of, traffic_left_out

    chosen = drivable(bench, configuration)
    return traffic_left_out(bench, chosen, sharing_of(bench, chosen))


def read_script(file: Path, live: LiveDrive) -> Script:
    """What a simulated driver of *live* does, from a table: ``time`` in s, ascending, then controls in SI.

    Items are named or numbered; what is empty stays as it is. Raises DseError with the line.
    """
    from dse.live import Script

    where = Location(shown(file))
    try:
        lines = [*csv.reader(file.read_text("utf-8").splitlines()[: _MOST_LINES + 1])]
    except (OSError, ValueError, csv.Error) as error:
        raise fail(f"cannot be read: {error}", where) from None
    names = [name.strip() for name in lines[0]] if lines else []
    ports = {port.name: port for port in live.driver_in_loop.controls}
    if names[:1] != ["time"] or not names[1:] or not {*names[1:]} <= ports.keys() or len(lines) > _MOST_LINES:
        hint = f"the first line is: time, then some of {', '.join(ports)}"
        raise fail("is not a script of a driver", where, hint)
    times, values, now = list[float](), list[Mapping[str, float]](), dict[str, float]()
    for number, line in enumerate(lines[1:], 2):
        cells = dict(zip(names, map(str.strip, line), strict=False))
        try:
            time = float(cells.pop("time"))
            now = now | {n: _value(ports[n], n, _number(cell)) for n, cell in cells.items() if cell}
        except (ValueError, KeyError, DseError) as error:
            raise fail(str(error), Location(where.file, number, 1)) from None
        if times and not time > times[-1]:
            raise fail("the times are not ascending", Location(where.file, number, 1))
        times.append(time)
        values.append(now)
    return Script(tuple(times), tuple(values))


def _number(cell: str) -> object:
    if cell in ("true", "false"):
        return cell == "true"
    try:
        number = float(cell)
    except ValueError:
        return cell
    return int(number) if number.is_integer() else number


def _start(sharing: Sharing) -> str:
    from dse.live import START

    return f"{sharing.road}.{START}"
