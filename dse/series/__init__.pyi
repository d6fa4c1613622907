from .code import c_files as c_files, struct_name as struct_name
from .samples import Samples as Samples, read_samples as read_samples
