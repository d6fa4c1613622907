from .assembly import (
    Elements as Elements,
    WiredParts as WiredParts,
    along_the_flow as along_the_flow,
    assemble as assemble,
    check_fmu as check_fmu,
    resized as resized,
    wiring_problems as wiring_problems,
)
from .binding import bind as bind, find_variable as find_variable, unit_of as unit_of
