#!/usr/bin/env python3
"""Packages of a build: what is in them, that the same is packed twice, and that the program runs from wherever they are unpacked.
Compressed less than those of ./dev release, which takes long.

usage: package.py VESALIUS SOURCE_DIR BUILD_DIR
"""
import fnmatch
import gzip
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

FEW = ["--frames", "12", "--json", "-", "-q"]
NOTICES = "share/doc/vesalius/THIRD-PARTY-NOTICES.gz"
HOLDS = ["bin/vesalius", "share/vesalius/models/default.model", "share/vesalius/models/default.forest", "share/vesalius/bodies/paper25.toml",
         "share/vesalius/demo/meta.json", "share/bash-completion/completions/vesalius", "share/doc/vesalius/copyright", NOTICES]
# What every program holds: headers alone, headers of libraries, and what the pages bring.
COMPILED_IN = ["libboost1.*-dev", "libcli11-dev", "libeigen3-dev", "libfmt-dev", "libhwy-dev", "libtbb-dev", "libtomlplusplus-dev",
               "nlohmann-json3-dev"]
PATTERN = {"DEB": "vesalius_*.deb", "TGZ": "*.tar.gz"}
HELD_BY_DEBIAN = ["share/doc/vesalius/changelog.gz", "share/doc/vesalius/changelog.Debian.gz"]


def run(*command, **more):
    done = subprocess.run([str(each) for each in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def expect(condition, what):
    if not condition:
        sys.exit(what)


def pack(build, into, kinds, zone):
    """Returns the packages of these kinds of a build."""
    into.mkdir()
    run("cpack", "-G", ";".join(kinds), "-B", into, "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip", cwd=build,
        env={**os.environ, "TZ": zone})
    return [next(into.glob(PATTERN[kind])) for kind in kinds]


def check_entries(tar_file, epoch):
    """Everything belongs to root, can be read by all, is of one time, and stands in order."""
    with tarfile.open(tar_file) as tar:
        entries = tar.getmembers()
    for entry in entries:
        expect((entry.uid, entry.gid) == (0, 0), f"{entry.name} belongs to {entry.uid}:{entry.gid}")
        expect(entry.mtime == epoch, f"{entry.name} is of {entry.mtime}, expected {epoch}")
        allowed = (0o755,) if entry.isdir() else (0o644, 0o755)
        expect(entry.mode in allowed or entry.issym(), f"{entry.name} has mode {entry.mode:o}")
    names = [entry.name for entry in entries if not entry.isdir()]
    expect(not any(name.endswith("capsule.forest") for name in names), "the tests' own forest is packed")
    # By their paths, or folder by folder as tar sorts.
    expect(names in (sorted(names), sorted(names, key=lambda name: name.split("/"))), "files are in the order in which the disk has them")
    return names


def check_debian(deb, folder, epoch):
    fields = run("dpkg-deb", "--field", deb)
    for field in ("Package: vesalius\n", "Section: science\n", " libopencv-core", " libtbb12 ", " libc6 ", "Maintainer: "):
        expect(field in fields, f"{deb.name} lacks {field!r} in:\n{fields}")
    with open(folder / "data.tar", "wb") as data:
        subprocess.run(["dpkg-deb", "--fsys-tarfile", str(deb)], check=True, stdout=data)
    names = check_entries(folder / "data.tar", epoch)
    for library in ("k4abt/libk4abt.so.1.1", "nite2/libNiTE2.so"):
        expect(any(name.endswith(f"/vesalius/{library}") for name in names), f"{deb.name} lacks {library}")
    for name in HOLDS + HELD_BY_DEBIAN:
        expect(f"./usr/{name}" in names, f"{deb.name} lacks {name}")
    run("dpkg-deb", "--extract", deb, folder / "deb")
    return folder / "deb/usr"


def check_notices(prefix, source, build):
    """It has the notice of each package whose headers the build read, word by word, and of the pages; a header of no package is told."""
    sys.path.append(str(source / "cmake/package"))
    import third_party
    headers = third_party.inputs_of("ninja", build, ["src/cli/vesalius"])
    packages, _ = third_party.split_by_owner({path for path in headers if not path.is_relative_to(source)})
    lacking = [each for each in COMPILED_IN if not fnmatch.filter(packages, each)]
    expect(not lacking, f"no header of {lacking} was found among those of the build")
    said = gzip.decompress((prefix / NOTICES).read_bytes()).decode()
    for package in packages:
        text = Path(f"/usr/share/doc/{package}/copyright").read_text(encoding="utf-8").strip()
        expect(package in said and text in said, f"{NOTICES} lacks what {package} says")
    for page in ("three ", "uplot "):
        expect(f"\n{page}" in said, f"{NOTICES} lacks {page}")
    for own in ([source], []):
        _, missing = third_party.notices({source / "include/vesalius/detect.h", *list(headers)[:50]}, own)
        expect(any("vesalius/detect.h: of no package" in each for each in missing) != bool(own), f"missing: {missing}")


def check_archive(archive, folder, epoch):
    names = check_entries(archive, epoch)
    top = archive.name.removesuffix(".tar.gz")
    for name in HOLDS + ["lib/cmake/vesalius/vesaliusConfig.cmake"]:
        expect(any(each.startswith(f"{top}/") and each.endswith(name) for each in names) or f"{top}/{name}" in names,
               f"{archive.name} lacks {name}")
    run("tar", "--extract", "--gzip", f"--file={archive}", f"--directory={folder}")
    return folder / top


def check_program(prefix, folder, wanted):
    """It finds its model and its people wherever it lies, by a link too."""
    demo = prefix / "share/vesalius/demo"
    (folder / "link").symlink_to(prefix / "bin/vesalius")
    environment = {name: value for name, value in os.environ.items() if name != "VESALIUS_MODELS"}
    for program in (prefix / "bin/vesalius", folder / "link"):
        found = subprocess.run([str(program), "detect", str(demo), *FEW], check=True, capture_output=True, text=True, cwd="/",
                               env=environment).stdout
        expect(found == wanted, f"{program} finds other people than the build's program")
    (folder / "link").unlink()


def main():
    program, source, build = (Path(each).resolve() for each in sys.argv[1:4])
    for tool in ("dpkg-deb", "dpkg-shlibdeps", "file", "cpack"):
        if not shutil.which(tool):
            print(f"SKIPPED: no {tool}")
            sys.exit(77)
    options = (build / "package/options.cmake").read_text(encoding="utf-8")
    epoch = int(options.split("SOURCE_DATE_EPOCH} ")[1].split(")")[0])
    wanted = subprocess.run([str(program), "detect", str(source / "data/demo"), *FEW], check=True, capture_output=True, text=True).stdout
    expect(wanted.endswith('{"complete":true,"frames":12}\n'), f"expected twelve frames, got ... {wanted[-80:]!r}")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        deb, archive = pack(build, folder / "first", ["DEB", "TGZ"], "UTC")
        (again,) = pack(build, folder / "second", ["DEB"], "Pacific/Auckland")
        expect(deb.read_bytes() == again.read_bytes(), f"{deb.name} has other bytes the second time")
        check_program(check_debian(deb, folder, epoch), folder, wanted)
        unpacked = check_archive(archive, folder, epoch)
        check_program(unpacked, folder, wanted)
        check_notices(unpacked, source, build)
        print(f"{deb.name} {deb.stat().st_size} bytes, {archive.name} {archive.stat().st_size} bytes")


if __name__ == "__main__":
    main()
