"""The pages of the site as Sphinx reads them: pages.py PROGRAM FOLDER

docs/*.md as they are; README.md and CHANGELOG.md with their links bent; index.md with its lists of pages as tables of contents;
the commands by the program's man pages; the Python module by autodoc; the C++ layers by their READMEs.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"


def bent(text):
    """Links as they are from a page beside all others; the root's and this folder's pages lie elsewhere in the sources."""
    text = re.sub(r"\]\((\.\./)*(README|CHANGELOG)\.md", lambda m: "](" + {"README": "overview", "CHANGELOG": "changes"}[m[2]] + ".md", text)
    return re.sub(r"\]\((\.\./|docs/)", "](", text)


def with_titles(text, titles):
    """A link that shows a page's file shows its title: [plan.md](plan.md)."""
    return re.sub(r"\[(?:docs/)?([a-z-]+)\.md\]\(\1\.md", lambda m: f"[{titles.get(m[1], m[1])}]({m[1]}.md", text)


def outline(text, pages):
    """`- NAME` below a heading becomes its table of contents. `?`: if there is such a page; `*`: those that are named nowhere."""
    named = set(re.findall(r"^- ([a-z-]+)(?: \?)?$", text, re.M))
    out = []
    for block in re.split(r"(?m)^(?=## )", text):
        lines = block.splitlines()
        entries = [line[2:] for line in lines if re.fullmatch(r"- ([a-z-]+( \?)?|\*)", line)]
        if not entries:
            out.append(block)
            continue
        listed = []
        for entry in entries:
            if entry == "*":
                listed += sorted(pages - named - {"index"})
            elif not entry.endswith("?") or entry.removesuffix(" ?") in pages:
                listed.append(entry.removesuffix(" ?"))
        title = lines[0].removeprefix("## ")
        out.append(f"```{{toctree}}\n:caption: {title}\n:hidden:\n\n" + "\n".join(listed) + "\n```\n\n")
    return "".join(out)


# --- the commands ---

def plain(roff):
    """A line of a man page as Markdown; bold words are code."""
    text = re.sub(r"\\f[BI](.*?)\\fR", r"`\1`", roff)
    text = text.replace("\\-", "-").replace("\\e", "\\").replace("\\&", "").replace('\\(aq', "'")
    return text


def cell(text):
    return re.sub(r"(`[^`]*`)|[<>*_]", lambda m: m[0] if m[1] else "\\" + m[0], text).replace("|", "\\|")


def sections(man):
    """{heading: lines} of a man page."""
    out, at = {}, None
    for line in man.splitlines():
        if line.startswith(".SH "):
            at = out.setdefault(line[4:].strip('"'), [])
        elif at is not None:
            at.append(line)
    return out


def entries(lines):
    """(term, meaning) of each .TP."""
    text = "\n".join(lines)
    for one in text.split(".TP\n")[1:]:
        term, _, meaning = one.partition("\n")
        yield plain(term), " ".join(plain(line) for line in meaning.splitlines() if not line.startswith("."))


def command_page(man, name):
    parts = sections(man)
    title = plain(parts["NAME"][0]).partition(" - ")[2]
    out = [f"## hookeye {name}\n", f"{cell(title)}.\n"]
    synopsis = " ".join(re.sub(r"^\.B ", "", plain(line)) for line in parts["SYNOPSIS"]).replace("`", "")
    out.append(f"```text\n{synopsis}\n```\n")
    for heading in ("ARGUMENTS", "OPTIONS"):
        rows = [f"| {cell(term)} | {cell(meaning)} |" for term, meaning in entries(parts.get(heading, []))
                if term not in ("`-h`, `--help`", "`--json`", "`-v`, `--verbose`") and not term.startswith(("`--threads`", "`--memory`"))]
        if rows:
            out.append("\n".join([f"| {heading.lower().rstrip('s')} | meaning |", "|---|---|", *rows]) + "\n")
    return "\n".join(out)


