#!/usr/bin/env python3
"""Checks a site that is opened as files: every link within it has its target, and nothing is loaded from elsewhere.

usage: check_links.py FOLDER. Prints a line for each broken link; exit code 1 if there are any.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loaded = {""}, [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[key] for key in ("id", "name") if values.get(key)}
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        elif tag in ("img", "script", "source", "video", "iframe") and values.get("src"):
            self.loaded.append(values["src"])
        elif tag == "link" and values.get("href") and values.get("rel") not in ("canonical",):
            self.loaded.append(values["href"])


def broken(folder):
    """A line for each link of the HTML files below a folder that leads nowhere."""
    folder = folder.resolve()
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    if not pages:
        yield f"{folder}: no pages"
    for path, page in pages.items():
        name = path.relative_to(folder)
        for target in page.links + page.loaded:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                if target in page.loaded and parts.scheme != "data":
                    yield f"{name}: loads {target}, which a page without a network lacks"
                continue
            file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not file.is_file():
                yield f"{name}: {target}: no such file"
            elif file in pages and unquote(parts.fragment) not in pages[file].anchors:
                yield f"{name}: {target}: no such place in that page"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.split("\n\n")[1])
    lines = list(broken(Path(sys.argv[1])))
    print("\n".join(lines) or "every link has its target")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
