"""Sphinx's settings, for `docs/site/make.py`."""

from __future__ import annotations

from finish import finish
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

import dse

project = "dse"
author = "the dse authors"
project_copyright = "the dse authors, Apache-2.0"
release = dse.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc"]
root_doc = "index"
include_patterns = ["*.md", "docs/**.md", "docs/**.ipynb", "reference/**.md", "**/README.md"]
default_role = "py:obj"
# Types in signatures are of other packages or of inner modules; they have no page here. Names in texts must have one.
nitpick_ignore_regex = [("py:class", r".*")]

myst_enable_extensions = ["html_image", "attrs_block"]
myst_heading_anchors = 4
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
toc_object_entries = False
autodoc_preserve_defaults = True
python_maximum_signature_line_length = 80

html_theme = "furo"
html_title = f"dse {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False


def setup(app: Sphinx) -> None:
    """Adds a lexer for tables with commas, which Pygments lacks, and what is made after the pages."""
    app.add_lexer("csv", TextLexer)
    app.connect("build-finished", finish)
