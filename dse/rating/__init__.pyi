from .cases import described as described
from .designs import (
    RatedConfiguration as RatedConfiguration,
    RatedDesign as RatedDesign,
    rate as rate,
)
from .page import HEADING as HEADING, page_of as page_of, write_page as write_page
from .protocol import Protocol as Protocol
from .verification import (
    CHECK as CHECK,
    CaseVerdict as CaseVerdict,
    Verification as Verification,
    designs_of as designs_of,
    verify as verify,
)
from .workbook import Filled as Filled, Prediction as Prediction, Score as Score, fill as fill
