# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Sphinx: the pages of docs/ and a page for each public header."""
project = "fingerpad"
copyright = "2026 The fingerpad authors"
extensions = ["myst_parser", "breathe"]
include_patterns = ["index.md", "docs/*.md", "docs/*/*.md", "examples/README.md", "examples/data/README.md",
                    "tests/data/README.md", "reference/**"]
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
breathe_default_project = "fingerpad"
breathe_projects = {"fingerpad": "xml"}
primary_domain = "cpp"
highlight_language = "cpp"  # of unmarked blocks; formulas among them stay plain
html_theme = "furo"
html_title = "fingerpad"
html_static_path = ["narrow.css"]
html_css_files = ["narrow.css"]
html_show_sphinx = False
html_copy_source = False


def setup(app):
    """README is the first page, index."""
    def read(app, page, text):
        text[0] = text[0].replace("../README.md)", "../index.md)")
    app.connect("source-read", read)
