#!/usr/bin/python3
"""Do the gallery and CITATION.cff hold? pages_test.py PROGRAM ROOT

Every effect of the catalogue has its place and its picture in docs/gallery.md, and no other has one. CITATION.cff has the form of
CFF 1.2.0, and the version of the sources.
"""
import json
import re
import subprocess
import sys
from pathlib import Path

try:
    import yaml
except ImportError:
    print("NOT RUN: python3-yaml is missing (apt-get install python3-yaml)")
    sys.exit(0)

MOST = 1_500_000  # bytes of all pictures of the gallery

# Keys of https://github.com/citation-file-format/citation-file-format, 1.2.0.
CFF_NEEDED = {"authors", "cff-version", "message", "title"}
CFF_KEYS = CFF_NEEDED | {
    "abstract", "commit", "contact", "date-released", "doi", "identifiers", "keywords", "license", "license-url",
    "preferred-citation", "references", "repository", "repository-artifact", "repository-code", "type", "url", "version"}


def gallery_faults(program, root):
    catalogue = json.loads(subprocess.run([program, "effects", "--json"], check=True, capture_output=True, text=True).stdout)
    effects = {effect["name"] for effect in catalogue["effects"]}
    text = (root / "docs/gallery.md").read_text()
    shown = set(re.findall(r"\(images/gallery/(\w+)\.png\)", text)) - {"none"}
    for name in sorted(effects - shown):
        yield f"docs/gallery.md does not show `{name}` (docs/gallery/make)"
    for name in sorted(shown - effects):
        yield f"docs/gallery.md shows `{name}`, which the catalogue does not have"
    size = 0
    for name in sorted(shown):
        picture = root / "docs/images/gallery" / f"{name}.png"
        if not picture.exists():
            yield f"{picture} is not there"
        else:
            size += picture.stat().st_size
    if size > MOST:
        yield f"the pictures of the gallery have {size} bytes, more than {MOST}"


def citation_faults(root):
    cite = yaml.safe_load((root / "CITATION.cff").read_text())
    for key in sorted(CFF_NEEDED - set(cite)):
        yield f"CITATION.cff lacks `{key}`"
    for key in sorted(set(cite) - CFF_KEYS):
        yield f"CITATION.cff: CFF 1.2.0 has no key `{key}`"
    if cite.get("cff-version") != "1.2.0":
        yield "CITATION.cff: `cff-version` is not the text 1.2.0"
    if cite.get("type", "software") not in ("software", "dataset"):
        yield "CITATION.cff: `type` is software or dataset"
    for author in cite.get("authors") or [{}]:
        if not isinstance(author, dict) or not ({"name"} <= set(author) or {"family-names"} <= set(author)):
            yield "CITATION.cff: an author has neither `name` nor `family-names`"
    version = re.search(r"project\(hookeye VERSION (\S+)", (root / "CMakeLists.txt").read_text()).group(1)
    if str(cite.get("version")) != version:
        yield f"CITATION.cff is of version {cite.get('version')}, the sources are of {version}"


def main(program, root):
    root = Path(root)
    faults = [*gallery_faults(program, root), *citation_faults(root)]
    print("\n".join(faults + [f"{len(faults)} faults"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
