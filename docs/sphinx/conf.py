"""Sphinx's settings for docs/site. Sources are staged by pages.py."""
import importlib
import importlib.machinery
import importlib.util
import os
import re
import sys
import types
from pathlib import Path

from sphinx.ext.autodoc.mock import mock

root = Path(__file__).resolve().parents[2]
project = "Hookeye"
author = "Hookeye developers"
copyright = "Hookeye developers, AGPL-3.0-or-later"
version = release = re.search(r"project\(hookeye VERSION (\S+)", (root / "CMakeLists.txt").read_text()).group(1)

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
source_suffix = {".md": "markdown"}
exclude_patterns = [".doctrees"]
suppress_warnings = ["myst.header"]

html_theme = "furo"
html_title = f"Hookeye {version}"
html_static_path = ["static"]
html_css_files = ["hookeye.css"]
html_extra_path = [str(root / "docs" / "extra")] if (root / "docs" / "extra").exists() else []
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
highlight_language = "none"

# Debian's MathJax, copied beside the pages by docs/site.
mathjax_path = "../mathjax/MathJax.js?config=TeX-AMS_CHTML"
myst_update_mathjax = False
mathjax2_config = {"showMathMenu": False, "messageStyle": "none", "tex2jax": {"inlineMath": [["\\(", "\\)"]]}}

# The module as it was built; else its Python files, over the stub of the extension beneath them.
built = Path(os.environ.get("HOOKEYE_PYTHON", root / "build" / "release" / "python"))
sys.path.insert(0, str(built))
try:
    importlib.import_module("hookeye")
except ImportError:
    sys.modules.pop("hookeye", None)
    sys.path[0] = str(root / "python")
    loader = importlib.machinery.SourceFileLoader("hookeye._hookeye", str(root / "python" / "hookeye" / "_hookeye.pyi"))
    stub = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    stub.__version__ = version
    sys.dont_write_bytecode = True
    with mock(["numpy"] if importlib.util.find_spec("numpy") is None else []):
        loader.exec_module(stub)
        for name, value in list(vars(stub).items()):
            if isinstance(value, types.FunctionType):
                setattr(stub, name, lambda *given, **named: {})  # what the package asks when it is imported
        sys.modules[loader.name] = stub
        importlib.import_module("hookeye")
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True}
python_use_unqualified_type_names = True


def as_text(app, what, name, thing, options, lines):
    """Docstrings are plain sentences with `names`, not reStructuredText."""
    lines[:] = [re.sub(r"`([^`]+)`", r"``\1``", line).replace("|", "\\|").replace("*", "\\*") for line in lines]


def setup(app):
    app.connect("autodoc-process-docstring", as_text)
