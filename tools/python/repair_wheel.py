"""Makes a wheel that other machines can install: usage: repair_wheel.py WHEEL BUILD FOLDER

The libraries that its module needs go into it (auditwheel), with their licences as this system's packages state them, and so do
the notices of what was compiled in: BUILD is the folder where the module was built. The result lies in FOLDER; with SOURCE_DATE_EPOCH the same wheel gives the same bytes.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "cmake/package"))
import third_party  # noqa: E402


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def only(folder, pattern):
    found = list(folder.glob(pattern))
    if len(found) != 1:
        sys.exit(f"{folder}: {len(found)} of {pattern}, expected 1")
    return found[0]


def licence_of(library):
    """Path of what the package of a library, such as libfmt-4f700944.so.9.1.0, says of its licence."""
    name = re.sub(r"-[0-9a-f]{8}(?=\.so)", "", library)
    known = [line.split(" => ")[1] for line in run("/sbin/ldconfig", "-p").splitlines() if " => " in line]
    for path in map(Path, known):
        if path.resolve().name == name:
            # What is linked from /lib may be known to the package manager under either name.
            for one in (path.resolve(), path, Path("/usr") / path.relative_to("/")):
                owner = subprocess.run(["dpkg-query", "-S", str(one)], capture_output=True, text=True)
                if owner.returncode == 0:
                    package = owner.stdout.split(":")[0]
                    return package, Path("/usr/share/doc") / package / "copyright"
    sys.exit(f"{library}: no package of this system has {name}")


def main():
    wheel, build, folder = map(Path, sys.argv[1:])
    build = build.resolve()
    with tempfile.TemporaryDirectory() as place:
        place = Path(place)
        run("auditwheel", "repair", "--wheel-dir", place / "repaired", wheel)
        run(sys.executable, "-m", "wheel", "unpack", "--dest", place, only(place / "repaired", "*.whl"))
        content = only(place, "vesalius-*")
        licences = only(content, "*.dist-info") / "licenses" / "libraries"
        licences.mkdir(parents=True)
        for library in sorted((content / "vesalius.libs").iterdir()):
            package, licence = licence_of(library.name)
            shutil.copy(licence, licences / f"{package}.txt")
        module = only(build / "python", "_vesalius*.so").relative_to(build)
        texts, missing = third_party.notices(third_party.inputs_of("ninja", build, [module]), [build.parents[2]])
        if missing:
            sys.exit("\n".join(missing))
        (licences.parent / "THIRD-PARTY-NOTICES").write_text(third_party.as_one_file(texts), encoding="utf-8")
        run(sys.executable, "-m", "wheel", "pack", "--dest-dir", folder, content)


if __name__ == "__main__":
    main()
