from .code import STRUCT as STRUCT, road_files as road_files
from .tables import (
    LaneBand as LaneBand,
    Light as Light,
    Patch as Patch,
    Piecewise as Piecewise,
    RoadPath as RoadPath,
    RoadTables as RoadTables,
)