def commands_page(program):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "manual", "-o", folder], check=True, capture_output=True)
        mans = {file.stem: file.read_text() for file in sorted(Path(folder, "man1").glob("*.1"))}
    del mans["hookeye"]
    names = [name.removeprefix("hookeye-") for name in mans]
    head = ["# Commands\n", "This page is made from the program's own definitions, as its man pages and `--help` are.\n",
            "Every command takes `--json` (one JSON document on standard output), `--threads N` (cores to use; all unless said), "
            "`--memory 4G` (at most), `-v` (more about what is going on) and `-h`.\n",
            "| exit status | meaning |\n|---|---|\n| 0 | done |\n| 1 | internal error |\n| 2 | bad input |\n"
            "| 3 | the numbers failed |\n| 130 | stopped by Ctrl-C; all that is finished is kept |\n"]
    return "\n".join(head + [command_page(mans[f"hookeye-{name}"], name) for name in names])


# --- the Python module ---

def python_page():
    text = (ROOT / "python" / "hookeye" / "__init__.py").read_text()
    names = re.findall(r'"(\w+)"', text.partition("__all__ = [")[2].partition("]")[0])
    classes = [name for name in names if name[0].isupper()]
    functions = [name for name in names if name[0].islower() and name != "importers"]
    out = ["# Python reference", "", "Names of the module `hookeye`, by its sources. What they are for: [Python](python.md).", "",
           "```{eval-rst}", ".. py:module:: hookeye", "   :noindex:", "```", "", "## Functions", "", "```{eval-rst}"]
    for name in functions:
        out.append(f".. autofunction:: hookeye.{name}")
    out += ["```", "", "## Classes", ""]
    for name in classes:
        directive = "autoexception" if name in ("Cancelled", "InputError", "NumericalError", "SensorError") else "autoclass"
        out += [f"### {name}", "", "```{eval-rst}", f".. {directive}:: hookeye.{name}", "```", ""]
    out += ["## Importers", "", "```{eval-rst}", ".. automodule:: hookeye.importers", "```", ""]
    return "\n".join(out)


def cpp_page():
    """The layers from below, by their READMEs; docs/site has Doxygen's pages in cpp/."""
    layers = re.search(r"^INPUT += (.*)$", (ROOT / "docs" / "sphinx" / "Doxyfile").read_text(), re.M)[1].split()
    out = ["# C++ reference", "", "```{raw} html", '<p><a href="cpp/annotated.html">All types</a>, '
           '<a href="cpp/files.html">all headers</a>: shapes, units, frames and errors of what each declares.</p>', "```", "",
           "Layers, from below. None includes one that stands below it.", ""]
    for layer in layers:
        purpose = (ROOT / layer / "README.md").read_text().split("\n\n")[1].replace("\n", " ")
        out.append(f"- **{layer}**: {purpose}")
    return "\n".join(out) + "\n"


def main(program, folder):
    folder = Path(folder)
    for page in DOCS.glob("*.md"):
        (folder / page.name).write_text(bent(page.read_text()))
    for name in ("images", "schema"):
        shutil.copytree(DOCS / name, folder / name)
    (folder / "overview.md").write_text(bent((ROOT / "README.md").read_text()).replace("# Hookeye\n", "# Overview\n", 1))
    (folder / "changes.md").write_text(bent((ROOT / "CHANGELOG.md").read_text()))
    (folder / "commands.md").write_text(commands_page(program))
    (folder / "cpp-reference.md").write_text(cpp_page())
    (folder / "python-reference.md").write_text(python_page())
    titles = {page.stem: re.sub(r":? *`[^`]*`", "", page.read_text().partition("\n")[0].removeprefix("# ")) for page in folder.glob("*.md")}
    for page in folder.glob("*.md"):
        page.write_text(with_titles(page.read_text(), titles))
    index = bent((DOCS / "sphinx" / "index.md").read_text())
    pages = {page.stem for page in folder.glob("*.md")}
    (folder / "index.md").write_text(outline(index, pages))


if __name__ == "__main__":
    main(*sys.argv[1:])
