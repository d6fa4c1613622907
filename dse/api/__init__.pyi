from .authoring.components import Component as Component, Interface as Interface
from .contents import (
    ListedFile as ListedFile,
    ListedResults as ListedResults,
    Listing as Listing,
    listing as listing,
    study_folders as study_folders,
)
from .drives.folder import CheckedDrive as CheckedDrive, Drives as Drives, study_name as study_name
from .drives.live import MOST_DRIVER as MOST_DRIVER, LiveDrive as LiveDrive, open_drive as open_drive
from .drives.score_board import SCORING as SCORING, Board as Board, Score as Score, board_of as board_of
from .drives.shared import (
    SharedDrive as SharedDrive,
    open_shared_drive as open_shared_drive,
    shared_without as shared_without,
)
from .lookup import (
    aims_of as aims_of,
    condition_of as condition_of,
    new_folder as new_folder,
    opened as opened,
    space_of as space_of,
    study_folder as study_folder,
    workspace_of as workspace_of,
)
from .packages import simulate as simulate, simulate_package as simulate_package
from .presentation.choice_text import choice_lines as choice_lines
from .presentation.decision_text import (
    assumed_text as assumed_text,
    certainty_text as certainty_text,
    order_text as order_text,
    share_text as share_text,
    title_of as title_of,
)
from .presentation.definition_rows import (
    metric_rows as metric_rows,
    ranking_as_data as ranking_as_data,
    requirement_labels as requirement_labels,
)
from .presentation.progress import progress_bar as progress_bar
from .presentation.quantities import difference as difference, quantity as quantity
from .probe import (
    consequences as consequences,
    facts_as_data as facts_as_data,
    known_facts as known_facts,
    model_of as model_of,
    numerics_as_data as numerics_as_data,
    probe_fmu as probe_fmu,
    probe_numerics as probe_numerics,
)
from .roads import (
    is_road as is_road,
    opendrive_text as opendrive_text,
    picture_of as picture_of,
    write_road_mesh as write_road_mesh,
)
from .scenarios import (
    PlayedScenario as PlayedScenario,
    element_times as element_times,
    export_scenario as export_scenario,
    play_scenario as play_scenario,
    scenario_picture as scenario_picture,
)
from .spaces.dealership import (
    Dealership as Dealership,
    choices_text as choices_text,
    read_choices_text as read_choices_text,
)
from .spaces.design import Design as Design, Ranking as Ranking
from .studies.bench import Bench as Bench, Study as Study
from .studies.comparison import (
    Compared as Compared,
    Flip as Flip,
    compare as compare,
    comparison_as_data as comparison_as_data,
    flip_counts as flip_counts,
)
from .studies.component_comparison import (
    Apart as Apart,
    Column as Column,
    Pair as Pair,
    compare_components as compare_components,
    pair_as_data as pair_as_data,
)
from .studies.exploration import (
    ExplorationInterruptedError as ExplorationInterruptedError,
    Explored as Explored,
    ExploreOptions as ExploreOptions,
    Merged as Merged,
    Plan as Plan,
    Progress as Progress,
    explore_into as explore_into,
    merge_into as merge_into,
    plan_into as plan_into,
)
from .studies.prepared_run import PreparedRun as PreparedRun, unpacked_run as unpacked_run
from .studies.provenance import trust as trust
from .studies.refinement import Towards as Towards, refine as refine
from .studies.replay import replay as replay
from .studies.results import Results as Results, Summary as Summary, results as results
from .studies.run import Run as Run, Waveforms as Waveforms
from .studies.scenes import replay_file as replay_file
from .studies.single_run import (
    fused_libraries as fused_libraries,
    prepare_once as prepare_once,
    study_of_bench as study_of_bench,
    write_package as write_package,
)
from .studies.status import (
    Status as Status,
    StudySummary as StudySummary,
    seconds_left as seconds_left,
    status as status,
    status_as_data as status_as_data,
    statuses as statuses,
    stop as stop,
    study_summary as study_summary,
)
from .studies.what_if import WhatIfRun as WhatIfRun, what_if_run as what_if_run
from .studies.worlds import (
    HEAD_BYTES as HEAD_BYTES,
    VALUE_BYTES as VALUE_BYTES,
    WorldLayout as WorldLayout,
    WorldPlace as WorldPlace,
    serve_bench as serve_bench,
    world_at as world_at,
    world_layout as world_layout,
    write_world as write_world,
)
from .templates.bench import new_bench as new_bench
from .templates.component import new_component as new_component
from .templates.design import new_design as new_design
from .templates.road import new_road as new_road
from .templates.study import new_study as new_study
from .templates.vehicle_interfaces import (
    VEHICLE_INTERFACES as VEHICLE_INTERFACES,
    new_vehicle_interfaces as new_vehicle_interfaces,
)
from .templates.write import write_start as write_start
from .workspace import Workspace as Workspace, open as open
