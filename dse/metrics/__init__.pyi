from .catalogue import (
    FUNCTIONS as FUNCTIONS,
    Argument as Argument,
    Function as Function,
    Wants as Wants,
    metric_function as metric_function,
    same as same,
)
from .program import MetricProgram as MetricProgram, compile_metrics as compile_metrics, judge_failed as judge_failed
from .verdicts import Codes as Codes, margin_of as margin_of, overall as overall, verdict_of as verdict_of
