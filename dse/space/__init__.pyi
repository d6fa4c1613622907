from .check import check_space as check_space
from .configurations.ids import IdentifiedChoices as IdentifiedChoices
from .configurations.wiring import architecture_outputs as architecture_outputs, wire as wire
from .decisions import alternatives as alternatives, combinations as combinations
from .flat import Rows as Rows
from .methods.tally import Tally as Tally, significant as significant
from .output.sheet import Sheet as Sheet
from .output.sums import summed_properties as summed_properties
from .questions.dealership import Dealership as Dealership
from .questions.difference import Difference as Difference
from .questions.explain import Broken as Broken, Explanation as Explanation
from .questions.impact import Impact as Impact
from .questions.nearest import Change as Change, Nearest as Nearest
from .questions.occurrence import Occurrence as Occurrence
from .questions.offer import (
    ChoicePoint as ChoicePoint,
    Offer as Offer,
    OfferedChoice as OfferedChoice,
    OfferedTotal as OfferedTotal,
)
from .questions.optimum import Aim as Aim, Ranked as Ranked, read_aims as read_aims
from .questions.picking import Option as Option, Picking as Picking, Range as Range
from .restriction.constraint_sets import switched as switched
from .space import OpenedSpace as OpenedSpace, open_space as open_space
