"""Puts the site's pages together: docs/, the other Markdown of the repository below project/, and what they link to."""

import posixpath
import re
import shutil
import subprocess
from pathlib import Path, PurePosixPath

# What stands where in the navigation; pages of docs/ that are named nowhere follow in "Guides".
SECTIONS = [
    ("Start in five minutes", ["starts/try-it", "starts/my-camera", "starts/my-robot", "starts/my-notebook", "starts/retrain",
                               "starts/contribute"]),
    ("What to expect", ["features", "limits", "comparison", "accuracy", "performance"]),
    ("Guides", ["program", "view", "cameras", "recordings", "tracking", "export", "ros2", "python", "library", "c", "k4abt", "nite2",
                "packages", "*"]),
    ("A forest of your own", ["synthetic", "retrain", "metrics", "cluster", "gpu"]),
    ("Reference", ["reference/commands", "options", "formats", "reference/python", "reference/cpp/index"]),
    ("Project", ["project/ARCHITECTURE", "project/CONTRIBUTING", "decisions/index", "experiments/index", "project/index",
                 "project/CHANGELOG"]),
]
FENCE = re.compile(r"^ *(```|~~~)")
# A link, a code span, or the name of a page in a sentence, whichever begins first.
TOKEN = re.compile(r"(?P<text>!?\[(?:[^\[\]]|\[[^\]]*\])*\])\((?P<target>[^)\s]+)\)"
                   r"|(?P<span>`+[^`]+`+)"
                   r"|(?<![\w/.-])(?P<word>(?:[\w.-]+/)*[\w-]+\.md)(?![\w/])")
COMMANDS = ("vesalius", "cmake", "cd", "time", "python3", "cp", "ssh", "pip", "git")


class BrokenLinks(Exception):
    pass


def is_external(target):
    return re.match(r"[a-z]+:", target) is not None


class Stage:
    def __init__(self, source, staged):
        self.source, self.staged = source, staged
        self.broken = []
        listed = subprocess.run(["git", "-C", str(source), "ls-files", "--cached", "--others", "--exclude-standard", "*.md"],
                                check=True, capture_output=True, text=True).stdout.split()
        self.pages = sorted(name for name in listed if (source / name).exists() and name != "README.md")

    def place(self, name):
        """Where a file of the repository lies in the site: docs/ is its root."""
        return name[len("docs/"):] if name.startswith("docs/") else f"project/{name}"

    def way(self, place, page):
        """From a page to a place in the site."""
        return posixpath.relpath(place, posixpath.dirname(self.place(page)) or ".")

    def resolve(self, target, page):
        """A file of the repository that a link of a page means; None if there is none."""
        path = (self.source / page).parent / target
        try:
            name = path.resolve().relative_to(self.source.resolve()).as_posix()
        except ValueError:
            return None
        return name if path.exists() else None

    def link(self, text, target, page):
        path, _, anchor = target.partition("#")
        if is_external(target) or not path:
            return f"{text}({target})"
        name = self.resolve(path, page)
        if name is None:
            self.broken.append(f"{page}: {target}: no such file")
            return text
        place = "index.md" if name == "README.md" else self.place(name)
        if (self.source / name).is_dir():
            place += "/index.md" if name.startswith("docs/") else "/README.md"
        elif not name.endswith(".md"):
            (self.staged / place).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(self.source / name, self.staged / place)
        return f"{text}({self.way(place, page)}{'#' + anchor if anchor else ''})"

    def mention(self, words, page):
        """A name of a page, seen from the root, from docs/ or from the page's own folder, becomes a link to it."""
        name = words.strip("`")
        for place in (name, f"docs/{name}", (PurePosixPath(page).parent / name).as_posix()):
            if place in self.pages and place != page:
                return f"[{words}]({self.way(self.place(place), page)})"
        return words

    def sentence(self, line, page):
        def replaced(match):
            if match["text"]:
                return self.link(match["text"], match["target"], page)
            return self.mention(match[0], page)

        return TOKEN.sub(replaced, line)

    def text(self, page):
        """A page's text with its links as they are in the site, and each block's language."""
        lines, block = [], None
        for line in (self.source / page).read_text().splitlines():
            if FENCE.match(line):
                block = [line] if block is None else block + [line]
                if len(block) > 1 and line.strip() in ("```", "~~~"):
                    lines += with_language(block)
                    block = None
            elif block is not None:
                block.append(line)
            else:
                lines.append(line if line.startswith(("    ", "#")) else self.sentence(line, page))
        return "\n".join(lines + (block or [])) + "\n"

    def write_pages(self):
        for page in self.pages:
            place = self.staged / self.place(page)
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(self.text(page))
        shutil.copytree(self.source / "docs/images", self.staged / "images", dirs_exist_ok=True)
        self.write_list("decisions", "Decisions", "Why things are as they are, in the order in which it was decided.")
        self.write_list("experiments", "Experiments", "What was tried, with its figures.")
        folders = [page for page in self.pages if page.endswith("/README.md")]
        self.write_toctree("project/index.md", "Folders", "What is in each folder of the repository.",
                           [self.place(page)[len("project/"):-3] for page in folders])
        self.write_navigation()
        if self.broken:
            raise BrokenLinks("\n".join(self.broken))

    def write_list(self, folder, title, about):
        names = sorted(path.stem for path in (self.staged / folder).glob("*.md"))
        self.write_toctree(f"{folder}/index.md", title, about, names)

    def write_toctree(self, place, title, about, names):
        text = f"# {title}\n\n{about}\n\n```{{toctree}}\n:maxdepth: 1\n\n" + "\n".join(names) + "\n```\n"
        (self.staged / place).parent.mkdir(parents=True, exist_ok=True)
        (self.staged / place).write_text(text)

    def exists(self, name):
        return any((self.staged / name).with_suffix(suffix).exists() for suffix in (".md", ".rst"))

    def write_navigation(self):
        """Appends the navigation to the first page: what there is of SECTIONS, and pages that it does not name."""
        named = {name for _, names in SECTIONS for name in names}
        others = sorted(path.stem for path in self.staged.glob("*.md") if path.stem not in named | {"index"})
        with open(self.staged / "index.md", "a", encoding="utf-8") as index:
            for caption, names in SECTIONS:
                there = [each for name in names for each in (others if name == "*" else [name] if self.exists(name) else [])]
                index.write(f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(there) + "\n```\n")


def with_language(block):
    """Blocks that name no language are commands if their first word is one, and if they have no apostrophes: words."""
    first = next((line.split()[0] for line in block[1:-1] if line.strip()), "")
    if block[0].strip() == "```" and "\n".join(block).count("'") % 2 == 0 and (first in COMMANDS or "/" in first or first.startswith("alone=")):
        return [block[0] + "bash", *block[1:]]
    return block
