#!/usr/bin/env python3
"""Writes what must go with programs that hold others' code: the copyright texts of all packages whose headers or static libraries
were compiled in, as they are installed here, and of what the pages hold. Which these are Ninja knows of the build, and the pages say.

usage: third_party.py FILE.gz NINJA BUILD_DIR TARGET...   exits with 1 where a header is of no package, or has no text; the file has
                                                          the rest
"""
import gzip
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

# Compiler and system: what of them is in a program asks for no notice (GCC's runtime library exception).
OF_THE_SYSTEM = re.compile(r"libc6-dev|linux-libc-dev|lib(gcc|stdc\+\+)-\d+-dev|libpython3.*-dev|lib32.*|libclang.*")
COMMON = re.compile(r"/usr/share/common-licenses/([\w.-]*\w)")


def said(*command, check=True):
    return subprocess.run([str(each) for each in command], check=check, capture_output=True, text=True).stdout


def inputs_of(ninja, build, targets):
    """Paths of all headers and libraries outside of the build that its targets were made of."""
    inputs = said(ninja, "-C", build, "-t", "inputs", *targets).split("\n")
    wanted, used, paths = set(inputs), False, {each for each in inputs if each.endswith(".a")}
    for line in said(ninja, "-C", build, "-t", "deps").split("\n"):
        if line.startswith("    "):
            paths |= {line.strip()} if used else set()
        elif line:
            used = line.split(":")[0] in wanted
    return {(build / path).resolve() for path in paths}


def split_by_owner(paths):
    """Returns the Debian packages of files, and the files that are of none."""
    found = said("dpkg-query", "--search", *sorted(paths), check=False) if paths else ""
    owned = dict(reversed(line.split(": ", 1)) for line in found.splitlines() if not line.startswith("diversion"))
    packages = {owner.split(",")[0].split(":")[0] for owner in owned.values()}
    return {each for each in packages if not OF_THE_SYSTEM.fullmatch(each)}, {path for path in paths if str(path) not in owned}


def python_package_of(path):
    """The licence files of the Python package that a header was installed with; None for others."""
    for folder in path.parents:
        if folder.parent.name == "site-packages":
            texts = sorted(folder.parent.glob(f"{folder.name.replace('-', '_')}-*.dist-info/licenses/**/*"))
            vendored = [folder.joinpath(*path.relative_to(folder).parts[:2], "LICENSE")]
            return folder.name, [each for each in texts + vendored if each.is_file()]
    return None


def notices(paths, own):
    """Returns {name: text} for files of others, and a list of what has none. `own`: folders whose files are the project's."""
    headers = Path(sysconfig.get_path("include")).resolve()  # the interpreter's own, of which modules hold nothing
    paths = {path for path in paths if not any(path.is_relative_to(folder) for folder in [*own, headers])}
    packaged, (texts, missing) = {}, ({}, [])
    by_python = {path: python_package_of(path) for path in paths}
    packages, unowned = split_by_owner({path for path in paths if not by_python[path]})
    for found in filter(None, by_python.values()):
        packaged.setdefault(found[0], set()).update(found[1])
    packaged.update({package: {Path("/usr/share/doc") / package / "copyright"} for package in packages})
    for name, files in sorted(packaged.items()):
        read = [file.read_text(encoding="utf-8") for file in sorted(files) if file.is_file()]
        if read:
            texts[name] = "\n".join(read)
        else:
            missing.append(f"{name}: no text of its licence")
    return texts, missing + [f"{path}: of no package" for path in sorted(unowned)]


def notices_of_pages(source):
    """Returns {name: text} of what the bundles of pages hold (web/notices.js)."""
    pages = [gzip.decompress(path.read_bytes()).decode() for path in sorted(source.glob("*/*/bundle/*.gz"))]
    return {name: text for page in pages for name, text in re.findall(r"/\*! notice of ([^\n]*)\n(.*?)\*/", page, re.S)}


def as_one_file(texts):
    """All texts, and those that they name by their place on Debian. Packages of one source have one text."""
    named = sorted({name for text in texts.values() for name in COMMON.findall(text)})
    common = {f"/usr/share/common-licenses/{name}": Path("/usr/share/common-licenses", name) for name in named}
    sharing = {}
    for name, text in texts.items():
        sharing.setdefault(text, []).append(name)
    whole = {**{", ".join(names): text for text, names in sharing.items()}, **{name: path.read_text(encoding="utf-8") for name, path in common.items() if path.is_file()}}
    return "This program holds code of others. Their notices, by package:\n" + "".join(
        f"\n{'=' * 100}\n{name}\n{'=' * 100}\n\n{text.strip()}\n" for name, text in whole.items())


def main():
    out, ninja, build = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]).resolve()
    source = Path(__file__).resolve().parents[2]
    targets = [Path(each).resolve().relative_to(build) for each in sys.argv[4:]]
    texts, missing = notices(inputs_of(ninja, build, targets), [source])
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_bytes(gzip.compress(as_one_file({**texts, **notices_of_pages(source)}).encode(), 9, mtime=0))
    print("\n".join(missing), file=sys.stderr)
    sys.exit(1 if missing else 0)


if __name__ == "__main__":
    main()
