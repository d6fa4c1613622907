"""Steps per second of a scenario on one core: ten cars on a motorway, thirty events whose conditions all stay open.

The core in C with the scenario's tables, alone in one loop, in steps of 10 ms; the median of the turns' processor time.
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path
from statistics import median

from dse.fmu.toolchain.compiler import find_compiler
from dse.world import read_scenario, scenario_files

ROOT = Path(__file__).parents[1]
TURNS, STEPS = 5, 100_000
OPTIONS = ("-std=c11", "-O2", "-ffp-contract=off")
MAIN = """
#include "scenario.h"

#include <stdio.h>
#include <time.h>

static scenario world;

int main(void) {
    world.par.drives_host = true;
    scenario_init(&world);
    clock_t start = clock();
    for (int k = 0; k < %d; ++k) scenario_step(&world, 0.01);
    printf("%%g\\n", (double)(clock() - start) / CLOCKS_PER_SEC);
    return 0;
}
"""
BOX = '<BoundingBox><Center x="1.4" y="0" z="0.75"/><Dimensions width="1.8" length="4.6" height="1.5"/></BoundingBox>'
NAMES = ("Ego", *(f"Car{number}" for number in range(1, 10)))


def entity(name: str) -> str:
    return f'<ScenarioObject name="{name}"><Vehicle name="car" vehicleCategory="car">{BOX}</Vehicle></ScenarioObject>'


def speed(value: float) -> str:
    dynamics = '<SpeedActionDynamics dynamicsShape="linear" dynamicsDimension="rate" value="1"/>'
    target = f'<SpeedActionTarget><AbsoluteTargetSpeed value="{value}"/></SpeedActionTarget>'
    action = f"<SpeedAction>{dynamics}{target}</SpeedAction>"
    return f"<PrivateAction><LongitudinalAction>{action}</LongitudinalAction></PrivateAction>"


def start(number: int, name: str) -> str:
    place = f'<LanePosition roadId="1" laneId="{-1 - number % 3}" s="{100 + 30 * number}"/>'
    teleport = f"<PrivateAction><TeleportAction><Position>{place}</Position></TeleportAction></PrivateAction>"
    return f'<Private entityRef="{name}">{teleport}{speed(20 + number)}</Private>'


def event(name: str, number: int) -> str:
    other = "Car1" if name == "Ego" else name
    condition = (
        '<ByEntityCondition><TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="Ego"/>'
        f'</TriggeringEntities><EntityCondition><RelativeDistanceCondition entityRef="{other}" value="-1" '
        'relativeDistanceType="longitudinal" coordinateSystem="road" freespace="true" rule="lessOrEqual"/>'
        "</EntityCondition></ByEntityCondition>"
    )
    trigger = (
        f'<StartTrigger><ConditionGroup><Condition name="near" delay="0" conditionEdge="rising">{condition}'
        "</Condition></ConditionGroup></StartTrigger>"
    )
    return f'<Event name="{name}{number}" priority="parallel"><Action name="a">{speed(30)}</Action>{trigger}</Event>'


def act(name: str) -> str:
    events = "".join(event(name, number) for number in range(3))
    actors = f'<Actors selectTriggeringEntities="false"><EntityRef entityRef="{name}"/></Actors>'
    group = f'{actors}<Maneuver name="{name}">{events}</Maneuver>'
    return f'<Act name="{name}"><ManeuverGroup name="{name}" maximumExecutionCount="1">{group}</ManeuverGroup></Act>'


def scenario_of_ten() -> str:
    init = "".join(start(number, name) for number, name in enumerate(NAMES))
    return (
        '<OpenSCENARIO><FileHeader revMajor="1" revMinor="2"/><RoadNetwork><LogicFile filepath="roads/motorway.yaml"/>'
        f"</RoadNetwork><Entities>{''.join(map(entity, NAMES))}</Entities><Storyboard><Init><Actions>{init}</Actions>"
        f'</Init><Story name="ten">{"".join(map(act, NAMES))}</Story><StopTrigger/></Storyboard></OpenSCENARIO>'
    )


def main() -> None:
    """Build and run it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "roads")
        path.mkdir()
        path.joinpath("motorway.yaml").write_bytes((ROOT / "roads" / "motorway.yaml").read_bytes())
        file = Path(folder, "ten.xosc")
        file.write_text(scenario_of_ten(), "utf-8")
        files = {**scenario_files(read_scenario(file, inside=Path(folder))), "main.c": MAIN % STEPS}
        for name, text in files.items():
            Path(folder, name).write_text(text, "utf-8")
        program = Path(folder, "run")
        sources = [str(Path(folder, name)) for name in files if name.endswith(".c")]
        subprocess.run([*find_compiler().command, *OPTIONS, "-o", str(program), *sources, "-lm"], check=True)
        turns = [float(subprocess.run([program], capture_output=True, check=True).stdout) for _ in range(TURNS)]
    print(f"{STEPS / median(turns):,.0f} steps/s with {len(NAMES)} entities and {3 * len(NAMES)} events")


if __name__ == "__main__":
    main()
