#!/usr/bin/env python3
"""Has `vesalius ros2 --record` write the messages of a clip, and reads them with rosbags: its own definitions of the types,
and values that must be those of `vesalius detect --track`.

Needs a Python with: rosbags numpy

usage: other_side.py VESALIUS CLIP
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

NOBODY = 255


def fail(text):
    sys.exit(f"other_side.py: {text}")


def expect(found, expected, what):
    if found != expected:
        fail(f"{what}: {str(found)[:300]}, expected {str(expected)[:300]}")


def read(path):
    """Messages by topic and time, and the types of the topics. Types that rosbags knows are read as it defines them."""
    messages, types = {}, {}
    store = get_typestore(Stores.ROS2_JAZZY)
    with AnyReader([path]) as reader:
        for connection, time_ns, raw in reader.messages():
            typed = store if connection.msgtype in store.fielddefs else reader
            message = (typed.deserialize_cdr if typed is store else typed.deserialize)(raw, connection.msgtype)
            messages.setdefault(connection.topic, []).append((time_ns, message))
            types[connection.topic] = connection.msgtype
    return messages, types


def at(messages, topic, time_ns):
    found = [m for t, m in messages.get(topic, []) if t == time_ns]
    return found[0] if found else None


def pictures(messages, time_ns):
    made = []
    for topic in ("/vesalius/body_index", "/vesalius/labels"):
        image = at(messages, topic, time_ns)
        expect([image.encoding, image.step], ["mono8", image.width], topic)
        made.append(image.data.reshape(image.height, image.width))
    return made


def check_cloud(messages, time_ns, index, labels, ids):
    cloud = at(messages, "/vesalius/points", time_ns)
    kinds = {7: "<f4", 6: "<u4"}
    kind = np.dtype({"names": [f.name for f in cloud.fields], "formats": [kinds[f.datatype] for f in cloud.fields],
                     "offsets": [f.offset for f in cloud.fields], "itemsize": cloud.point_step})
    points = cloud.data.view(kind)
    expect(len(points), cloud.width * cloud.height, "points")
    info = at(messages, "/vesalius/camera_info", time_ns)
    fx, cx, fy, cy = info.k[0], info.k[2], info.k[4], info.k[5]
    depth = at(messages, "/vesalius/depth/image_rect", time_ns)
    depth = depth.data.view("<u2").reshape(depth.height, depth.width)
    expect(len(points), int(((index != NOBODY) & (depth > 0)).sum()), "points of people")
    if len(points) == 0:
        return
    u = np.rint(points["x"] / points["z"] * fx + cx).astype(int)
    v = np.rint(points["y"] / points["z"] * fy + cy).astype(int)
    expect(bool((labels[v, u] == points["label"]).all()), True, "labels of points")
    expect(bool((np.array(ids)[index[v, u]] == points["body"]).all()), True, "bodies of points")
    expect(bool((np.abs(depth[v, u] - 1000 * points["z"]) < 0.01).all()), True, "depth of points")


def check_frames(messages, time_ns, people):
    tf = {}
    for message in [at(messages, "/tf", time_ns)]:
        for one in message.transforms if message else []:
            t, q = one.transform.translation, one.transform.rotation
            tf[one.child_frame_id] = (one.header.frame_id, np.array([t.x, t.y, t.z]), np.array([q.x, q.y, q.z, q.w]))
    joints = 0
    for person in people:
        name = f"p{person['id']}"
        parent, origin, q = tf[f"body_{name}"]
        expect(parent, "camera_optical_frame", "parent of the body")
        x, y, z, w = q
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        for joint, of in person["smoothed"]["k4abt32"].items():
            link = f"{joint}_{name}"
            if of["xyz_m"] is None or link not in tf:
                continue
            there = turn @ tf[link][1] + origin
            expect(bool(np.abs(there - of["xyz_m"]).max() < 1e-3), True, f"{link} at {there}, {of['xyz_m']} in JSON")
            joints += 1
    return joints


def main():
    program, clip = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / name for name in ("one.mcap", "two.mcap")]
        for domain, path in enumerate(files, 1):
            subprocess.run([program, "ros2", clip, "--every-frame", "--record", path, "--localhost", "--domain", str(domain),
                            "--camera-pose", "base_link,0.1,0,1.2,0,0,0", "-q"], check=True)
        expect(files[0].read_bytes() == files[1].read_bytes(), True, "the same bytes from the same frames")
        lines = subprocess.run([program, "detect", clip, "--track", "--json", "-", "-q"], check=True, capture_output=True,
                               text=True).stdout.splitlines()
        frames = [f for f in map(json.loads, lines) if "frame" in f]
        messages, types = read(files[0])
        names = {json.loads(m.data)["frame"]: t for t, m in messages["/vesalius/people"]}
        expect(len(names), len(frames), "frames")
        joints = people = 0
        for frame in frames:
            time_ns = names[frame["frame"]]
            there = json.loads(at(messages, "/vesalius/people", time_ns).data)
            expect(there["people"], frame["people"], "people as JSON")
            followed = [p for p in frame["people"] if p["state"] != "lost"]
            listed = at(messages, "/humans/bodies/tracked", time_ns)
            expect(list(listed.ids), [f"p{p['id']}" for p in followed], "bodies")
            expect(listed.header.stamp.sec * 10**9 + listed.header.stamp.nanosec, time_ns, "stamp")
            index, labels = pictures(messages, time_ns)
            check_cloud(messages, time_ns, index, labels, [p["id"] for p in followed])
            joints += check_frames(messages, time_ns, followed)
            people += len(followed)
            for place, person in enumerate(followed):
                roi = at(messages, f"/humans/bodies/p{person['id']}/roi", time_ns)
                if roi is None:
                    continue
                v, u = np.nonzero(index == place)
                box = [u.min() / index.shape[1], v.min() / index.shape[0], (u.max() + 1) / index.shape[1],
                       (v.max() + 1) / index.shape[0]]
                expect(bool(np.allclose([roi.xmin, roi.ymin, roi.xmax, roi.ymax], box, atol=1e-6)), True, "box")
                skeleton = at(messages, f"/humans/bodies/p{person['id']}/skeleton2d", time_ns).skeleton
                expect(len(skeleton), 18, "joints of a skeleton")
        pose = messages["/tf_static"][0][1].transforms[0]
        expect([pose.header.frame_id, pose.child_frame_id, pose.transform.translation.z],
               ["base_link", "camera_optical_frame", 1.2], "camera")
        if people == 0 or joints == 0:
            fail("nobody was followed")
        print(f"rosbags reads {sum(map(len, messages.values()))} messages of {len(types)} topics and "
              f"{len(set(types.values()))} types: {len(frames)} frames, {people} people, {joints} joints as in the JSON")


if __name__ == "__main__":
    main()
