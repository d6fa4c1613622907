from .line import (
    END as END,
    START as START,
    STEP as STEP,
    Line as Line,
    Question as Question,
    how_ended as how_ended,
    open_line as open_line,
)
from .python_class import ABOUT as ABOUT
