"""Steps per second of the world on one core: its parts in C, wired as a bench wires them, in one loop.

Each system drives along a road for some minutes of 10 ms steps, over and over; the driver, speed and steering by simple
feedback, is part of the loop. The contenders take turns, so that a machine that slows down slows them all; medians of
processor time are shown. Options are those of our FMUs.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

from dse.domain.component import Component, CSource
from dse.domain.labels import c_member
from dse.fmu.c.slots import slots
from dse.fmu.toolchain.compiler import find_compiler
from dse.loading import Workspace
from dse.world import open_roads, road_files, road_tables

ROOT = Path(__file__).parents[1]
WORKSPACE = Workspace(ROOT)
TURNS, STEPS = 9, 16_000
OPTIONS = ("-std=c11", "-O2", "-ffp-contract=off")

WORLD = (
    "car.motion -> way.motion",
    "car.contacts -> way.contacts",
    "traffic.movers -> way.movers",
    "weather.surface -> way.surface",
    "weather.air -> car.air",
    "way.ground -> car.ground",
    "way.start -> car.start",
    "way.lane -> traffic.lane",
    "car.motion -> traffic.motion",
    "way.actors -> scene.actors",
    "way.lane -> scene.lane",
    "car.motion -> scene.motion",
)
DRIVER = """
        double force = 900.0 * (27.0 - car.out.motion.speed);
        car.in.wheels.front = force > 0 ? 0.3 * force : 0;
        car.in.brake.front = force < 0 ? -0.2 * force : 0;
        car.in.brake.rear = force < 0 ? -0.1 * force : 0;
        car.in.steering = 2.7 * way.out.lane.curvature - 0.01 * way.out.lane.offset - 0.4 * way.out.lane.heading;
"""
STRAIGHT = """
        double force = 900.0 * (27.0 - world.out.speed);
        world.in.wheels.front = force > 0 ? 0.3 * force : 0;
        world.in.brake.front = force < 0 ? -0.3 * force : 0;
