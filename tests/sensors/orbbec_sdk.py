#!/usr/bin/env python3
"""Orbbec's SDK as vesalius uses it, as far as that shows without a camera.

The SDK has all functions that vesalius looks for; vesalius loads it, sees no camera, and writes no folder of logs; and its
filter "Align", set as vesalius sets it, puts a picture of depth that is made up here onto the grid of a colour camera with a
lens that distorts, as if it had none.

Needs a Python with: pyorbbecsdk2, numpy.

usage: orbbec_sdk.py VESALIUS SOURCE_DIR
"""
import ctypes
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

DEPTH, COLOUR, Y16, RGB = 3, 2, 8, 22
FOCAL, WIDTH, HEIGHT = 605.0, 1280, 960


class Intrinsics(ctypes.Structure):
    _pack_ = 1
    _fields_ = [(name, ctypes.c_float) for name in ("fx", "fy", "cx", "cy")] + [
        (name, ctypes.c_int16) for name in ("width", "height")]


class Distortion(ctypes.Structure):
    _pack_ = 1
    _fields_ = [("coefficients", ctypes.c_float * 8), ("model", ctypes.c_int32)]


class Extrinsics(ctypes.Structure):
    _pack_ = 1
    _fields_ = [("rotation", ctypes.c_float * 9), ("translation", ctypes.c_float * 3)]


class Sdk:
    """Calls functions of the library; the last argument of each is where it puts an error."""

    def __init__(self, path):
        self.library = ctypes.CDLL(str(path))
        self.library.ob_error_get_message.restype = ctypes.c_char_p
        self.library.ob_error_get_message.argtypes = [ctypes.c_void_p]

    def __call__(self, name, result, *arguments):
        function, failure = self.library["ob_" + name], ctypes.c_void_p()
        function.restype = result
        value = function(*arguments, ctypes.byref(failure))
        assert not failure.value, f"{name}: {self.library.ob_error_get_message(failure)}"
        return ctypes.c_void_p(value) if result is ctypes.c_void_p else value


def stream(sdk, kind, pixels, width, height, lens, k1):
    profile = sdk("create_video_stream_profile", ctypes.c_void_p, kind, pixels, width, height, 30)
    sdk("video_stream_profile_set_intrinsic", None, profile, lens)
    brown_conrady = 4
    coefficients = (ctypes.c_float * 8)(k1)
    sdk("video_stream_profile_set_distortion", None, profile, Distortion(coefficients, brown_conrady))
    return profile


def pixels_of(sdk, frame, width, height):
    data = sdk("frame_get_data", ctypes.c_void_p, frame)
    return np.ctypeslib.as_array(ctypes.cast(data, ctypes.POINTER(ctypes.c_uint16)), (height, width))


def registers_without_distortion(sdk):
    depth = stream(sdk, DEPTH, Y16, 640, 576, Intrinsics(504, 504, 320, 288, 640, 576), 0.0)
    colour = stream(sdk, COLOUR, RGB, WIDTH, HEIGHT, Intrinsics(FOCAL, FOCAL, 639.5, 479.5, WIDTH, HEIGHT), 0.2)
    aside_mm = -30.0
    turn = (ctypes.c_float * 9)(1, 0, 0, 0, 1, 0, 0, 0, 1)
    sdk("stream_profile_set_extrinsic_to", None, depth, colour, Extrinsics(turn, (ctypes.c_float * 3)(aside_mm, 0, 0)))
    pictures = [sdk("create_frame_from_stream_profile", ctypes.c_void_p, one) for one in (depth, colour)]
    sdk("depth_frame_set_value_scale", None, pictures[0], ctypes.c_float(0.5))
    made = pixels_of(sdk, pictures[0], 640, 576)
    made[:] = 4000
    made[40:44, 40:44] = 3000  # 1.5 m away, in the corner, where the lens distorts most
    together = sdk("create_frameset", ctypes.c_void_p)
    for picture in pictures:
        sdk("frameset_push_frame", None, together, picture)
    align = sdk("create_filter", ctypes.c_void_p, b"Align")
    for name, value in ((b"AlignType", COLOUR), (b"TargetDistortion", 0), (b"MatchTargetRes", 1), (b"GapFillCopy", 1)):
        sdk("filter_set_config_value", None, align, name, ctypes.c_double(value))
    aligned = sdk("frameset_get_depth_frame", ctypes.c_void_p, sdk("filter_process", ctypes.c_void_p, align, together))
    size = [sdk(f"video_frame_get_{of}", ctypes.c_uint32, aligned) for of in ("width", "height")]
    assert size == [WIDTH, HEIGHT], size
    assert sdk("depth_frame_get_value_scale", ctypes.c_float, aligned) == 0.5
    found = pixels_of(sdk, aligned, WIDTH, HEIGHT)
    rows, columns = np.nonzero(found == 3000)
    x, y = (41.5 - 320) / 504 + aside_mm / 1500, (41.5 - 288) / 504
    assert abs(columns.mean() - (FOCAL * x + 639.5)) < 1.5 and abs(rows.mean() - (FOCAL * y + 479.5)) < 1.5, (
        columns.mean(), rows.mean())
    assert set(np.unique(found)) == {0, 3000, 4000}, "depths are mixed"
    assert (found[300:600, 300:900] == 0).mean() < 1e-3, "holes in what depth covers"


def main():
    vesalius, source = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    folder = Path(importlib.util.find_spec("pyorbbecsdk").origin).parent
    path = next(folder.glob("libOrbbecSDK.so.2"))
    sdk = Sdk(path)
    header = (source / "src/io/sensors/orbbec_api.h").read_text()
    names = re.findall(r"VESALIUS_FUNCTION\([^,]+,\s*(\w+)", header)
    lacking = [name for name in names if not hasattr(sdk.library, "ob_" + name)]
    assert len(names) > 50 and not lacking, f"the SDK has no {lacking}"
    sdk("set_logger_severity", None, 5)
    registers_without_distortion(sdk)
    with tempfile.TemporaryDirectory() as empty:
        environment = {**os.environ, "VESALIUS_ORBBEC": str(path)}
        listed = subprocess.run([vesalius, "cameras"], cwd=empty, env=environment, capture_output=True, text=True, check=True)
        assert "orbbec: no camera plugged in" in listed.stdout, listed.stdout
        refused = subprocess.run([vesalius, "record", "orbbec:", "--out", "x.mcap"], cwd=empty, env=environment,
                                 capture_output=True, text=True)
        assert refused.returncode == 1 and refused.stderr.count("\n") == 1, refused.stderr
        assert not os.listdir(empty), os.listdir(empty)
    print(f"Orbbec's SDK {sdk.library.ob_get_version()}: {len(names)} functions, no camera, registers as it should")


if __name__ == "__main__":
    main()
