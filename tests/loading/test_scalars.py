"""Every character of a YAML text is found where it stands, however the text is quoted, folded or escaped."""

from __future__ import annotations

import io

from hypothesis import given, settings, strategies as st
from ruamel.yaml import YAML
from ruamel.yaml.scalarstring import (
    DoubleQuotedScalarString,
    FoldedScalarString,
    LiteralScalarString,
    SingleQuotedScalarString,
)

from dse.domain.expression import locate
from dse.formats.yaml import read_yaml

STYLES = (str, SingleQuotedScalarString, DoubleQuotedScalarString, LiteralScalarString, FoldedScalarString)
WORDS = st.lists(
    st.sampled_from(["sum(cost)", "<=", "it's", "5 EUR", '"x"', "a\\b", "é", "#", "or"]), min_size=1, max_size=30
)


@settings(max_examples=200, deadline=None)
@given(WORDS, st.sampled_from(STYLES), st.integers(0, 3), st.sampled_from(["\n", "\r\n"]))
def test_every_character_is_told_where_it_is_written(tmp_path_factory, words, style, indent, line_break):
    text = "".join(word + ("\n" if number % 7 == 6 else " ") for number, word in enumerate(words)).strip()
    out = io.StringIO()
    yaml = YAML()
    yaml.width = 30
    yaml.dump({"deep": {"x" * (indent + 1): style(text)}}, out)
    path = tmp_path_factory.getbasetemp() / "text.yaml"
    path.write_bytes(out.getvalue().replace("\n", line_break).encode())
    document = read_yaml(path)
    ((key, value),) = document.data["deep"].items()
    lines = out.getvalue().split("\n")
    for number, sign in enumerate(value):
        where = locate(value, document.top["deep"][key].origin, number)
        written = lines[where.line - 1][where.column - 1 : where.column + 1]
        if not sign.isspace():
            assert written[:1] == sign or written[0] == "\\", (number, sign, written, out.getvalue())
