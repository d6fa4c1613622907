from .build import build_modelica as build_modelica, check_modelica as check_modelica
from .diagram import read_diagram as read_diagram
