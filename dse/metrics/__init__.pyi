from .catalogue import (
    FUNCTIONS as FUNCTIONS,
    Argument as Argument,
    Function as Function,
    Wants as Wants,
    metric_function as metric_function,
    same as same,
)
from .machine import (
    Codes as Codes,
    margin_to_bounds as margin_to_bounds,
    overall_codes as overall_codes,
    verdict_codes as verdict_codes,
    worst_codes as worst_codes,
)
from .program import MetricProgram as MetricProgram, compile_metrics as compile_metrics, judge_failed as judge_failed
from .program_data import program_as_data as program_as_data
from .resolution import between_rows as between_rows
from .rows import (
    RowProgram as RowProgram,
    compile_number as compile_number,
    compile_rule as compile_rule,
    compile_value as compile_value,
)
