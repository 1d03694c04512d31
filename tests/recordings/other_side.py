#!/usr/bin/env python3
"""Recordings between vesalius and other programs, both ways.

Writes the frames of FOLDER (depth/*.png, rgb/*, meta.json) into recordings with rosbags and mcap, in every layout, compression
and encoding of depth, and has vesalius turn each back into a folder: its
depth must be the same, pixel by pixel, and its colour, where nothing was lost. Recordings begun in the middle must give the
same frames. Then has vesalius record FOLDER, and rosbags, mcap and rerun read that.

Needs a Python with: rosbags mcap mcap-ros2-support numpy opencv-python-headless; optionally rerun-sdk,
foxglove-schemas-protobuf, pyrealsense2 (2.55 records .bag, later ones .db3).

usage: other_side.py VESALIUS FOLDER
       other_side.py --fixtures SEEDS   writes, into folders of fuzz/seeds, the small recordings that the tests of io and the fuzzer start from
"""
import json
import os
import shutil
import struct
import subprocess
import sys
import sysconfig
import tempfile
import time
from importlib import metadata
from pathlib import Path

import cv2
import numpy as np
from rosbags.rosbag1 import Reader as Reader1
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STEP_NS = 33_000_000
FIRST_NS = 1_700_000_000_000_000_000
DEPTH, COLOUR, INFO = "/camera/depth/image_raw", "/camera/color/image_raw", "/camera/depth/camera_info"


def frames(folder):
    for i, path in enumerate(sorted((folder / "depth").glob("*.png"))):
        colours = list((folder / "rgb").glob(path.stem + ".*"))
        colour = cv2.imread(str(colours[0])) if colours else None
        yield FIRST_NS + i * STEP_NS, cv2.imread(str(path), cv2.IMREAD_UNCHANGED), colour


