"""How the documentation is built: ``scripts/docs``, or ``sphinx-build -W -n docs docs/_build/html``; nothing is fetched."""

from __future__ import annotations

import sys
from importlib.metadata import distribution
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path[:0] = [str(ROOT), str(HERE / "extensions"), str(ROOT / "scripts")]

from inventories import local_inventory  # noqa: E402  they stand in the folder that the line above names

from tactsim import __version__  # noqa: E402

project = "tactsim"
author = "the tactsim developers"
copyright = author
version = release = __version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx.ext.intersphinx",
    "myst_parser",
    "sphinx_design",
    "sphinx_copybutton",
    "docstrings",
    "doi_links",
    "generated_pages",
]
exclude_patterns = ["_build", "extensions", "inventories", "gallery/*"]
default_role = "code"
nitpicky = True
nitpick_ignore_regex = [
    # Outside libraries whose pages the inventories do not list, and aliases of types that exist while a module is checked only.
    ("py:.*", r"(pydantic|scipy|skfem|pint|pyvista|matplotlib|numba|zarr|xarray|aiohttp|ruamel|pymoo|argparse|yaml)\b.*"),
    ("py:.*", r"(numpy|np)\..*"),
    ("py:(class|obj)", r"(collections|concurrent|contextlib|dataclasses|enum|functools|pathlib|types|typing)\..*"),
    ("py:(class|obj)", r"(pydantic_core|warnings|multiprocessing|math)\..*"),
    ("py:(class|obj|exc)", r"(?:[A-Z]\w*|_\w+|'\w+'|[\d.e+-]+|Annotated\[.*|[\w\[]*\[str)$"),
    # Variables of types, and what is private.
    ("py:(class|obj)", r"tactsim\..*\.(State|Now|Iterate|Function|Made|Kept|Model|Key|AnyScene|Number|_\w+|<locals>.*)$"),
]
suppress_warnings = ["ref.python"]  # a word of a docstring that several classes have as an attribute

myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 4

intersphinx_mapping = {
    name: (url, local_inventory(HERE / "inventories" / f"{name}.txt", HERE / "_build" / "inventories"))
    for name, url in {
        "python": "https://docs.python.org/3",
        "numpy": "https://numpy.org/doc/stable",
        "xarray": "https://docs.xarray.dev/en/stable",
    }.items()
}

autodoc_default_options = {"members": True, "show-inheritance": True, "member-order": "bysource"}
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_type_aliases = {"ArrayLike": "numpy.typing.ArrayLike"}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_param = False
napoleon_preprocess_types = False
python_maximum_signature_line_length = 100
python_display_short_literal_types = True
maximum_signature_line_length = 100

if any((HERE / "gallery").glob("plot_*.py")):
    extensions.append("sphinx_gallery.gen_gallery")
    sphinx_gallery_conf = {
        "examples_dirs": "gallery",
        "gallery_dirs": "auto_gallery",
        "filename_pattern": r"/plot_",
        "ignore_pattern": r"/stored/",
        "within_subsection_order": "gallery_pages.InOrder",
        "image_scrapers": ("matplotlib", "gallery_pages.last_figure"),
        "ignore_repr_types": r"matplotlib\.|tactsim\.plotting\.canvas\.",
        "remove_config_comments": True,
        "show_memory": False,
        "write_computation_times": False,
        "download_all_examples": True,
    }

html_theme = "pydata_sphinx_theme"
html_title = f"tactsim {version}"
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "navbar_end": ["theme-switcher"],
}
mathjax_path = "tex-svg.js"
mathjax_file = Path(distribution("sphinx-mathjax-offline").locate_file("sphinx-mathjax-offline/static/mathjax/tex-svg.js"))
html_static_path = ["_static", str(mathjax_file)]
html_css_files = ["wide.css"]
