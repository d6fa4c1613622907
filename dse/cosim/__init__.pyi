from .failure.progress import (
    PROGRESS_BYTES as PROGRESS_BYTES,
    describe_progress as describe_progress,
    run_and_step as run_and_step,
)
from .feasibility import require_kernel as require_kernel, simulation_problems as simulation_problems
from .instance_budget import most_runs as most_runs
from .probing.child import ProbeLimits as ProbeLimits
from .probing.numerics import probe_numerics as probe_numerics
from .probing.probe import probe as probe
from .simulator import RunFailed as RunFailed, Simulator as Simulator
