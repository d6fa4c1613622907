from .code import STRUCT as STRUCT, road_files as road_files
from .conflict_areas import WIDTH as WIDTH, ConflictArea as ConflictArea, find_conflict_areas as find_conflict_areas
from .cross_section import borders_of as borders_of
from .evaluation import (
    PathPoint as PathPoint,
    lane_middle as lane_middle,
    place as place,
    project as project,
    wrapped as wrapped,
)
from .flatten import path_along as path_along, read_road_tables as read_road_tables, road_tables as road_tables
from .in_the_way import (
    CLASSES as CLASSES,
    HEIGHTS as HEIGHTS,
    LEVEL as LEVEL,
    STEEPEST as STEEPEST,
    on_one_level as on_one_level,
    user_bits as user_bits,
    users_of as users_of,
)
from .joints import STRICT as STRICT, Tolerance as Tolerance
from .lane_graph import LaneGraph as LaneGraph, LanePlace as LanePlace, lane_graph as lane_graph
from .opendrive.curves import Curve as Curve, curve_of as curve_of
from .opendrive.driving import DRIVEN as DRIVEN, runs_along as runs_along
from .opendrive.reading import network_in as network_in, read_network as read_network
from .opendrive.roadside import COLOURS as COLOURS, PHASES as PHASES, SHIFT as SHIFT
from .opendrive.scenery import PlacedObject as PlacedObject, PlacedSign as PlacedSign, RoadMark as RoadMark
from .opendrive.structure import Lane as Lane, Network as Network, Road as Road, Signal as Signal
from .openscenario.code import (
    SCENARIO as SCENARIO,
    host_tables as host_tables,
    scenario_files as scenario_files,
)
from .openscenario.distributions import (
    CaseSet as CaseSet,
    Uncertain as Uncertain,
    Variation as Variation,
    case_sets as case_sets,
    cut_off as cut_off,
    is_variation as is_variation,
    read_variation as read_variation,
)
from .openscenario.scenario import (
    OWN_PARAMETERS as OWN_PARAMETERS,
    Scenario as Scenario,
    read_scenario as read_scenario,
)
from .pieces import from_cubics as from_cubics, value as value
from .road_reader import open_roads as open_roads, opendrive_text as opendrive_text
from .routes import Route as Route, list_ways as list_ways, way_of as way_of
from .sumo.resources import sumo_resources as sumo_resources, sumo_version as sumo_version
from .tables import (
    Conflict as Conflict,
    LaneBand as LaneBand,
    Leg as Leg,
    Light as Light,
    Patch as Patch,
    PathOrder as PathOrder,
    Piecewise as Piecewise,
    RoadPath as RoadPath,
    RoadTables as RoadTables,
)
from .way_ends import route_notes as route_notes, way_end as way_end
from .ways import Way as Way, way_length as way_length
from .writing.opendrive import opendrive_of as opendrive_of
