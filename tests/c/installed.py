#!/usr/bin/env python3
"""Installs to a temporary prefix and uses libvesalius.so from there, by pkg-config and by CMake, with the compilers that
there are. Exit code 77 without pkg-config.

Usage: installed.py SOURCE_DIR BUILD_DIR REFERENCE
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from expected import expect_example, expect_same, expected_frames, run

C99 = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
# The header in C++ of any age that has <cstdint>, included twice, and beside the C++ headers of vesalius.
CPLUSPLUS = """#include <vesalius/vesalius.h>
#include <vesalius/vesalius.h>
int main() {
  vesalius_options* options = nullptr;
  const bool made = vesalius_options_create(&options) == VESALIUS_OK && vesalius_options_count(options) > 50;
  vesalius_options_destroy(options);
  return made && vesalius_abi_version() == VESALIUS_ABI_VERSION ? 0 : 1;
}
"""
# Nothing that the library was built of is needed to link to it.
PACKAGES = ["Eigen3", "TBB", "tomlplusplus", "hwy", "fmt", "OpenCV", "nlohmann_json"]
PROJECT = """cmake_minimum_required(VERSION 3.22)
project(user LANGUAGES C)
find_package(vesalius 0.1 REQUIRED COMPONENTS c)
add_executable(user {example})
target_link_libraries(user PRIVATE vesalius::c m)
"""


def compilers(*names):
    return [name for name in names if shutil.which(name)]


def check_pkg_config(source, prefix, folder, frames):
    (description,) = prefix.rglob("pkgconfig/vesalius.pc")
    environment = {**os.environ, "PKG_CONFIG_PATH": str(description.parent)}
    flags = run("pkg-config", "--cflags", "--libs", "vesalius", env=environment).split()
    expect_same(run("pkg-config", "--modversion", "vesalius", env=environment).count("."), 2, "pkg-config")
    library = {**os.environ, "LD_LIBRARY_PATH": str(description.parent.parent), "VESALIUS_MODELS": ""}
    for compiler in compilers("cc", "gcc", "clang", "clang-14"):
        program = folder / compiler
        run(compiler, *C99, source / "examples/detect_people.c", *flags, "-lm", "-o", program)
        expect_example([program], "-", frames, env=library)  # with the model that is installed
    # The program that the document begins with, in which nobody is in view.
    (folder / "heads.c").write_text((source / "docs/c.md").read_text().split("```c\n")[1].split("```")[0])
    run("cc", *C99, folder / "heads.c", *flags, "-o", folder / "heads")
    expect_same(run(folder / "heads", env=library), "", "docs/c.md")
    (folder / "user.cpp").write_text(CPLUSPLUS)
    for compiler in compilers("c++", "g++", "clang++", "clang++-14"):
        for standard in "c++11", "c++20":
            run(compiler, f"-std={standard}", *C99[1:], folder / "user.cpp", *flags, "-o", folder / "cplusplus")
            run(folder / "cplusplus", env=library)


def check_models(prefix, folder, frames):
    """The library alone, as plugins of games are copied."""
    program, lone = folder / "cc", folder / "lone"
    lone.mkdir()
    (library,) = prefix.rglob("libvesalius.so.0")
    shutil.copy(library, lone)
    environment = {**os.environ, "LD_LIBRARY_PATH": str(lone), "VESALIUS_MODELS": ""}
    arguments, expected = frames[0]
    done = subprocess.run([program, "-", *arguments], env=environment, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 1 or f"no default.model in {lone}/models, " not in done.stderr:
        sys.exit(f"expected to hear where models are looked for, got {done.returncode}: {done.stderr}")
    models = prefix / "share/vesalius/models"
    expect_same(run(program, "-", *arguments, env={**environment, "VESALIUS_MODELS": str(models)}), expected, "a chosen folder")
    (lone / "models").symlink_to(models)
    expect_same(run(program, "-", *arguments, env=environment), expected, "models beside the library")


def check_cmake(source, prefix, folder, frames):
    project = folder / "project"
    project.mkdir()
    (project / "CMakeLists.txt").write_text(PROJECT.format(example=source / "examples/detect_people.c"))
    run("cmake", "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={prefix}",
        *[f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON" for package in PACKAGES])
    run("cmake", "--build", project / "build")
    expect_example([project / "build/user"], "-", frames)


def main():
    source, build, reference = (Path(a).resolve() for a in sys.argv[1:4])
    if not shutil.which("pkg-config"):
        print("SKIPPED: no pkg-config")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        prefix = folder / "prefix"
        run("cmake", "--install", build, "--prefix", prefix)
        frames = expected_frames(reference, source / "data/rooms", folder)[:1]
        check_pkg_config(source, prefix, folder, frames)
        check_models(prefix, folder, frames)
        check_cmake(source, prefix, folder, frames)


if __name__ == "__main__":
    main()
