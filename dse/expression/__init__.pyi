from .parse import parse_expression as parse_expression
from .sorts import (
    PLAIN as PLAIN,
    TRUTH as TRUTH,
    Form as Form,
    Sort as Sort,
    binary_sort as binary_sort,
    choice_sort as choice_sort,
    error_in as error_in,
    require_alike as require_alike,
    require_number as require_number,
    require_truth as require_truth,
    unary_sort as unary_sort,
)
from .text import decimal as decimal, show_expression as show_expression, text_of as text_of
from .tokens import COMPARISON_OPERATORS as COMPARISON_OPERATORS, KEYWORDS as KEYWORDS, error_at as error_at
from .tree import (
    DEEPEST as DEEPEST,
    balanced as balanced,
    children as children,
    descend as descend,
    rewritten as rewritten,
    same as same,
    too_deep as too_deep,
)
