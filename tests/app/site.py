"""Makes the documents a site, which must be whole by itself: no page asks the network for a script, a style or a font.

python3 site.py DOCS OUT
"""
import pathlib
import re
import subprocess
import sys

docs, out = sys.argv[1:]
try:
    import furo, myst_parser, sphinx  # noqa: F401, E401
except ImportError:
    sys.exit(77)
if not pathlib.Path("/usr/share/javascript/mathjax/MathJax.js").exists():
    sys.exit(77)

subprocess.run([sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-E", "-b", "html", docs, out], check=True)

TAG = re.compile(r"<(?:script|link|img|iframe|audio|video|source)\b[^>]*>")
SOURCE = re.compile(r"""\b(?:src|href)\s*=\s*["']([^"']*)""")
pages = sorted(pathlib.Path(out).rglob("*.html"))
assert len(pages) > 30, pages
problems = []
for page in pages:
    for tag in TAG.findall(page.read_text()):
        for source in SOURCE.findall(tag):
            if re.match(r"(https?:)?//", source):
                problems.append(f"{page}: {source} is fetched from the network")
            elif not source.startswith(("data:", "#")) and not (page.parent / re.split("[?#]", source)[0]).exists():
                problems.append(f"{page}: {source} is missing")
for style in pathlib.Path(out).rglob("*.css"):
    if re.search(r"""(url\(|@import)\s*["']?(https?:)?//""", style.read_text()):
        problems.append(f"{style} fetches from the network")

theory = "".join(page.read_text() for page in (pathlib.Path(out) / "theory").glob("*.html"))
assert theory.count('class="math') > 100, "the theory has lost its formulas"
assert "mathjax/MathJax.js" in theory
home = (pathlib.Path(out) / "index.html").read_text()
assert "Copyright" not in home
listed = re.findall(r'toctree-l1"><a[^>]*href="([^"]*)"', home)
assert len(listed) == len(set(listed)) and not any("#" in link for link in listed), listed
assert listed[0] == "tutorial.html", "the pages stand in the order of the home page"
sys.exit("\n".join(problems) or 0)
