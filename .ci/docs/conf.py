"""Settings of Sphinx: the pages are written by ``pages.py``, so that their source is the help, the docstrings and the tables."""

from kindyna import __version__

project, author, release = "KINDYNA", "KINDYNA developers", __version__
copyright = author
extensions = ["myst_parser", "sphinx.ext.viewcode"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}

myst_heading_anchors = 3
add_module_names = False
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = f"KINDYNA {release}"
html_static_path = ["static"]
html_css_files = ["kindyna.css"]
html_favicon = html_logo = "../../resources/icons/kindyna.svg"
html_copy_source = html_show_sourcelink = False
html_theme_options = {"navigation_with_keys": True}
pygments_dark_style = "github-dark"
