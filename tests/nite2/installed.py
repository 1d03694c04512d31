#!/usr/bin/env python3
"""libNiTE2.so as it is installed: what it exports, and programs in C and C++ that are compiled with its header by all compilers that there are,
and find library and model in the installation.

Usage: installed.py SOURCE_DIR BUILD_DIR LIBOPENNI2
"""
import os
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "standin"))
from installed_library import WARNINGS, check_symbols, expect_line, expect_same, run  # noqa: E402

SIZE = 160, 120
OPENNI2_HEADERS = Path("/usr/include/openni2")

# A program in another language: libraries that it loads are visible to nobody else. It ends without shutting anything down.
BY_CTYPES = """
import ctypes, sys
library, *openni2 = sys.argv[1:]
for path in openni2:
    ctypes.CDLL(path)
nite, tracker = ctypes.CDLL(library), ctypes.c_void_p()
print(nite.niteInitialize(), nite.niteInitializeUserTracker(ctypes.byref(tracker)), bool(tracker))
"""


def check_discovery(library, recording, openni2, folder):
    """libOpenNI2 is found under whatever name a program has loaded it, or told to be missing."""
    renamed = folder / "libOpenNI2-0123abcd.so.0"
    shutil.copy(openni2, renamed)
    environment = {name: value for name, value in os.environ.items() if name not in ("VESALIUS_OPENNI2", "VESALIUS_MODELS")}
    environment["FAKE_OPENNI2"] = str(recording)
    for more, variables, answer, line in (([renamed], {}, "0 0 True\n", ""), ([], {"VESALIUS_OPENNI2": str(renamed)}, "0 0 True\n", ""),
                                          ([renamed], {"VESALIUS_OPENNI2": "/none.so"}, "1 3 False\n", "VESALIUS_OPENNI2=/none.so: ")):
        done = subprocess.run([sys.executable, "-c", BY_CTYPES, library, *more], env={**environment, **variables}, capture_output=True, text=True,
                              check=True)
        expect_line(done, answer, line)


def write_recording(path):
    """Two pictures of a wall as fake_openni2.c reads them."""
    wall = struct.pack("<H", 3000) * (SIZE[0] * SIZE[1])
    path.write_bytes(struct.pack("<iiffii", *SIZE, 1.0, 0.8, 0, 1) + b"".join(struct.pack("<Q", 1000 * i) + wall for i in (1, 2)))


def main():
    source, build, openni2 = (Path(each).resolve() for each in sys.argv[1:4])
    here, stand_in = source / "tests/nite2", source / "src/nite2/oni"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        prefix, recording = folder / "prefix", folder / "recording"
        run("cmake", "--install", build, "--prefix", prefix)
        (library,) = prefix.rglob("libNiTE2.so")
        (header,) = prefix.rglob("NiteCAPI.h")
        expect_same("folder", library.parent.parts[-2:], ("vesalius", "nite2"))
        check_symbols(library, header, source / "src/nite2/libNiTE2.map", r"nite[A-Z]\w+", "libNiTE2.so", "libOpenNI2")
        write_recording(recording)
        check_discovery(library, recording, openni2, folder)
        environment = {**os.environ, "LD_LIBRARY_PATH": f"{library.parent}:{openni2.parent}", "FAKE_OPENNI2": str(recording), "VESALIUS_MODELS": ""}
        flags = [f"-I{header.parent}", f"-I{here}", f"-L{library.parent}", "-Wl,--no-as-needed", "-lNiTE2", openni2, "-pthread"]
        programs = [(compiler, "-std=c99", here / "user_loop.c", stand_in) for compiler in ("cc", "clang-14") if shutil.which(compiler)]
        programs += [(compiler, standard, here / "listener.cpp", headers) for compiler in ("c++", "clang++-14") if shutil.which(compiler)
                     for standard in ("-std=c++11", "-std=c++20") for headers in (stand_in, OPENNI2_HEADERS) if headers.exists()]
        for compiler, standard, program, headers in programs:
            kind = "-isystem" if headers == OPENNI2_HEADERS else "-I"
            run(compiler, standard, *WARNINGS, program, kind, headers, *flags, "-o", folder / "program")
            expect_same("a wall", run(folder / "program", "2", env=environment), "frame 1000\nframe 2000\n")


if __name__ == "__main__":
    main()
