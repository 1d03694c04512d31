#!/usr/bin/env python3
"""libk4abt.so as it is installed: what it exports, and programs in C and C++ that are compiled with its headers by all compilers that there
are, and find library and model in the installation.

Usage: installed.py SOURCE_DIR BUILD_DIR LIBK4A
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

SIZE = 640, 480
CALIBRATION_BYTES = 1032


# A program in another language: libraries that it loads are visible to nobody else. It ends without destroying anything.
BY_CTYPES = """
import ctypes, sys
class Configuration(ctypes.Structure):
    _fields_ = [("orientation", ctypes.c_int), ("mode", ctypes.c_int), ("device", ctypes.c_int32), ("model", ctypes.c_char_p)]
library, recording, *libk4a = sys.argv[1:]
for path in libk4a:
    ctypes.CDLL(path)
tracker, calibration = ctypes.c_void_p(), open(recording, "rb").read()
print(ctypes.CDLL(library).k4abt_tracker_create(calibration, Configuration(0, 1, 0, None), ctypes.byref(tracker)), bool(tracker))
"""


def check_discovery(library, recording, libk4a, folder):
    """libk4a is found under whatever name a program has loaded it, or told to be missing."""
    renamed = folder / "libk4a-0123abcd.so.1.4.2"
    shutil.copy(libk4a, renamed)
    environment = {name: value for name, value in os.environ.items() if name not in ("LD_LIBRARY_PATH", "VESALIUS_K4A", "VESALIUS_MODELS")}
    for more, variables, answer, line in (([renamed], {}, "0 True\n", ""), ([], {"VESALIUS_K4A": str(renamed)}, "0 True\n", ""),
                                          ([], {}, "1 False\n", "no libk4a: expected one that the program has loaded"),
                                          ([renamed], {"VESALIUS_K4A": "/none.so"}, "1 False\n", "VESALIUS_K4A=/none.so: ")):
        done = subprocess.run([sys.executable, "-c", BY_CTYPES, library, recording, *more], env={**environment, **variables},
                              capture_output=True, text=True, check=True)
        expect_line(done, answer, line)


def write_recording(path):
    """Two pictures of a wall as fake_k4a.c reads them."""
    parameters = [319.5, 239.5, 525.0, 525.0] + [0.0] * 11
    depth_camera = struct.pack("<12fiI15fiif", *[0.0] * 12, 4, 14, *parameters, *SIZE, 0.0)
    calibration = depth_camera.ljust(CALIBRATION_BYTES - 8, b"\0") + struct.pack("<ii", 2, 0)
    wall = struct.pack("<H", 3000) * (SIZE[0] * SIZE[1])
    path.write_bytes(calibration + b"".join(struct.pack("<Q", 1000 * i) + wall for i in (1, 2)))


def main():
    source, build, libk4a = (Path(each).resolve() for each in sys.argv[1:4])
    here = source / "tests/k4abt"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        prefix, recording = folder / "prefix", folder / "recording"
        run("cmake", "--install", build, "--prefix", prefix)
        (library,) = prefix.rglob("libk4abt.so.1.1")
        (header,) = prefix.rglob("k4abt.h")
        expect_same("folder", library.parent.parts[-2:], ("vesalius", "k4abt"))
        check_symbols(library, header, source / "src/k4abt/libk4abt.map", r"k4abt_\w+", "libk4abt.so.1.1", "libk4a")
        write_recording(recording)
        check_discovery(library, recording, libk4a, folder)
        environment = {**os.environ, "LD_LIBRARY_PATH": f"{library.parent}:{libk4a.parent}", "FAKE_K4A": str(recording), "VESALIUS_MODELS": ""}
        flags = [f"-I{header.parent}", f"-I{here}", f"-I{source / 'src/k4abt'}", f"-L{library.parent}", "-lk4abt", libk4a]
        programs = [(compiler, "-std=c99", here / "live_loop.c") for compiler in ("cc", "clang-14") if shutil.which(compiler)]
        programs += [(compiler, standard, here / "offline_processor.cpp") for compiler in ("c++", "clang++-14") if shutil.which(compiler)
                     for standard in ("-std=c++11", "-std=c++20")]
        for compiler, standard, program in programs:
            run(compiler, standard, *WARNINGS, program, *flags, "-o", folder / "program")
            expect_same("a wall", run(folder / "program", recording, env=environment), "frame 1000\nframe 2000\n")


if __name__ == "__main__":
    main()
