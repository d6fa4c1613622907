from .tables import (
    LaneBand as LaneBand,
    Light as Light,
    Patch as Patch,
    Piecewise as Piecewise,
    RoadPath as RoadPath,
    RoadTables as RoadTables,
)
from .writing.opendrive import opendrive_of as opendrive_of
