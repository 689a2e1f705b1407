"""The documents as a site, made by `./run docs`: takes Debian's python3-sphinx, python3-myst-parser, furo
and libjs-mathjax, of which it gets a copy: the site needs no network.

The pages stay plain Markdown, which hosts of repositories show as it is; what Sphinx wants besides
is added here while it reads.
"""
import pathlib
import re
import shutil

HERE = pathlib.Path(__file__).resolve().parent
MATHJAX = pathlib.Path("/usr/share/javascript/mathjax")
# What draws TeX as SVG, whose glyphs are in scripts: browsers load no fonts from files that they opened.
MATHJAX_PARTS = ["MathJax.js", "config/TeX-AMS_SVG.js", "extensions", "jax/element", "jax/input/TeX", "jax/output/SVG/autoload",
                 "jax/output/SVG/jax.js", "jax/output/SVG/config.js", "jax/output/SVG/fonts/TeX"]
LINK = re.compile(r"\[([^\]]*)\]\(([^)#:]+)\)")

project = "stridor"
extensions = ["myst_parser", "sphinx.ext.mathjax"]
root_doc = "index"
exclude_patterns = ["_build", "figures"]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
myst_dmath_double_inline = True
suppress_warnings = ["myst.header"]  # tables of contents begin where pages do
html_theme = "furo"
html_title = "stridor"
html_copy_source = False
html_show_copyright = False
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_SVG"
mathjax2_config = {"tex2jax": {"ignoreClass": "tex2jax_ignore", "processClass": "math"}, "showMathMenu": False}
myst_update_mathjax = False  # that is for another version
highlight_language = "none"

TREE = """

```{{toctree}}
:hidden:
:titlesonly:
:glob:
{}
```
"""
CHAPTERS = TREE.format("theory/*")
PAGE = re.compile(r"\]\((\w+)\.md\)")


def without_links_out(text, folder):
    """Links to folders and pages of the source tree that are no part of the site become their text.

    Those that lead nowhere stay, so that Sphinx finds them.
    """
    def replaced(match):
        target = (folder / match[2]).resolve()
        is_outside = not target.is_relative_to(HERE) and target.exists()
        return match[1] if is_outside and (target.is_dir() or target.suffix == ".md") else match[0]

    return LINK.sub(replaced, text)


def complete(_app, name, source):
    """Formulas in fences as directives; the trees of pages, which plain Markdown does not have."""
    source[0] = without_links_out(source[0], (HERE / name).parent)
    source[0] = source[0].replace("```math\n", "```{math}\n")
    if name == "index":
        # Pages in the order in which the home page names them, then the others.
        source[0] += TREE.format("\n".join([*dict.fromkeys(PAGE.findall(source[0])), "*"]))
    if name == "theory":
        source[0] += CHAPTERS


def copy_mathjax(app, _error):
    """The formulas' scripts, into the site, unless it is told to take them from elsewhere."""
    if app.builder.format != "html" or not app.config.mathjax_path.startswith("mathjax/"):
        return
    if not (MATHJAX / "MathJax.js").exists():
        raise SystemExit(f"{MATHJAX} is missing: install libjs-mathjax")
    for part in MATHJAX_PARTS:
        target = pathlib.Path(app.outdir) / "_static" / "mathjax" / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if (MATHJAX / part).is_dir():
            shutil.copytree(MATHJAX / part, target, dirs_exist_ok=True)
        else:
            shutil.copy(MATHJAX / part, target)


def setup(app):
    app.connect("build-finished", copy_mathjax)
    app.connect("source-read", complete)
