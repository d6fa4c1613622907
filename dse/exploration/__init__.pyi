from .executor import Executor as Executor, load_executor as load_executor
from .known_runs import KnownRuns as KnownRuns, give as give
from .loop import ExplorationInterruptedError as ExplorationInterruptedError, Explored as Explored, explore as explore
from .once_sampler import OnceSampler as OnceSampler, scaled as scaled
from .progress import Progress as Progress
from .remote import Carried as Carried, carry_out as carry_out, hand_over as hand_over, parcel as parcel
from .supervision.single_run import simulate_alone as simulate_alone
from .work import Batch as Batch, Sink as Sink, Work as Work
