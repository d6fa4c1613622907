from .address import address_of as address_of
from .check import check_workspace as check_workspace
from .error_bar_selection import checked_benches as checked_benches, require_checkable as require_checkable
from .facts import (
    KnownFmus as KnownFmus,
    consequences as consequences,
    facts_as_data as facts_as_data,
    keep_facts as keep_facts,
    known_facts as known_facts,
)
from .multi_bench import Prepared as Prepared, make_runner as make_runner, on_bench as on_bench, singly as singly
from .numerics import numerics_as_data as numerics_as_data, numerics_of_element as numerics_of_element
from .objectives import (
    compile_objective as compile_objective,
    with_composites as with_composites,
)
from .prepare import (
    check_bench as check_bench,
    halves_of as halves_of,
    prepare_bench as prepare_bench,
    prepare_unmeasured as prepare_unmeasured,
    prepare_world as prepare_world,
    with_facts as with_facts,
)
from .prepared_bench import PreparedBench as PreparedBench, Recording as Recording
from .selection import one_configuration as one_configuration
from .split_bench import Halves as Halves, WorldPlace as WorldPlace, near_half as near_half
from .study import (
    PreparedStudy as PreparedStudy,
    bench_study as bench_study,
    prepare_study as prepare_study,
    with_settings as with_settings,
    with_values as with_values,
)
from .wired_bench import WiredBench as WiredBench, wire_bench as wire_bench
