"""The C of a scenario: the core in ``core``, its tables, and the struct that an FMU is made of."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from dse.errors import Location, fail
from dse.world.code import core_files, table_files
from dse.world.flatten import path_along
from dse.world.lane_graph import lane_graph
from dse.world.openscenario.scenario import Scenario
from dse.world.openscenario.tables import NONE
from dse.world.tables import RoadTables

SCENARIO = "scenario"
"""The name of the struct in C, and of the header."""
_CORE = Path(__file__).parent / "core"


def scenario_files(scenario: Scenario) -> dict[str, str]:
    """The files by name, for the FMU of a component of the interface ``scenario``."""
    files = {path.name: path.read_text("utf-8") for path in sorted(_CORE.glob("*.[ch]"))}
    roads = core_files("path.[ch]") | core_files("foot.[ch]")
    if scenario.paths:
        roads |= table_files(RoadTables(tuple(each.path for each in scenario.paths)))
    else:
        roads["road_tables.c"] = '#include "path.h"\n\nconst road_network road_tables = {0};\n'
    fields = "\n".join(f"        double {each.name};" for each in scenario.parameters)
    files["scenario.h"] = _HEADER.replace("@PARAMETERS@", fields)
    return {
        **roads,
        **files,
        "scenario_sizes.h": scenario.tables.sizes(),
        "scenario_tables.c": scenario.tables.c(scenario.host),
        "scenario_numbers.c": _NUMBERS.replace("@NUMBERS@", scenario.tables.numbers_c()),
    }


def host_tables(scenario: Scenario, where: Location | None) -> RoadTables:
    """The road that the host of a scenario drives, with its lanes for vehicles. Raises DseError: there is none."""
    host = scenario.tables.rows["entities"][scenario.host] if scenario.host != NONE else {"path": NONE}
    assert isinstance(host, Mapping)  # noqa: S101  # by construction
    number = host["path"]
    if scenario.network is None or not isinstance(number, int) or number == NONE:
        raise fail("the scenario has no host on a road", where, "name its entity: 'host'")
    path = path_along(lane_graph(scenario.network), scenario.paths[number].way, "host")
    return RoadTables((path,))


_HEADER = """\
/* Road users of an OpenSCENARIO file; its storyboard decides what they do. */
#ifndef SCENARIO_H
#define SCENARIO_H

#include "storyboard.h"

#define SCENARIO_MOVERS 8
#define SCENARIO_SEEN 48
#define SCENARIO_STATES 256

typedef struct {
    int32_t id, class;
    double length, width, height, clearance;
    int32_t path;
    double lane, station, offset, turn;
    double speed, lateral_speed, acceleration;
} scenario_mover;

typedef struct {
    struct {
        struct {
            double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
        } motion;
        struct {
            double station, offset, heading, curvature, width, grade, bank, speed_limit;
            bool on_road;
        } lane;
        struct {
            double friction_loss, water_film, temperature;
        } surface;
    } in;
    struct {
        scenario_mover movers[SCENARIO_MOVERS], everyone[SCENARIO_SEEN];
        struct {
            bool given;
            double x, y, heading, speed;
        } host_start;
        int32_t states[SCENARIO_STATES];
        bool ended;
    } out;
    struct {
        bool drives_host;
        double host_front;
@PARAMETERS@
    } par;
    storyboard board;
    int32_t shown[SCENARIO_MOVERS];
    bool is_undefined; /* an expression has no finite value with these parameters, which ends the run by name */
} scenario;

void scenario_init(scenario *self);
void scenario_step(scenario *self, double h);

/* The numbers of the tables and the variables at the start, from the parameters. */
void scenario_numbers(scenario *self);

#endif
"""
_NUMBERS = """\
#include "scenario.h"

#include <math.h>

static inline double sign_of(double x) {
    return (x > 0) - (x < 0);
}

static inline double defined(scenario *self, double x) {
    if (!isfinite(x)) self->is_undefined = true;
    return x;
}

void scenario_numbers(scenario *self) {
    double *values = self->board.values, *variables = self->board.variables;
    const double unused = defined(self, sign_of(0));
    (void)unused;
    (void)variables;
@NUMBERS@
}
"""
