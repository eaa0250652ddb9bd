"""Sphinx's configuration. `build.py` calls Sphinx; alone this file has no pages."""

from __future__ import annotations

import os
import sys
import warnings
from pathlib import Path

import matplotlib
import pyvista
from sphinx_gallery.sorting import FileNameSortKey

SITE = Path(__file__).resolve().parent
sys.path[:0] = [str(SITE.parent), str(SITE / "extensions")]

import scraping  # noqa: E402

import tyrefem  # noqa: E402

matplotlib.use("Agg")
pyvista.OFF_SCREEN = True
pyvista.BUILDING_GALLERY = True
os.environ["PYVISTA_BUILDING_GALLERY"] = "true"
pyvista.set_plot_theme("document")
# A warning of an example is an error, as in the tests.
warnings.filterwarnings("error", module="tyrefem")

project = "tyrefem"
author = "The tyrefem authors"
project_copyright = "The tyrefem authors, BSD-3-Clause"
version = release = tyrefem.__version__

# sphinx-gallery takes its scrapers as objects.
suppress_warnings = ["config.cache"]

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_design",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    *scraping.EXTENSIONS,
    "mathml",
    "docstrings",
    "overview",
]
templates_path = ["templates"]
exclude_patterns = ["**/GALLERY_HEADER.rst"]

# Pages of docs/ are written for a code host: GitHub's names of headings, and tables, pictures and links of Markdown.
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "attrs_inline"]
myst_url_schemes = ["http", "https", "mailto"]

# A name in backticks is a link where the site documents it: extensions/docstrings.py.
default_role = "py:obj"
# "--set" stays as it is typed.
smartquotes = False
autosummary_generate = True
autosummary_ignore_module_all = False
autodoc_default_options = {"members": True, "show-inheritance": False}
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_class_signature = "mixed"

sphinx_gallery_conf = {
    "examples_dirs": [str(SITE / "gallery"), str(SITE / "verification")],
    "gallery_dirs": ["gallery", "verification"],
    "filename_pattern": r"\.py$",
    "within_subsection_order": FileNameSortKey,
    "image_scrapers": scraping.scrapers(),
    "reset_modules": ("matplotlib", scraping.note_example),
    "reset_modules_order": "before",
    "abort_on_example_error": False,
    "capture_repr": ("_repr_html_", "__repr__"),
    "ignore_repr_types": r"matplotlib|list|tuple",
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "write_computation_times": False,
    "show_signature": False,
    "backreferences_dir": None,
    "plot_gallery": "True",
    "min_reported_time": 1e9,
    "copyfile_regex": r".*\.(csv|toml)$",
    "matplotlib_animations": False,
    "nested_sections": True,
}

html_theme = "pydata_sphinx_theme"
html_title = "tyrefem"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_last_updated_fmt = None
html_theme_options = {
    "logo": {"text": "tyrefem"},
    "header_links_before_dropdown": 7,
    "navigation_with_keys": False,
    "show_prev_next": True,
    "show_toc_level": 2,
    "navbar_align": "left",
    "footer_start": ["copyright"],
    "footer_end": ["theme-version"],
    "back_to_top_button": True,
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}

# A server that does not answer for a while says nothing of the page.
linkcheck_timeout = 20
linkcheck_retries = 2
linkcheck_anchors = False
