"""A simulation of traffic by SUMO in a process of its own, without an FMU: ``python sumo_drive.py < JSON > JSON``.

Given are a *folder* with resources, *parameters*, and for each step the *inputs*; told are the movers of each step, and
where SUMO itself has the front of each that is told of, or why it could not go on.
"""

import json
import sys
from pathlib import Path

from dse.world.sumo.simulation import Simulation, SumoError

given = json.load(sys.stdin)
simulation = Simulation(Path(given["folder"]), given["parameters"])
names = simulation._slots
rows, places, error = [simulation.look(given["inputs"][0])], [], ""
try:
    for inputs in given["inputs"]:
        rows.append(simulation.step(inputs, given["h"]))
        places.append([simulation._sumo.vehicle.getPosition(name) if name else None for name in simulation._slots])
except SumoError as told:
    error = str(told)
json.dump({"rows": rows, "places": places, "error": error}, sys.stdout)
