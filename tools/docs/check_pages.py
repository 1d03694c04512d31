#!/usr/bin/env python3
"""Opens the built site as a reader without a network does, in Chromium: its scripts run, its search finds, and words have enough
contrast on every page, in light and dark.

usage: check_pages.py FOLDER. Exit code 77 where there is no Chromium.
"""

import functools
import http.server
import json
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

FLAGS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=10000", "--enable-logging=stderr"]
FINDS = {"wheelchair": "starts/my-robot.html", "PeopleTracker": "tracking.html", "refine.min-score": "options.html"}


SCHEMES = {"dark": "0", "light": "1"}


def opened(address, *flags):
    """The page as it is when its scripts have run, and what they complained of."""
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run([shutil.which("chromium"), *FLAGS, *flags, f"--user-data-dir={profile}", "--dump-dom", address],
                              check=True, capture_output=True, text=True, errors="replace", timeout=300)
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


class Site(http.server.SimpleHTTPRequestHandler):
    """The site on loopback, since a page opened as a file may not look into another; and a page that looks into them."""

    contrast_page = b""

    def do_GET(self):
        if self.path != "/-contrast":
            super().do_GET()
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(self.contrast_page)

    def log_message(self, *_):
        pass


def hard_to_read(folder):
    """A line for each kind of words of a page with less contrast than WCAG 2.1 wants."""
    pages = sorted(f"/{page.relative_to(folder)}" for page in folder.rglob("*.html"))
    script = (Path(__file__).parent / "contrast.js").read_text()
    Site.contrast_page = f"<!doctype html><body><script>{script}\ncheckAll({json.dumps(pages)})</script>".encode()
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Site, directory=str(folder))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        for scheme, number in SCHEMES.items():
            page, _ = opened(f"http://127.0.0.1:{server.server_port}/-contrast", f"--blink-settings=preferredColorScheme={number}",
                             "--virtual-time-budget=600000")
            lines = re.search(r"<body>(.*)</body>", page, re.DOTALL).group(1).strip().splitlines()
            if lines[:1] != [f"checked {len(pages)} {scheme}"]:
                yield f"not every page was looked at in {scheme}: {lines[:1]}"
            yield from lines[1:]
        server.shutdown()


def wrong(folder):
    yield from hard_to_read(folder)
    for name in ("index.html", "starts/try-it.html", "reference/python.html"):
        page, complaints = opened((folder / name).as_uri())
        if complaints or 'class="no-js"' in page:
            yield f"{name}: its scripts do not run: {complaints}"
    for words, target in FINDS.items():
        page, complaints = opened(f"{(folder / 'search.html').as_uri()}?q={words}")
        found = re.findall(r'<a href="([^"?#]+)', page[page.find('id="search-results"'):])
        if complaints or target not in found:
            yield f"searching for {words} does not find {target}: {found} {complaints}"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.split("\n\n")[1])
    if not shutil.which("chromium"):
        print("SKIPPED: no Chromium", file=sys.stderr)
        return 77
    lines = list(wrong(Path(sys.argv[1]).resolve()))
    print("\n".join(lines) or "the site's scripts run, its search finds, and it can be read in light and dark")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
