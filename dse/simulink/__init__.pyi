from .blocks import block_of as block_of, systems as systems
from .declarations import Number as Number, Scalar as Scalar
from .generated_model import build_library as build_library, read_model as read_model
from .glue import Chosen as Chosen, CodedModel as CodedModel, in_parts as in_parts
from .interface import Port as Port, Style as Style
from .trial_run import Trial as Trial, try_model as try_model
