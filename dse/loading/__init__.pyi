from .bench.bench import read_setting as read_setting
from .bench.procedure import Procedure as Procedure
from .bench.rating import (
    Change as Change,
    RatedTest as RatedTest,
    Rating as Rating,
    Written as Written,
    case_variable as case_variable,
    parse_condition as parse_condition,
    variation_name as variation_name,
)
from .bench.variables import Place as Place
from .component.kind import (
    KINDS as KINDS,
    ComponentKind as ComponentKind,
    SourcePlace as SourcePlace,
    SourceSection as SourceSection,
    kind_of as kind_of,
)
from .component.series import Column as Column, TableSection as TableSection, read_series as read_series
from .design.connections import unknown_choices as unknown_choices
from .design.design import misfits as misfits
from .design.instances import Instances as Instances, unfold as unfold
from .extensions import (
    EXECUTORS as EXECUTORS,
    SAMPLERS as SAMPLERS,
    ExecutorSection as ExecutorSection,
    SamplerSection as SamplerSection,
    Surroundings as Surroundings,
)
from .include import read_document as read_document
from .names import check_choice as check_choice, is_identifier as is_identifier
from .paths import find_root as find_root, is_file as is_file, named_file as named_file
from .schema import FILE_KINDS as FILE_KINDS, file_schema as file_schema
from .sections import Plain as Plain, Section as Section
from .uvl.reading import read_uvl as read_uvl
from .uvl.writing import to_uvl as to_uvl
from .values import Raw as Raw, read_number as read_number, read_unit as read_unit
from .workspace import BENCH_FILE as BENCH_FILE, STUDY_FILE as STUDY_FILE, Workspace as Workspace
from .writing.bench import write_bench as write_bench
from .writing.component import (
    write_component as write_component,
    write_fmu_component as write_fmu_component,
    write_interfaces as write_interfaces,
)
from .writing.design import write_components as write_components, write_design as write_design
from .writing.study import write_narrowed as write_narrowed
