from .api import (
    Bench as Bench,
    Column as Column,
    Compared as Compared,
    Component as Component,
    Design as Design,
    ExplorationInterruptedError as ExplorationInterruptedError,
    Interface as Interface,
    Progress as Progress,
    Ranking as Ranking,
    Results as Results,
    Run as Run,
    Study as Study,
    Waveforms as Waveforms,
    Workspace as Workspace,
    compare as compare,
    compare_components as compare_components,
    open as open,
    results as results,
    simulate as simulate,
)
from .errors import DseError as DseError, Problem as Problem
from .space import Explanation as Explanation, Tally as Tally

__version__: str