class Messages:
    """Messages of ROS 1 or 2 by the same names."""

    def __init__(self, store, is_ros1):
        self.store, self.is_ros1, self.types = store, is_ros1, store.types

    def header(self, time_ns):
        stamp = self.types["builtin_interfaces/msg/Time"](sec=time_ns // 10**9, nanosec=time_ns % 10**9)
        more = {"seq": 7} if self.is_ros1 else {}
        return self.types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera_color_optical_frame", **more)

    def image(self, time_ns, picture, encoding):
        rows = np.ascontiguousarray(picture)
        big = 1 if rows.dtype.byteorder == ">" else 0
        step = rows.strides[0]
        return "sensor_msgs/msg/Image", self.types["sensor_msgs/msg/Image"](
            header=self.header(time_ns), height=rows.shape[0], width=rows.shape[1], encoding=encoding, is_bigendian=big,
            step=step, data=np.frombuffer(rows.tobytes(), np.uint8))

    def compressed(self, time_ns, data, encoding):
        return "sensor_msgs/msg/CompressedImage", self.types["sensor_msgs/msg/CompressedImage"](
            header=self.header(time_ns), format=encoding, data=np.frombuffer(data, np.uint8))

    def info(self, time_ns, meta):
        k = np.array([meta["fx"], 0, meta["cx"], 0, meta["fy"], meta["cy"], 0, 0, 1], float)
        p = np.array([meta["fx"], 0, meta["cx"], 0, 0, meta["fy"], meta["cy"], 0, 0, 0, 1, 0], float)
        roi = self.types["sensor_msgs/msg/RegionOfInterest"](x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        values = {"d": np.zeros(5), "k": k, "r": np.eye(3).reshape(-1), "p": p}
        if self.is_ros1:
            values = {name.upper(): value for name, value in values.items()}
        return "sensor_msgs/msg/CameraInfo", self.types["sensor_msgs/msg/CameraInfo"](
            header=self.header(time_ns), height=meta["height"], width=meta["width"], distortion_model="plumb_bob",
            binning_x=0, binning_y=0, roi=roi, **values)

    def bytes(self, kind, message):
        write = self.store.serialize_ros1 if self.is_ros1 else self.store.serialize_cdr
        return write(message, kind)


def rvl(depth):
    """Depth packed as by Wilson (2017), written down anew from the paper's description."""
    nibbles = []

    def number(value):
        while True:
            low, value = value & 7, value >> 3
            nibbles.append(low | (8 if value else 0))
            if not value:
                return

    values, at, previous = depth.reshape(-1).tolist(), 0, 0
    while at < len(values):
        start = at
        while at < len(values) and values[at] == 0:
            at += 1
        number(at - start)
        start = at
        while at < len(values) and values[at] != 0:
            at += 1
        number(at - start)
        for value in values[start:at]:
            difference, previous = value - previous, value
            number(difference << 1 if difference >= 0 else (-difference << 1) - 1)
    nibbles += [0] * (-len(nibbles) % 8)
    words = [int("".join(f"{n:x}" for n in nibbles[i:i + 8]), 16) for i in range(0, len(nibbles), 8)]
    return struct.pack(f"<{len(words)}I", *words)


def depth_variants(messages):
    head = struct.pack("<iff", 0, 0.0, 0.0)

    def png(depth):
        return cv2.imencode(".png", depth)[1].tobytes()

    return {
        "16UC1": lambda t, d: messages.image(t, d, "16UC1"),
        "mono16": lambda t, d: messages.image(t, d, "mono16"),
        "16UC1 big-endian": lambda t, d: messages.image(t, d.astype(">u2"), "16UC1"),
        "32FC1": lambda t, d: messages.image(t, np.where(d == 0, np.nan, d / 1000).astype("f4"), "32FC1"),
        "compressedDepth": lambda t, d: messages.compressed(t, head + png(d), "16UC1; compressedDepth"),
        "compressedDepth png": lambda t, d: messages.compressed(t, head + png(d), "16UC1; compressedDepth png"),
        "compressedDepth rvl": lambda t, d: messages.compressed(
            t, head + struct.pack("<II", d.shape[1], d.shape[0]) + rvl(d), "16UC1; compressedDepth rvl"),
    }


def colour_variants(messages):
    def alpha(c):
        return np.dstack([c, np.full(c.shape[:2], 255, np.uint8)])

    return {
        "rgb8": lambda t, c: messages.image(t, c[:, :, ::-1], "rgb8"),
        "bgr8": lambda t, c: messages.image(t, c, "bgr8"),
        "bgra8": lambda t, c: messages.image(t, alpha(c), "bgra8"),
        "png": lambda t, c: messages.compressed(t, cv2.imencode(".png", c)[1].tobytes(), "rgb8; png compressed bgr8"),
    }


def write_all(connect, messages, folder, depth_of, colour_of):
    """Colour first on even frames and after depth on odd ones, as two streams overtake each other."""
    meta = json.loads((folder / "meta.json").read_text())
    channels = {}

    def put(topic, time_ns, kind_and_message):
        kind, message = kind_and_message
        if topic not in channels:
            channels[topic] = connect(topic, kind)
        channels[topic](time_ns, messages.bytes(kind, message))

    for i, (time_ns, depth, colour) in enumerate(frames(folder)):
        put(INFO, time_ns, messages.info(time_ns, meta))
        order = [(DEPTH, lambda: depth_of(time_ns, depth))]
        if colour is not None:
            order.append((COLOUR, lambda: colour_of(time_ns + 2_000_000, colour)))
        for topic, make in order if i % 2 else reversed(order):
            put(topic, time_ns, make())


def write_bag(path, folder, compression, depth, colour):
    store = get_typestore(Stores.ROS1_NOETIC)
    messages = Messages(store, True)
    writer = Writer1(path)
    if compression:
        writer.set_compression(compression)
    with writer:
        def connect(topic, kind):
            connection = writer.add_connection(topic, kind, typestore=store)
            return lambda time_ns, data: writer.write(connection, time_ns, data)

        write_all(connect, messages, folder, depth_variants(messages)[depth], colour_variants(messages)[colour])


def write_ros2(path, folder, plugin, compression, depth, colour):
    store = get_typestore(Stores.ROS2_HUMBLE)
    messages = Messages(store, False)
    writer = Writer2(path, version=9, storage_plugin=plugin)
    if compression:
        writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    with writer:
        def connect(topic, kind):
            connection = writer.add_connection(topic, kind, typestore=store)
            return lambda time_ns, data: writer.write(connection, time_ns, data)

        write_all(connect, messages, folder, depth_variants(messages)[depth], colour_variants(messages)[colour])


def write_mcap(path, folder, compression, chunked, depth, colour):
    from mcap.writer import CompressionType, Writer
    store = get_typestore(Stores.ROS2_HUMBLE)
    messages = Messages(store, False)
    with open(path, "wb") as out:
        writer = Writer(out, compression=CompressionType[compression], use_chunking=chunked, chunk_size=300_000)
        writer.start(profile="ros2", library="other side")

        def connect(topic, kind):
            schema = writer.register_schema(kind, "ros2msg", store.generate_msgdef(kind, ros_version=2)[0].encode())
            channel = writer.register_channel(topic, "cdr", schema)
            return lambda time_ns, data: writer.add_message(channel, time_ns, bytes(data), time_ns)

        write_all(connect, messages, folder, depth_variants(messages)[depth], colour_variants(messages)[colour])
        writer.finish()


def write_foxglove(path, folder):
    from foxglove_schemas_protobuf import CameraCalibration_pb2, RawImage_pb2
    from google.protobuf.descriptor_pb2 import FileDescriptorSet
    from mcap.writer import Writer

    def schema_of(message):
        files, seen = FileDescriptorSet(), set()

        def add(file):
            if file.name not in seen:
                seen.add(file.name)
                for needed in file.dependencies:
                    add(needed)
                file.CopyToProto(files.file.add())

        add(message.DESCRIPTOR.file)
        return files.SerializeToString()

    meta = json.loads((folder / "meta.json").read_text())
    with open(path, "wb") as out:
        writer = Writer(out)
        writer.start(profile="", library="other side")
        channels = {}

        def put(topic, time_ns, message):
            message.timestamp.seconds, message.timestamp.nanos = time_ns // 10**9, time_ns % 10**9
            message.frame_id = "camera"
            if topic not in channels:
                schema = writer.register_schema(message.DESCRIPTOR.full_name, "protobuf", schema_of(message))
                channels[topic] = writer.register_channel(topic, "protobuf", schema)
            writer.add_message(channels[topic], time_ns, message.SerializeToString(), time_ns)

        for time_ns, depth, colour in frames(folder):
            info = CameraCalibration_pb2.CameraCalibration(width=meta["width"], height=meta["height"])
            info.K.extend([meta["fx"], 0, meta["cx"], 0, meta["fy"], meta["cy"], 0, 0, 1])
            put(INFO, time_ns, info)
            for topic, picture, encoding in ((DEPTH, depth, "16UC1"), (COLOUR, colour, "bgr8")):
                if picture is None:
                    continue
                put(topic, time_ns, RawImage_pb2.RawImage(
                    width=picture.shape[1], height=picture.shape[0], encoding=encoding, step=picture.strides[0],
                    data=picture.tobytes()))
        writer.finish()


def expect_same(vesalius, recording, folder, name):
    with tempfile.TemporaryDirectory() as back:
        back = Path(back) / "back"
        subprocess.run([vesalius, "convert", recording, back, "--to", "folder", "-q"], check=True)
        found = list(frames(back))
        wanted = list(frames(folder))
        assert len(found) == len(wanted), f"{name}: {len(found)} frames, expected {len(wanted)}"
        for (_, depth, colour), (time_ns, true_depth, true_colour) in zip(found, wanted):
            assert np.array_equal(depth, true_depth), f"{name}: depth differs at {time_ns}"
            assert (colour is None) == (true_colour is None), f"{name}: colour missing at {time_ns}"
            assert colour is None or np.array_equal(colour, true_colour), f"{name}: colour differs at {time_ns}"
        times = [path.stem for path in sorted((back / "depth").glob("*.png"))]
        assert times == [f"{t // 10**9}.{t % 10**9:09}" for t, _, _ in wanted], f"{name}: times {times}"
        camera = json.loads((back / "meta.json").read_text())
        meta = json.loads((folder / "meta.json").read_text())
        for key in ("fx", "fy", "cx", "cy"):
            assert abs(camera[key] - meta[key]) < 1e-3, f"{name}: {key} {camera[key]}, expected {meta[key]}"
    print("same:", name, flush=True)


def read_back(vesalius, recording, back, *flags):
    shutil.rmtree(back, ignore_errors=True)
    subprocess.run([vesalius, "convert", recording, back, "--to", "folder", "-q", *flags], check=True)
    return [(depth, colour) for _, depth, colour in frames(back)]


def expect_late_frames(vesalius, recording, folder, work, name, is_cut=False):
    """A recording that is begun in the middle gives the frames from there on, with their colour."""
    wanted = list(frames(folder))
    if is_cut:
        wanted = wanted[: len(read_back(vesalius, recording, work / "late"))]
        assert len(wanted) > 10, f"{name}: {len(wanted)} frames"
    for first in (1, len(wanted) // 2, len(wanted) - 1):
        found = read_back(vesalius, recording, work / "late", "--start", str((first * STEP_NS - 10**6) / 1e9))
        assert len(found) == len(wanted) - first, f"{name}: {len(found)} frames from {first} of {len(wanted)} on"
        for (depth, colour), (_, true_depth, true_colour) in zip(found, wanted[first:]):
            assert np.array_equal(depth, true_depth), f"{name}: depth differs after a seek to {first}"
            assert np.array_equal(colour, true_colour), f"{name}: colour differs after a seek to {first}"
    print("sought:", name, flush=True)


def seek_in_theirs(vesalius, folder, work):
    """In copies of the frames that are long enough for several chunks."""
    many = work / "many"
    (many / "depth").mkdir(parents=True)
    (many / "rgb").mkdir()
    shutil.copy(folder / "meta.json", many / "meta.json")
    kept = list(frames(folder))
    for i in range(60):
        _, depth, colour = kept[i % len(kept)]
        depth = depth.copy()
        depth[0, : i + 1] = 1234
        cv2.imwrite(str(many / "depth" / f"{i:03}.png"), depth)
        cv2.imwrite(str(many / "rgb" / f"{i:03}.png"), np.roll(colour, i, axis=1))
    write_bag(work / "many.bag", many, None, "16UC1", "rgb8")
    expect_late_frames(vesalius, work / "many.bag", many, work, "ROS 1 bag")
    data = (work / "many.bag").read_bytes()
    (work / "cut_many.bag").write_bytes(data[: int(0.8 * len(data))])
    expect_late_frames(vesalius, work / "cut_many.bag", many, work, "ROS 1 bag cut short", is_cut=True)
    write_ros2(work / "many_ros2", many, StoragePlugin.SQLITE3, False, "compressedDepth png", "png")
    expect_late_frames(vesalius, work / "many_ros2", many, work, "ROS 2 bag in SQLite")
    for chunked in (True, False):
        write_mcap(work / f"many{chunked}.mcap", many, "NONE", chunked, "16UC1", "bgr8")
        expect_late_frames(vesalius, work / f"many{chunked}.mcap", many, work, f"MCAP, chunks {chunked}")


def read_theirs(vesalius, folder, work):
    depths = list(depth_variants(Messages(get_typestore(Stores.ROS2_HUMBLE), False)))
    colours = list(colour_variants(Messages(get_typestore(Stores.ROS2_HUMBLE), False)))
    for i, depth in enumerate(depths):
        colour = colours[i % len(colours)]
        compression = [None, Writer1.CompressionFormat.BZ2, Writer1.CompressionFormat.LZ4][i % 3]
        write_bag(work / f"{i}.bag", folder, compression, depth, colour)
        expect_same(vesalius, work / f"{i}.bag", folder, f"ROS 1 bag, {compression}, {depth}, {colour}")
        plugin = [StoragePlugin.SQLITE3, StoragePlugin.MCAP][i % 2]
        packed = plugin == StoragePlugin.SQLITE3 and i % 4 == 2
        write_ros2(work / f"{i}_ros2", folder, plugin, packed, depth, colour)
        expect_same(vesalius, work / f"{i}_ros2", folder, f"ROS 2 bag, {plugin}, messages packed {packed}, {depth}, {colour}")
        kind = ["NONE", "LZ4", "ZSTD"][i % 3]
        write_mcap(work / f"{i}.mcap", folder, kind, i != 4, depth, colour)
        expect_same(vesalius, work / f"{i}.mcap", folder, f"MCAP, {kind}, chunks {i != 4}, {depth}, {colour}")
    try:
        write_foxglove(work / "foxglove.mcap", folder)
        expect_same(vesalius, work / "foxglove.mcap", folder, "MCAP of foxglove schemas")
    except ImportError as missing:
        print("left out: foxglove schemas:", missing)


def cut_short(vesalius, folder, work):
    """A recording that ends anywhere gives the frames before that."""
    whole = len(list(frames(folder)))
    for name in ("0.bag", "1.bag", "2.mcap", "4.mcap"):
        data = (work / name).read_bytes()
        counts = []
        for share in (0.4, 0.7, 0.95):
            part = work / ("cut" + Path(name).suffix)
            part.write_bytes(data[: int(share * len(data))])
            shutil.rmtree(work / "back", ignore_errors=True)
            done = subprocess.run([vesalius, "convert", part, work / "back", "--to", "folder"], capture_output=True, text=True)
            assert done.returncode == 0, f"{name}: {done.stderr}"
            assert "cut short" in done.stderr or share == 0.95, f"{name}: not a word that it is cut short: {done.stderr}"
            counts.append(len(list((work / "back" / "depth").glob("*.png"))))
        assert counts == sorted(counts) and 0 < counts[0] < whole, f"{name}: {counts} of {whole} frames"
        print("cut short:", name, counts, "of", whole, flush=True)


def give_ours(vesalius, folder, work):
    ours = work / "ours.mcap"
    subprocess.run([vesalius, "record", folder, "--out", ours, "--people", "-q"], check=True)
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory
    wanted = list(frames(folder))
    depths, people, texts = [], 0, 0
    with open(ours, "rb") as file:
        for _, channel, message, decoded in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            if channel.topic == "/camera/depth/image":
                depths.append(np.frombuffer(decoded.data, np.uint16).reshape(decoded.height, decoded.width))
            if channel.topic == "/people/markers":
                assert decoded.markers[0].action == 3 and len(decoded.markers) % 3 == 1
                people += len(decoded.markers) // 3
            if channel.topic == "/people/json":
                texts += len(json.loads(decoded.data)["people"])
    assert len(depths) == len(wanted) and all(np.array_equal(a, b[1]) for a, b in zip(depths, wanted)), "mcap: depth differs"
    assert people == texts and people > 0, f"mcap: {people} people in markers, {texts} in JSON"
    print("mcap reads ours:", len(depths), "frames,", people, "people")
    followed = work / "followed.mcap"
    subprocess.run([vesalius, "record", folder, "--out", followed, "--track", "-q"], check=True)
    found = subprocess.run([vesalius, "detect", folder, "--track", "-q", "--json", "-"], check=True, capture_output=True, text=True)
    lines = [json.loads(line) for line in found.stdout.splitlines()]
    lines = [line for line in lines if "people" in line]
    with open(followed, "rb") as file:
        recorded = [json.loads(decoded.data) for _, channel, _, decoded in
                    make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages() if channel.topic == "/people/json"]
    assert recorded == lines, "mcap: other people than detect --track finds"
    bodies = sum("body" in person for line in recorded for person in line["people"])
    assert bodies > 0 and all("id" in person for line in recorded for person in line["people"]), "mcap: no ids or bodies"
    print("mcap reads people over time:", len(recorded), "frames,", bodies, "bodies")
    from rosbags.highlevel import AnyReader
    (work / "ours_bag").mkdir()
    with AnyReader([ours], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        count = sum(1 for c, _, raw in reader.messages() if reader.deserialize(raw, c.msgtype) is not None)
    print("rosbags reads ours:", count, "messages")
    rerun = shutil.which("rerun", path=str(Path(sys.executable).parent))
    if rerun:
        subprocess.run([rerun, "mcap", "check", ours], check=True)
        print("rerun checks ours")
    else:
        print("left out: rerun")


def realsense(vesalius, work):
    """A camera made of software, recorded by librealsense: read by us, and played by that library into us."""
    try:
        import pyrealsense2 as rs
    except ImportError as missing:
        print("left out: RealSense:", missing)
        return
    width, height, count = 640, 480, 20

    def intrinsics(size, focal, model, coefficients):
        lens = rs.intrinsics()
        (lens.width, lens.height), lens.fx, lens.fy, lens.ppx, lens.ppy = size, focal, focal, size[0] / 2, size[1] / 2
        lens.model, lens.coeffs = model, coefficients
        return lens

    def video(sensor, kind, uid, pixel_bytes, pixel_format, lens):
        stream = rs.video_stream()
        stream.type, stream.index, stream.uid, stream.fps, stream.bpp, stream.fmt = kind, 0, uid, 30, pixel_bytes, pixel_format
        stream.width, stream.height, stream.intrinsics = lens.width, lens.height, lens
        return sensor.add_video_stream(stream)

    depth_lens = intrinsics((width, height), 600, rs.distortion.none, [0] * 5)
    # Librealsense's functions project by the inverse model as by the modified one, whatever it says of it.
    colour_lenses = [intrinsics((424, 240), 300, model, [0.1, -0.05, 0.003, -0.002, 0.01])
                     for model in (rs.distortion.brown_conrady, rs.distortion.inverse_brown_conrady)]
    side = colour_lenses[0]
    extrinsics = rs.extrinsics()
    turn = cv2.Rodrigues(np.array([0.02, -0.05, 0.04]))[0]
    extrinsics.rotation, extrinsics.translation = turn.T.reshape(-1).tolist(), [0.015, 0.001, 0.002]  # column by column
    version = metadata.version("pyrealsense2")
    suffix = ".bag" if [int(part) for part in version.split(".")[:2]] < [2, 56] else ".db3"
    rows, columns = np.mgrid[:side.height, :side.width]
    colour = np.dstack([columns * 255 // side.width, rows, np.full(rows.shape, 9)]).astype(np.uint8)
    pictures = []
    for k in range(count):
        depth = np.full((height, width), 2000 + 2 * k, np.uint16)
        depth[k, :] = 0
        pictures.append(depth)

    def film(path, colour_lens, depth_lens=depth_lens):
        """Records depth, alone or with colour and accelerations."""
        alone = colour_lens is None
        device = rs.software_device()
        device.register_info(rs.camera_info.name, "of software")
        device.register_info(rs.camera_info.serial_number, "1")
        sensor = device.add_sensor("Depth")
        profile = video(sensor, rs.stream.depth, 0, 2, rs.format.z16, depth_lens)
        sensor.add_read_only_option(rs.option.depth_units, 0.0005)
        if not alone:
            colour_sensor, motion_sensor = device.add_sensor("RGB"), device.add_sensor("Motion")
            colour_profile = video(colour_sensor, rs.stream.color, 1, 3, rs.format.rgb8, colour_lens)
            profile.register_extrinsics_to(colour_profile, extrinsics)
            motion = rs.motion_stream()
            motion.type, motion.index, motion.uid, motion.fps, motion.fmt = rs.stream.accel, 0, 2, 200, rs.format.motion_xyz32f
            motion.intrinsics = rs.motion_device_intrinsic()
            motion_profile = motion_sensor.add_motion_stream(motion)
        recorder = rs.recorder(str(path), device)
        recorded = recorder.query_sensors()
        queue = rs.frame_queue(1000)
        for one in recorded:
            one.open(one.get_stream_profiles()[0])
            one.start(queue)

        def show(to, of, picture, k):
            frame = rs.software_video_frame()
            frame.stride, frame.bpp, frame.timestamp, frame.frame_number = picture.strides[0], picture.strides[1], 1000.0 + 33 * k, k + 1
            frame.domain, frame.profile, frame.pixels = rs.timestamp_domain.hardware_clock, of.as_video_stream_profile(), picture
            to.on_video_frame(frame)

        for k, depth in enumerate(pictures):
            if not alone:
                gravity = rs.software_motion_frame()
                gravity.timestamp, gravity.frame_number = 995.0 + 33 * k, k + 1
                gravity.domain, gravity.profile = rs.timestamp_domain.hardware_clock, motion_profile.as_motion_stream_profile()
                acceleration = rs.vector()
                acceleration.x, acceleration.y, acceleration.z = 0.0, -7.84, 5.88
                gravity.data = acceleration
                motion_sensor.on_motion_frame(gravity)
                show(colour_sensor, colour_profile, colour, k)
            show(sensor, profile, depth, k)
            time.sleep(0.033)
        time.sleep(0.5)
        for one in recorded:
            one.stop()
            one.close()
        del recorded, recorder, one
        time.sleep(0.5)

    def expect_colour(folder, colour_lens):
        """Where librealsense's own functions find the colour of a point of depth."""
        seen = cv2.imread(str(sorted((folder / "rgb").glob("*.png"))[-1]))[:, :, ::-1].astype(int)
        z = pictures[-1][100, 100] * 0.0005
        compared = 0
        for v in range(20, height, 37):
            for u in range(5, width, 41):
                point = rs.rs2_deproject_pixel_to_point(depth_lens, [u, v], float(z))
                at = rs.rs2_project_point_to_pixel(colour_lens, rs.rs2_transform_point_to_point(extrinsics, point))
                if 1 < at[0] < colour_lens.width - 2 and 1 < at[1] < colour_lens.height - 2:
                    wanted = [at[0] * 255 / colour_lens.width, at[1], 9]
                    assert np.abs(seen[v, u] - wanted).max() < 2, f"RealSense: colour {seen[v, u]} at {u}, {v}, expected {wanted}"
                    compared += 1
                elif not (-1 < at[0] < colour_lens.width and -1 < at[1] < colour_lens.height):
                    assert not seen[v, u].any(), f"RealSense: colour {seen[v, u]} at {u}, {v}, which colour does not see"
        assert compared > 50, f"RealSense: {compared} colours compared"

    def expect_same_pictures(folder, other):
        """What the library plays into us is what we read of the file, though not all of it in time."""
        def all_of(place):
            return {path.read_bytes(): cv2.imread(str(place / "rgb" / path.name)) for path in (place / "depth").glob("*.png")}

        read, played = all_of(folder), all_of(other)
        assert played and played.keys() <= read.keys(), "RealSense: depth differs"
        for depth, colour in played.items():
            # The file has its rotation as a quaternion of rounded numbers, so a pixel may fall out of the picture.
            assert colour is not None and (np.abs(colour.astype(int) - read[depth]) > 1).mean() < 1e-4, "RealSense: colour differs"

    def expect_up(recording):
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory
        with open(recording, "rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            ups = [m[3].linear_acceleration for m in reader.iter_decoded_messages(topics=["/camera/imu"])]
        assert len(ups) >= count - 2, f"RealSense: up of {len(ups)} frames"
        for up in ups:
            off = np.abs(np.array([up.x, up.y, up.z]) / 9.80665 - [0, -0.8, 0.6]).max()
            assert off < 1e-5, f"RealSense: up {up}"

    def expect(folder, least):
        found = [cv2.imread(str(p), cv2.IMREAD_UNCHANGED) for p in sorted((folder / "depth").glob("*.png"))]
        wanted = {bytes((p // 2).astype(np.uint16).tobytes()) for p in pictures}
        assert len(found) >= least, f"{len(found)} frames, expected {least}"
        assert all(p.tobytes() in wanted for p in found), "RealSense: depth differs"
        assert abs(json.loads((folder / "meta.json").read_text())["fx"] - 600) < 1e-3

    python = Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("INSTSONAME")
    module = next(Path(rs.__file__).parent.glob("pyrealsense2*.so"))
    environment = {**os.environ, "VESALIUS_REALSENSE": str(module), "LD_PRELOAD": str(python)}

    def play(path, folder):
        """Has the library play a recording into us, and turns what we record of it into a folder."""
        played = folder.with_suffix(".mcap")
        subprocess.run([vesalius, "record", f"realsense:{path}", "--frames", "10", "--out", played, "-q"], check=True, env=environment)
        return read_back(vesalius, played, folder)

    for lens in colour_lenses:
        path = work / (lens.model.name + suffix)
        film(path, lens)
        read, played = work / f"{lens.model.name}_read", work / f"{lens.model.name}_played"
        read_back(vesalius, path, read)
        expect(read, count)
        expect_colour(read, lens)
        subprocess.run([vesalius, "record", path, "--out", read.with_suffix(".mcap"), "-q"], check=True)
        expect_up(read.with_suffix(".mcap"))
        print("same:", path.name, "of librealsense", version)
        play(path, played)
        expect(played, 10)
        expect_same_pictures(read, played)
        print("same:", path.name, "played by librealsense", version)
    alone = work / ("depth_alone" + suffix)
    film(alone, None)
    play(alone, work / "alone")
    expect(work / "alone", 10)
    print("same: depth alone, played by librealsense", version)
    bent = work / ("bent_depth" + suffix)
    film(bent, None, intrinsics((width, height), 600, rs.distortion.brown_conrady, [-0.2, 0.05, 0, 0, 0]))
    straight = {depth.tobytes() for depth, _ in read_back(vesalius, bent, work / "bent_read")}
    played = {depth.tobytes() for depth, _ in play(bent, work / "bent")}
    assert played and played <= straight, "RealSense: depth behind a lens differs"
    assert not any((picture // 2).astype(np.uint16).tobytes() in played for picture in pictures), "RealSense: its lens stays"
    print("same: depth behind a lens, played by librealsense", version)


def write_rig(path, folder):
    """A ROS 1 bag of two cameras with lenses, an accelerometer and the transforms between them."""
    store = get_typestore(Stores.ROS1_NOETIC)
    if "tf2_msgs/msg/TFMessage" not in store.types:
        store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    types, messages = store.types, Messages(store, True)
    with Writer1(path) as writer:
        connections = {}

        def put(topic, kind, time_ns, message):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], time_ns, messages.bytes(kind, message))

        def vector(x, y, z):
            return types["geometry_msgs/msg/Vector3"](x=x, y=y, z=z)

        def header(time_ns, frame):
            made = messages.header(time_ns)
            made.frame_id = frame
            return made

        turn = types["geometry_msgs/msg/Quaternion"]
        transforms = [types["geometry_msgs/msg/TransformStamped"](
            header=header(FIRST_NS, "rig"), child_frame_id=child,
            transform=types["geometry_msgs/msg/Transform"](translation=vector(x, 0.0, 0.0), rotation=rotation))
            for child, x, rotation in (("depth", 0.0, turn(x=0.0, y=0.0, z=0.0, w=1.0)), ("colour", 0.05, turn(x=0.0, y=0.0, z=0.0, w=1.0)),
                                       ("imu", 0.01, turn(x=0.0, y=0.0, z=0.5**0.5, w=0.5**0.5)))]
        put("/tf_static", "tf2_msgs/msg/TFMessage", FIRST_NS, types["tf2_msgs/msg/TFMessage"](transforms=transforms))
        meta = json.loads((folder / "meta.json").read_text())
        for time_ns, depth, colour in frames(folder):
            for name, model, d in (("depth", "plumb_bob", [-0.1, 0.01, 0, 0, 0]), ("colour", "rational_polynomial", [0.1] + [0] * 7)):
                kind, info = messages.info(time_ns, meta)
                info.header, info.distortion_model, info.D = header(time_ns, name), model, np.array(d, float)
                put(f"/{name}/camera_info", kind, time_ns, info)
            unknown = np.array([-1.0] + [0.0] * 8)
            put("/imu", "sensor_msgs/msg/Imu", time_ns, types["sensor_msgs/msg/Imu"](
                header=header(time_ns, "imu"), orientation=turn(x=0.0, y=0.0, z=0.0, w=1.0), orientation_covariance=unknown,
                angular_velocity=vector(0.0, 0.0, 0.0), angular_velocity_covariance=unknown,
                linear_acceleration=vector(-9.8, 0.0, 0.0), linear_acceleration_covariance=np.zeros(9)))
            for name, picture, encoding in (("colour", colour, "bgr8"), ("depth", depth, "16UC1")):
                kind, image = messages.image(time_ns, picture, encoding)
                image.header = header(time_ns, name)
                put(f"/{name}/image", kind, time_ns, image)


def k4a_camera(purpose, side, intrinsics, turn=np.eye(3), shift=(0, 0, 0)):
    cx, cy, fx, fy = intrinsics
    return {"Intrinsics": {"ModelParameterCount": 14, "ModelType": "CALIBRATION_LensDistortionModelBrownConrady",
                           "ModelParameters": [cx, cy, fx, fy] + [0] * 10},
            "Purpose": f"CALIBRATION_CameraPurpose{purpose}", "MetricRadius": 1.7,
            "Rt": {"Rotation": np.asarray(turn, float).reshape(-1).tolist(), "Translation": list(shift)},
            "SensorWidth": side[0], "SensorHeight": side[1]}


def k4a_calibration():
    """Cameras without distortion in one place: the depth camera's, of narrow mode, and the colour camera's, of 1280x720."""
    return {"CalibrationInformation": {"Cameras": [
        k4a_camera("Depth", (1024, 1024), (0.5, 0.5, 0.49, 0.49)),
        k4a_camera("PhotoVideo", (4096, 3072), (0.5, 0.5, 0.45, 0.6))], "InertialSensors": []}}


def write_mkv(path, pictures, colour_codec, start_ns=5_000_000_000):
    """Has ffmpeg write (depth, colour) as the recorder of Azure Kinects lays it out. ffmpeg states raw codecs in another way, which is
    put right afterwards."""
    with tempfile.TemporaryDirectory() as work:
        work = Path(work)
        (work / "calibration.json").write_text(json.dumps(k4a_calibration()))
        (height, width), (colour_height, colour_width) = pictures[0][0].shape, pictures[0][1].shape[:2]
        (work / "depth").write_bytes(b"".join(depth.astype(">u2").tobytes() for depth, _ in pictures))
        (work / "colour").write_bytes(b"".join(np.ascontiguousarray(colour).tobytes() for _, colour in pictures))
        codec = {"mjpeg": ["-c:v:0", "mjpeg", "-pix_fmt:v:0", "yuvj444p", "-q:v:0", "1"],
                 "yuy2": ["-c:v:0", "rawvideo", "-pix_fmt:v:0", "yuyv422", "-tag:v:0", "YUY2"],
                 "nv12": ["-c:v:0", "rawvideo", "-pix_fmt:v:0", "nv12", "-tag:v:0", "NV12"],
                 "bgra": ["-c:v:0", "rawvideo", "-pix_fmt:v:0", "bgra", "-tag:v:0", "BGRA"]}[colour_codec]
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "bgr24", "-s", f"{colour_width}x{colour_height}", "-r",
                        "25", "-i", work / "colour", "-f", "rawvideo", "-pix_fmt", "gray16be", "-s", f"{width}x{height}", "-r", "25",
                        "-i", work / "depth", "-map", "0", "-map", "1", *codec, "-c:v:1", "rawvideo", "-allow_raw_vfw", "1",
                        "-attach", work / "calibration.json", "-metadata:s:t:0", "mimetype=application/octet-stream",
                        "-metadata:s:t:0", "filename=calibration.json", "-metadata:s:v:0", "title=COLOR",
                        "-metadata:s:v:1", "title=DEPTH", "-metadata", f"K4A_START_OFFSET_NS={start_ns}",
                        "-f", "matroska", path], check=True)
    data = path.read_bytes()
    raw = [(width, height, 16, b"b16g")] + ([(colour_width, colour_height, 32, b"BGRA")] if colour_codec == "bgra" else [])
    for columns, rows, bits, name in raw:
        theirs = struct.pack("<IiiHHI", 40, columns, -rows, 1, bits, 0)
        assert data.count(theirs) == 1, f"ffmpeg states {name} in yet another way"
        data = data.replace(theirs, struct.pack("<IiiHH4s", 40, columns, rows, 1, bits, name))
    path.write_bytes(data)


def matroska(vesalius, folder, work):
    """Frames of FOLDER as an Azure Kinect would record them: the same depth and the same people as of pictures."""
    if not shutil.which("ffmpeg"):
        print("left out: Matroska: no ffmpeg")
        return
    pictures, plain = [], work / "k4a"
    (plain / "depth").mkdir(parents=True)
    for i, (_, depth, colour) in enumerate(frames(folder)):
        wide = np.zeros((576, 640), np.uint16)
        wide[48:528] = cv2.resize(depth, (640, 480), interpolation=cv2.INTER_NEAREST)
        cv2.imwrite(str(plain / "depth" / f"{i}.png"), wide)
        pictures.append((wide, cv2.resize(colour, (1280, 720))))
    focal = 0.49 * 1024
    meta = {"width": 640, "height": 576, "fx": focal, "fy": focal, "cx": 512 - 192 - 0.5, "cy": 512 - 180 - 0.5}
    (plain / "meta.json").write_text(json.dumps(meta))
    for codec in ("mjpeg", "yuy2", "nv12", "bgra"):
        recording, back = work / f"{codec}.mkv", work / f"{codec}_back"
        write_mkv(recording, pictures, codec)
        subprocess.run([vesalius, "convert", recording, back, "--to", "folder", "-q"], check=True)
        found = sorted((back / "depth").glob("*.png"))
        assert [p.stem for p in found] == [f"{5 + i * 40 // 1000}.{i * 40 % 1000:03}000000" for i in range(len(pictures))], codec
        v, u = np.mgrid[:576, :640].astype(np.float32)
        x, y = (u - meta["cx"]) / focal * 0.45 * 1280 + 639.5, (v - meta["cy"]) / focal * 0.6 * 960 + 359.5
        for path, (depth, colour) in zip(found, pictures):
            assert np.array_equal(cv2.imread(str(path), cv2.IMREAD_UNCHANGED), depth), f"{codec}: depth differs"
            wanted = cv2.remap(colour, x, y, cv2.INTER_LINEAR).astype(int)
            wanted[depth == 0] = 0
            seen = cv2.imread(str(back / "rgb" / path.name)).astype(int)
            # Chrominance is halved, and MJPEG loses some of all.
            assert np.abs(seen - wanted).mean() < 3, f"{codec}: colour differs by {np.abs(seen - wanted).mean()}"
        camera = json.loads((back / "meta.json").read_text())
        assert all(abs(camera[key] - meta[key]) < 1e-3 for key in ("fx", "fy", "cx", "cy")), camera
    found = []
    for source in (back, work / "bgra.mkv"):
        text = subprocess.run([vesalius, "detect", source, "--json", "-", "-q"], check=True, capture_output=True, text=True).stdout
        found.append([json.loads(line)["people"] for line in text.splitlines() if "\"people\"" in line])
    assert len(found[0]) == len(pictures) and found[0] == found[1] and any(found[0]), "Matroska: other people"
    print("same: Matroska,", sum(len(people) for people in found[0]), "people")
    whole = (work / "mjpeg.mkv").read_bytes()
    (work / "cut.mkv").write_bytes(whole[: len(whole) * 6 // 10])
    done = subprocess.run([vesalius, "convert", work / "cut.mkv", work / "cut_back", "--to", "folder"], capture_output=True, text=True)
    count = len(list((work / "cut_back" / "depth").glob("*.png")))
    assert done.returncode == 0 and 0 < count < len(pictures), f"{count} frames: {done.stderr}"
    assert done.stderr.count("cut short") == 1, done.stderr
    print("cut short: Matroska,", count, "of", len(pictures))


def write_fixtures(out):
    """Three pictures of 16x12 whose every pixel follows from its place (recording_source_test.cpp); out is fuzz/seeds."""
    out = out / "fuzz_recording"
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work) / "small"
        (folder / "depth").mkdir(parents=True)
        (folder / "rgb").mkdir()
        v, u = np.mgrid[:12, :16]
        for i in range(3):
            depth = np.where(u == v, 0, 1000 + 100 * i + 10 * v + u).astype(np.uint16)
            colour = np.dstack([np.full(u.shape, 7), 20 * v, 10 * u]).astype(np.uint8)
            cv2.imwrite(str(folder / "depth" / f"{i}.png"), depth)
            cv2.imwrite(str(folder / "rgb" / f"{i}.png"), colour)
        meta = {"width": 16, "height": 12, "fx": 14.5, "fy": 15.0, "cx": 7.5, "cy": 5.5}
        (folder / "meta.json").write_text(json.dumps(meta))
        bags = {"plain": (None, "16UC1", "rgb8"), "bz2": (Writer1.CompressionFormat.BZ2, "32FC1", "bgra8"),
                "lz4": (Writer1.CompressionFormat.LZ4, "16UC1 big-endian", "bgr8")}
        for name, how in bags.items():
            (out / f"{name}.bag").unlink(missing_ok=True)
            write_bag(out / f"{name}.bag", folder, *how)
        for name, packed, depth in (("plain", False, "compressedDepth rvl"), ("zstd", True, "compressedDepth png")):
            write_ros2(Path(work) / name, folder, StoragePlugin.SQLITE3, packed, depth, "png")
            shutil.copy(next((Path(work) / name).glob("*.db3*")), out / f"{name}.db3")
        for name, kind, chunked in (("zstd", "ZSTD", True), ("lz4", "LZ4", True), ("loose", "NONE", False)):
            write_mcap(out / f"{name}.mcap", folder, kind, chunked, "16UC1", "rgb8")
        write_foxglove(out / "foxglove.mcap", folder)
        (out / "rig.bag").unlink(missing_ok=True)
        write_rig(out / "rig.bag", folder)


def main():
    if sys.argv[1] == "--fixtures":
        return write_fixtures(Path(sys.argv[2]))
    vesalius, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as work:
        read_theirs(vesalius, folder, Path(work))
        cut_short(vesalius, folder, Path(work))
        give_ours(vesalius, folder, Path(work))
        realsense(vesalius, Path(work))
        seek_in_theirs(vesalius, folder, Path(work))
        matroska(vesalius, folder, Path(work))


if __name__ == "__main__":
    main()
