from .assembly import (
    WiredParts as WiredParts,
    assemble as assemble,
    check_fmu as check_fmu,
    wiring_problems as wiring_problems,
)
from .binding import bind as bind, find_variable as find_variable, unit_of as unit_of
from .order import along_the_flow as along_the_flow
from .shapes import resized as resized
