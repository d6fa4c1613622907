from ._generated import build_generated as build_generated
from .fmu import FmuSource as FmuSource
from .road import RoadSource as RoadSource, roads_of as roads_of, tables_along as tables_along
from .scenario import ScenarioSource as ScenarioSource
from .simulink import SimulinkSource as SimulinkSource
