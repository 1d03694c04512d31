#!/usr/bin/env python3
"""Opens the built site as a reader without a network does, in Chromium: its scripts run, and its search finds.

usage: check_pages.py FOLDER. Exit code 77 where there is no Chromium.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FLAGS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=10000", "--enable-logging=stderr"]
FINDS = {"wheelchair": "starts/my-robot.html", "PeopleTracker": "tracking.html", "refine.min-score": "options.html"}


def opened(address):
    """The page as it is when its scripts have run, and what they complained of."""
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run([shutil.which("chromium"), *FLAGS, f"--user-data-dir={profile}", "--dump-dom", address], check=True,
                              capture_output=True, text=True, errors="replace", timeout=120)
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def wrong(folder):
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
    print("\n".join(lines) or "the site's scripts run and its search finds")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
