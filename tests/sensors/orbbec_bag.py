#!/usr/bin/env python3
"""A recording of Orbbec's SDK 2, played by the SDK itself and read by vesalius: both see the same depth.

The SDK records only what a camera gives, so the bag is written here, as its own reader wants it: no LZ4 of other libraries,
a device of afef…, a property 0 that says version 2.0, profiles of streams, and pictures with the unit of depth and five numbers
behind. It plays at its own pace; these are four frames of 30 a second.

Needs a Python with: pyorbbecsdk2, rosbags, numpy, opencv-python-headless.

usage: orbbec_bag.py VESALIUS
"""
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
from rosbags.rosbag1 import Writer

WIDTH, HEIGHT, START_US, APART_US = 320, 240, 60_000_000, 33_000
INTRINSICS = (262.5, 262.5, 159.5, 119.5)
DEPTH, Y16, BROWN_CONRADY = 3, 8, 4
SUMS = {"sensor_msgs/msg/Image": "060021388200f6f0f447d0fcd9c64743",
        "custom_msg/msg/OBDeviceInfo": "afef5328bb4abebd1a309e1ea8b26b3a",
        "custom_msg/msg/OBProperty": "0123456789abcdef0123456789abcdef",
        "custom_msg/msg/OBStreamProfileInfo": "0123456789abcdef0123456789abcdef"}


def text(value):
    return struct.pack("<I", len(value)) + value


def header(time_us):
    return struct.pack("<III", 0, time_us // 10**6, time_us % 10**6 * 1000) + text(b"")


def image(number, time_us, depth):
    unit_mm = struct.pack("<f", 1.0)
    return (header(time_us) + struct.pack("<II", HEIGHT, WIDTH) + text(b"mono16") + struct.pack("<BI", 0, 2 * WIDTH) +
            text(depth.tobytes()) + unit_mm + struct.pack("<4Q", number, time_us, time_us, time_us) + text(b"") +
            struct.pack("<I", 0))


def profile():
    upright = (1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)
    return (header(START_US) + struct.pack("<BB12f3H4f8fB", DEPTH, Y16, *upright, WIDTH, HEIGHT, 30, *INTRINSICS, *[0] * 8,
                                           BROWN_CONRADY))


def device():
    femto_bolt = struct.pack("<HH", 0x2BC5, 0x066B)
    return (header(START_US) + text(b"Femto Bolt") + text(b"Femto Bolt") + text(b"") + femto_bolt +
            b"".join(text(value) for value in (b"uid", b"serial", b"1.0.0", b"1", b"2.0.0", b"USB3.0")) +
            struct.pack("<HB", 0, 0) + text(b"") + text(b""))


def version():
    value = struct.pack("<d", 2.0)
    return header(START_US) + struct.pack("<I", 0) + text(value) + struct.pack("<I", len(value))


def write(path, pictures):
    with Writer(path) as bag:
        def put(topic, kind, time_us, message):
            known = [one for one in bag.connections if one.topic == topic]
            to = known[0] if known else bag.add_connection(topic, kind, msgdef="uint8 x\n", md5sum=SUMS[kind])
            bag.write(to, time_us * 1000, message)

        put("/cam/property", "custom_msg/msg/OBProperty", START_US, version())
        for number, depth in enumerate(pictures):
            time_us = START_US + number * APART_US
            put("/cam/sensor_3/frameType_3", "sensor_msgs/msg/Image", time_us, image(number + 1, time_us, depth))
        put("/cam/deviceInfo", "custom_msg/msg/OBDeviceInfo", START_US, device())
        put("/cam/streamProfileType_3", "custom_msg/msg/OBStreamProfileInfo", START_US, profile())


def played(path):
    """Returns depth by times (microseconds), as the SDK plays it."""
    import pyorbbecsdk as sdk

    pipeline, wanted = sdk.Pipeline(sdk.PlaybackDevice(str(path))), sdk.Config()
    wanted.enable_stream(sdk.OBSensorType.DEPTH_SENSOR)
    pipeline.start(wanted)
    found = {}
    while (frames := pipeline.wait_for_frames(1000)) is not None:
        depth = frames.get_depth_frame()
        assert depth.get_depth_scale() == 1.0, depth.get_depth_scale()
        lens = depth.get_stream_profile().as_video_stream_profile().get_intrinsic()
        assert (lens.fx, lens.fy, lens.cx, lens.cy) == INTRINSICS, lens
        found[depth.get_timestamp_us()] = np.frombuffer(depth.get_data(), np.uint16).reshape(HEIGHT, WIDTH).copy()
    pipeline.stop()
    return found


def main():
    vesalius = Path(sys.argv[1]).resolve()
    pictures = [(np.arange(WIDTH * HEIGHT).reshape(HEIGHT, WIDTH) % 5000 + 500 + i).astype("<u2") for i in range(4)]
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)  # where the SDK writes its log
        bag = Path(work) / "a.bag"
        write(bag, pictures)
        theirs = played(bag)
        assert len(theirs) == len(pictures), sorted(theirs)
        subprocess.run([vesalius, "convert", bag, "ours", "--to", "folder", "-q"], check=True)
        ours = {round(float(file.stem) * 1e6): cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
                for file in Path("ours/depth").glob("*.png")}
        assert ours.keys() == theirs.keys(), (sorted(ours), sorted(theirs))
        for time_us, depth in ours.items():
            assert (depth == theirs[time_us]).all(), time_us
        os.chdir("/")
    print(f"Orbbec's SDK and vesalius read the same {len(pictures)} frames of a bag")


if __name__ == "__main__":
    main()
