"""The documentation's site, by Sphinx: `make docs`. The pages are the Markdown of this folder and of
the root, arranged by scripts/docs_source.py."""

import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(root / "bindings" / "python"))

project = "cullhull"
author = "the cullhull authors"
copyright = author
version_header = (root / "include" / "cullhull" / "version.hpp").read_text()
release = version = re.search(r'#define CULLHULL_VERSION "([^"]+)"', version_header)[1]

extensions = [
    "myst_parser",
    "breathe",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinx_design",
]
root_doc = "index"
source_suffix = {".md": "markdown"}
exclude_patterns = ["requirements.txt", "site"]
default_role = "code"  # `name` in docstrings
suppress_warnings = [
    "duplicate_declaration.cpp",  # every header opens the same namespace
    "myst.header",  # a page taken whole may begin at any level
    "autosummary.import_cycle",  # modules of the package are named whole in the tables
    "ref.python",  # a name of an attribute that two classes have, in the words for an array's shape
]

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4

breathe_default_project = "cullhull"
breathe_projects = {}  # scripts/docs-site.sh says where
breathe_default_members = ("members", "undoc-members")
breathe_show_include = False
cpp_id_attributes = ["CULLHULL_EXPORT"]

# The reference needs the docstrings, not the compiled part nor other packages.
autodoc_mock_imports = ["cullhull._core", "dask"]
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "inherited-members": True}
autosummary_generate = False  # scripts/docs_source.py makes a page of each name
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True
copybutton_only_copy_prompt_lines = True

html_theme = "furo"
html_title = f"cullhull {release}"
html_static_path = [str(root / "docs" / "site")]
html_css_files = ["site.css"]
html_search_scorer = str(root / "docs" / "site" / "scorer.js")
html_favicon = str(root / "docs" / "site" / "favicon.svg")
html_logo = None
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {
        "color-brand-primary": "#1d56b8",
        "color-brand-content": "#1d56b8",
    },
    "dark_css_variables": {
        "color-brand-primary": "#8ab8ff",
        "color-brand-content": "#8ab8ff",
    },
    "light_logo": "logo-light.svg",
    "dark_logo": "logo-dark.svg",
    "sidebar_hide_name": True,
    "navigation_with_keys": True,
}
pygments_style = "friendly"
pygments_dark_style = "monokai"


def setup(app):
    """The compiled module is mocked: it has no source that the site could show."""

    def forget(app, env):
        getattr(env, "_viewcode_modules", {}).pop("cullhull._core", None)
        return []

    app.connect("env-updated", forget)
