from .attempts import STOPPED as STOPPED, Attempt as Attempt, made_by as made_by, this_process as this_process
from .checks import (
    CERTAINTIES as CERTAINTIES,
    NO_CHECKS as NO_CHECKS,
    Certainty as Certainty,
    Checks as Checks,
    certainties_by_bars as certainties_by_bars,
)
from .database.connection import damaged_study as damaged_study
from .database.header import StudyHeader as StudyHeader
from .database.run_counts import Maker as Maker, RunCounts as RunCounts
from .database.sampler_requests import SamplerRequests as SamplerRequests
from .database.table import RunTable as RunTable
from .difference import (
    changed_inputs as changed_inputs,
    changed_results as changed_results,
    changed_study as changed_study,
)
from .disk import UnreadableError as UnreadableError
from .draws import (
    draws_sentence as draws_sentence,
    groups_of as groups_of,
    outcomes_over_draws as outcomes_over_draws,
    over_draws as over_draws,
    shares_of as shares_of,
)
from .drives import (
    drive_id as drive_id,
    driver_name as driver_name,
    read_drive as read_drive,
    write_drive as write_drive,
)
from .dry_run import DryRun as DryRun
from .export.headings import (
    Scale as Scale,
    Units as Units,
    choice_columns as choice_columns,
    headed as headed,
    scales_of as scales_of,
    si_unit as si_unit,
    titles_of as titles_of,
    total_columns as total_columns,
    units_of as units_of,
)
from .export.tables import (
    EXPORTS as EXPORTS,
    run_as_data as run_as_data,
    to_arrow as to_arrow,
    to_frame as to_frame,
)
from .export.waveform_file import write_waveform_file as write_waveform_file
from .folder import StudyFolder as StudyFolder
from .lock import LOCK as LOCK, Writer as Writer, WriterLock as WriterLock, writer_of as writer_of
from .merge import Merged as Merged, merge_studies as merge_studies, shards_in as shards_in
from .rows import Measures as Measures, RowBlock as RowBlock, block_of as block_of
from .run_store import RunStore as RunStore
from .waveform_check import FileFacts as FileFacts, checked as checked
from .waveforms import (
    gather_waveforms as gather_waveforms,
    read_all_waveforms as read_all_waveforms,
    read_chosen_waveforms as read_chosen_waveforms,
    read_waveforms as read_waveforms,
    waveform_file as waveform_file,
    write_waveforms as write_waveforms,
)
from .write_ahead_log import (
    LoggedBatch as LoggedBatch,
    LogWriter as LogWriter,
    assemble as assemble,
    clear_log as clear_log,
    logged_names as logged_names,
    read_log as read_log,
    write_logged as write_logged,
)
