"""Does every link within a built site hold? links.py FOLDER

Targets of href and src, and their #anchors. Exits 1 with page and link. What is loaded from the web is a fault too: the site
works offline. Links to the web are not asked.
"""
import html.parser
import sys
import urllib.parse
from pathlib import Path


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        told = dict(attributes)
        self.anchors.update(told[key] for key in ("id", "name") if told.get(key))
        for key in ("href", "src"):
            if told.get(key):
                loaded = key == "src" or (tag == "link" and told.get("rel") in ("stylesheet", "icon"))
                self.links.append((told[key], loaded))


def faults(folder):
    pages = {file: Page(file.read_text(errors="replace")) for file in sorted(folder.rglob("*.html"))}
    for file, page in pages.items():
        for link, loaded in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                if loaded and parts.scheme not in ("data", "javascript"):
                    yield f"{file.relative_to(folder)}: `{link}` is loaded from the web"
                continue
            path = urllib.parse.unquote(parts.path)
            target = (file.parent / path).resolve() if path else file
            if target.is_dir():
                target /= "index.html"
            if not target.exists():
                yield f"{file.relative_to(folder)}: `{link}` is not there"
            elif parts.fragment and target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].anchors:
                yield f"{file.relative_to(folder)}: `{link}`: the page has no such anchor"


def main(folder):
    folder = Path(folder).resolve()
    wrong = list(faults(folder))
    print("\n".join(wrong + [f"{len(list(folder.rglob('*.html')))} pages, {len(wrong)} links wrong"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
