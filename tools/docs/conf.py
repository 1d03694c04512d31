"""Sphinx: how the site is made of the pages that build.py has put together."""

import os
import re
from pathlib import Path

from breathe.renderer.sphinxrenderer import SphinxRenderer
from sphinx.domains import cpp

project = "vesalius"
author = "the vesalius project"
copyright = "the vesalius project; Apache 2.0"  # noqa: A001  (the name is Sphinx's)
version = release = os.environ["VESALIUS_VERSION"]
root_doc = "index"
extensions = ["myst_parser", "breathe", "sphinx_copybutton"]

# As on a page of a repository: every heading can be linked to.
myst_heading_anchors = 4
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
highlight_language = "none"
# Files of the repository that pages link to are no pages.
exclude_patterns = ["project/**/*.txt"]

breathe_projects = {"vesalius": os.environ["VESALIUS_DOXYGEN_XML"]}
breathe_default_project = "vesalius"
breathe_show_include = False
breathe_show_define_initializer = False
primary_domain = "cpp"


def contents_of_namespace(renderer, node):
    """What a header has in a namespace, with full names: Breathe would open the same namespace anew for each header."""
    data = renderer.compound_parser.parse(node.refid)
    return renderer.render(data, renderer.context.create_child_context(data))


SphinxRenderer.visit_namespace = contents_of_namespace


def remember_identifiers(app, env):
    """Sphinx computes the identifiers of declarations again for each reference that it looks up: a third of the time. Once all pages
    are read they do not change any more."""
    compute = cpp.ASTDeclaration.get_newest_id

    def remembered(declaration):
        if not hasattr(declaration, "remembered_id"):
            declaration.remembered_id = compute(declaration)
        return declaration.remembered_id

    cpp.ASTDeclaration.get_newest_id = remembered


html_theme = "furo"
# Of the styles that come with Pygments these have enough contrast, which check_pages.py measures.
pygments_style = "xcode"
pygments_dark_style = "github-dark"
html_title = f"vesalius {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
# Opened as files: a page cannot read others for excerpts, and sources are in the repository.
html_show_search_summary = False
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
# What a program says is not for the clipboard.
copybutton_selector = "div:not(.highlight-text) > div.highlight pre"


def mend_theme(app, error):
    """Debian's Furo comes as it is before it is built: its script as two modules, which browsers refuse to pages that are opened
    as files, and its style without the dark colours for readers whose system asks for them."""
    if error is not None:
        return
    static = Path(app.outdir) / "_static"
    script = static / "scripts/furo.js"
    first, _, rest = script.read_text().partition("\n")
    if first.startswith("import Gumshoe"):
        script.write_text((static / "scripts/gumshoe-patched.js").read_text() + rest)
    style = static / "styles/furo.css"
    text = style.read_text()
    dark = re.search(r'body\[data-theme="dark"\] \{([^}]*)\}', text)
    if dark and "prefers-color-scheme" not in text:
        style.write_text(f'{text}\n@media not print and (prefers-color-scheme: dark) {{ body:not([data-theme="light"]) {{{dark[1]}}} }}\n')


def setup(app):
    app.connect("env-updated", remember_identifiers)
    app.connect("build-finished", mend_theme)
