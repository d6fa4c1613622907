from .c.build import build_c as build_c
from .c.describe import (
    TYPES_2 as TYPES_2,
    TYPES_3 as TYPES_3,
    add_enumerations as add_enumerations,
    add_source_files as add_source_files,
    add_time as add_time,
    add_units as add_units,
    describe_sources as describe_sources,
    description_root as description_root,
    free_name as free_name,
    model_identifier as model_identifier,
    number_text as number_text,
    xml_text as xml_text,
)
from .component_build import build as build, build_all as build_all, with_platforms as with_platforms
from .fusion.fuse import Wanted as Wanted, fuse_all as fuse_all
from .fusion.web import WebModule as WebModule, WebSystem as WebSystem, web_module as web_module
from .parallel import Tell as Tell, in_parallel as in_parallel
from .reading.description import BASE_UNITS as BASE_UNITS, base_unit as base_unit, read_description as read_description
from .reading.variables import VALUE_KINDS as VALUE_KINDS
from .slot_table import SLOT_TABLE as SLOT_TABLE, Row as Row, SlotTable as SlotTable
from .statics import shares_nothing as shares_nothing
from .toolchain.compilation import (
    LANGUAGE_OPTIONS as LANGUAGE_OPTIONS,
    MODEL_OPTIONS as MODEL_OPTIONS,
    CompilationError as CompilationError,
    Diagnostic as Diagnostic,
    compile_foreign as compile_foreign,
    compile_object as compile_object,
    foreign_options as foreign_options,
    link_library as link_library,
    options as options,
)
from .toolchain.compiler import (
    Compiler as Compiler,
    NoCompilerError as NoCompilerError,
    find_compiler as find_compiler,
    with_compiler as with_compiler,
)
from .toolchain.platforms import (
    Platform as Platform,
    platforms_named as platforms_named,
    this_platform as this_platform,
)
from .unpack import open_component as open_component, open_fmu as open_fmu
