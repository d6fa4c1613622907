from .band import Band as Band, Chances as Chances, VerdictModel as VerdictModel
from .boundary_checks import (
    Checkable as Checkable,
    check_measures as check_measures,
    check_near_boundary as check_near_boundary,
)
from .designs import (
    Designs as Designs,
    designs_of as designs_of,
    equal_rows as equal_rows,
    front_of as front_of,
)
from .executor import Executor as Executor, Pool as Pool, load_executor as load_executor
from .failure_share import FailureShare as FailureShare, failure_shares as failure_shares
from .failures import in_words as in_words
from .known_runs import (
    NOT_REPRODUCIBLE as NOT_REPRODUCIBLE,
    KnownRuns as KnownRuns,
    forget_unsettled as forget_unsettled,
    give as give,
)
from .loop import ExplorationInterruptedError as ExplorationInterruptedError, Explored as Explored, explore as explore
from .one_shot_sampler import OneShotSampler as OneShotSampler
from .optimization.front import hypervolume as hypervolume, knee as knee
from .progress import Progress as Progress
from .remote.futures import FuturesExecutor as FuturesExecutor
from .supervision.single_run import simulate_alone as simulate_alone
from .surrogate import single_threaded as single_threaded
from .variables import (
    allowing as allowing,
    conditions_of as conditions_of,
    design_variable as design_variable,
    scaled as scaled,
    unit_of as unit_of,
)
from .work import Batch as Batch, Sink as Sink, Work as Work