"""
RAYS = {"ray_count": 15, "ray_angle": 0.35}
EIGHT = {
    f"{name}[{number + 1}]": value
    for number in range(8)
    for name, value in {
        "class": 1, "lane_number": (0, 1, 1, 0, 1, 0, 1, 0)[number], "station": 60.0 + 25.0 * number,
        "speed": 26.0 + (0, 1, 0.5, 1.5, 2, 1, 3, 2)[number],
    }.items()
}  # fmt: skip


Given = Mapping[str, float]


@dataclass(frozen=True)
class Contender:
    """Parts by name, each a component with parameters; what a step does before they step; and the goal."""

    title: str
    parts: Mapping[str, tuple[str, Given]]
    feedback: str
    watched: str
    goal: float = 0
    wires: Sequence[str] = field(default=WORLD)


STRAIGHT_ROAD = {"initial_speed": 27.0, "lead_speed": 28.0}
LEAD = ("lead_vehicle", {"initial_gap": 60.0, "lead_speed": 28.0})
MANY = ("vehicles", EIGHT)


def along(
    road: str, chassis: str, car: Given, traffic: tuple[str, Given], preview: float
) -> dict[str, tuple[str, Given]]:
    return {
        "way": (road, {"start_station": 40.0, "preview_spacing": preview}),
        "weather": ("clear", {}),
        "traffic": traffic,
        "car": (chassis, {"initial_speed": 27.0, **car}),
        "scene": ("ray_scanner", RAYS),
    }


def contender(
    title: str, chassis: str, traffic: tuple[str, Given], goal: float = 0, preview: float = 0, **car: float
) -> Contender:
    return Contender(title, along("road_motorway", chassis, car, traffic, preview), DRIVER, "scene.out.gap", goal)


def crowd(title: str, goal: float = 0, **road: float) -> Contender:
    """200 vehicles on three lanes, nothing else."""
    given = {"count": 200, "left_lane": 2, "minds_host": False, **road}
    return Contender(title, {"traffic": ("stream_traffic", given)}, "", "traffic.out.everyone[0].station", goal, ())


OBJECT_SENSORS = (
    "object_radar_long", "object_radar_mid", "object_lidar", "object_camera", "object_stereo", "object_perfect",
)  # fmt: skip


def sensing(title: str, *sensors: str) -> Contender:
    parts = along("road_motorway", "single_track", {}, MANY, 0)
    eyes: dict[str, tuple[str, Given]] = {f"eye{number}": (name, {}) for number, name in enumerate(sensors)}
    wires = [f"{end} -> {eye}.{end.partition('.')[2]}" for eye in eyes for end in ("car.motion", "way.actors")]
    goal = 150e3 if len(sensors) == 3 else 0
    watched = "eye0.out.scan.returns[0].range"
    return Contender(title, parts | eyes, DRIVER, watched, goal, (*WORLD, *wires))


CONTENDERS = (
    Contender("straight_road, 1 target, 121 rays", {"world": ("straight_road", STRAIGHT_ROAD)}, STRAIGHT,
              "world.out.gap", 2e6, ()),
    Contender("straight_road, 1 target, 15 rays", {"world": ("straight_road", {**STRAIGHT_ROAD, **RAYS})}, STRAIGHT,
              "world.out.gap", 2e6, ()),
    contender("longitudinal, road, 1 target", "longitudinal", LEAD),
    contender("single track, road, 1 target", "single_track", LEAD, 600e3),
    contender("single track, road, 1 target, preview", "single_track", LEAD, preview=2.5),
    sensing("single track, 8 targets, 3 sensors", "object_radar_long", "object_lidar", "object_camera"),
    sensing("same, 6 sensors", *OBJECT_SENSORS),
    contender("two-track (10 ms), road, 8 targets", "two_track", MANY, 200e3, substeps=1),
    contender("two-track (2 ms), road, 8 targets", "two_track", MANY, 200e3, substeps=5),
    contender("two-track (2 ms), same with preview", "two_track", MANY, preview=2.5, substeps=5),
    Contender("traffic alone, 8 vehicles", {"traffic": ("idm_traffic", {**EIGHT, "left_lane": 1, "minds_host": False})},
              "", "traffic.out.movers[0].station", wires=()),
    crowd("traffic alone, 200 on a ring of 5 km", path_length=5000.0, closed=True, goal=20e3),
    crowd("traffic alone, 200 in and out of 5 km", path_length=5000.0),
    crowd("traffic alone, 200 in a jam", path_length=1300.0, closed=True),
    Contender("single track, road, 200 others", along("road_motorway", "single_track", {}, ("stream_traffic", {
        "count": 200, "path_length": 8000.0, "left_lane": 1}), 0.0), DRIVER, "scene.out.gap"),
)  # fmt: skip


def in_c(component: Component, folder: Path) -> Component:
    """*component*, or a road as the C that is built from it."""
    if isinstance(component.source, CSource):
        return component
    files = road_files(road_tables(open_roads(str(component.source.file), WORKSPACE)))  # type: ignore[union-attr]
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    units = tuple(folder / name for name in files if name.endswith(".c"))
    source = CSource(units, folder / "road.h", "road", "road_init", "road_step", None)
    return Component(component.name, component.interface, source=source, parameters=component.parameters)


def members(part: str, component: Component, end: str, side: str) -> list[str]:
    ports = component.interface.group(end.removeprefix(f"{part}."))
    assert ports, end
    return [f"{part}.{side}.{c_member(port.name)}" for port in ports]


def copies(contender: Contender, parts: Mapping[str, Component], target: str) -> Iterator[str]:
    for wire in contender.wires:
        source, end = wire.split(" -> ")
        (giving, taking) = (each.partition(".")[0] for each in (source, end))
        if taking == target:
            pairs = zip(
                members(giving, parts[giving], source, "out"), members(taking, parts[taking], end, "in"), strict=True
            )
            yield from (f"        {to} = {given};" for given, to in pairs)


def program(contender: Contender, folder: Path) -> list[str]:
    parts = {part: in_c(WORKSPACE.component(name), folder) for part, (name, _) in contender.parts.items()}
    sources = [component.source for component in parts.values()]
    assert all(isinstance(source, CSource) for source in sources)
    heads = "".join(f'#include "{source.header.as_posix()}"\n' for source in sources)
    starts = []
    for part, component in parts.items():
        given = {p.name: p.start for p in component.parameters} | dict(contender.parts[part][1])
        types = {slot.name: slot for slot in slots(component)}
        for name, value in given.items():
            number = types[name].type.items.index(value) if isinstance(value, str) else float(value)
            starts.append(f"    {part}.{types[name].member} = {number!r};")
    settle = [
        line
        for part in parts
        for line in (*copies(contender, parts, part), f"        {parts[part].source.init}(&{part});")
    ]
    steps = [
        line for part in parts for line in (*copies(contender, parts, part), f"        {call(part, parts[part])};")
    ]
    lines = [
        heads, "#include <stdio.h>", "#include <string.h>", "#include <time.h>",
        *(f"static {component.source.struct} {part};" for part, component in parts.items()),
        "int main(void) {",
        *(f"    memset(&{part}, 0, sizeof {part});" for part in parts),
        *starts,
        "    for (int i = 0; i < 4; i++) {", *settle, "    }",
        "    clock_t begin = clock();",
        f"    for (int k = 0; k < {STEPS}; k++) {{", contender.feedback, *steps, "    }",
        f'    printf("%.9g %a\\n", (double)(clock() - begin) / CLOCKS_PER_SEC, {contender.watched});',
        "    return 0;", "}",
    ]  # fmt: skip
    main = folder / "main.c"
    main.write_text("\n".join(lines), encoding="utf-8")
    target = folder / "world"
    units = sorted({str(file) for source in sources for file in source.files if file.suffix == ".c"})
    subprocess.run([*find_compiler().command, *OPTIONS, str(main), *units, "-o", str(target), "-lm"], check=True)
    return [str(target)]


def call(part: str, component: Component) -> str:
    source = component.source
    assert isinstance(source, CSource)
    return f"{source.step_function}(&{part}{'' if source.step else ', 0.01'})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--turns", type=int, default=TURNS)
    turns = parser.parse_args().turns
    with tempfile.TemporaryDirectory() as temporary:
        programs = []
        for number, contender in enumerate(CONTENDERS):
            folder = Path(temporary, str(number))
            folder.mkdir()
            programs.append(program(contender, folder))
        seconds: list[list[float]] = [[] for _ in programs]
        ends: list[set[str]] = [set() for _ in programs]
        for _ in range(turns):
            for number, command in enumerate(programs):
                printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
                seconds[number].append(float(printed[0]))
                ends[number].add(printed[1])
    print(f"{'':38}{'steps/s':>12}{'wanted':>12}  at the end")
    for contender, taken, end in zip(CONTENDERS, seconds, ends, strict=True):
        assert len(end) == 1, "other bits in another run"
        wanted = f"{contender.goal:,.0f}" if contender.goal else ""
        print(f"{contender.title:38}{STEPS / median(taken):12,.0f}{wanted:>12}  {float.fromhex(*end):.6f}")


if __name__ == "__main__":
    main()
