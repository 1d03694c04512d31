#!/usr/bin/env python3
"""libNiTE2.so under a client that others wrote (PyPI openni), on Debian's own libOpenNI2 (libopenni2-dev) with a driver that plays pictures.

Has the client read the depth of each FOLDER (depth/*.png, meta.json), as it is and mirrored. Its users, joints, map of users and times must be
those of `vesalius detect`. Then reads VESALIUS_FRAMES frames (300) more, which must need no more memory.

Needs a Python with: tools/python/pins/nite2.txt

usage: other_side.py VESALIUS LIBNITE2 FOLDER...
"""
import importlib.util
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import types
from pathlib import Path

import cv2
import numpy as np

SOURCE = Path(__file__).resolve().parent.parent.parent
RATE_HZ, STEP_USEC = 25.0, 40_000
NAMES = ("head", "neck", "l_shoulder", "r_shoulder", "l_elbow", "r_elbow", "l_hand", "r_hand", "torso", "l_hip", "r_hip", "l_knee", "r_knee",
         "l_foot", "r_foot")
MOST_GROWTH = 24 << 20  # bytes: what allocators keep


def openni_folder():
    for folder in map(Path, ("/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib")):
        if (folder / "libOpenNI2.so").exists():
            return folder
    sys.exit("needs libopenni2-dev")


def make_openni(folder):
    """Debian's library with another driver: it looks for drivers beside itself."""
    shutil.copy(openni_folder() / "libOpenNI2.so", folder / "libOpenNI2.so")
    drivers = folder / "OpenNI2/Drivers"
    drivers.mkdir(parents=True)
    subprocess.run([os.environ.get("CXX", "c++"), "-std=c++20", "-O1", "-fPIC", "-shared", "-I/usr/include/openni2",
                    SOURCE / "tests/nite2/openni_driver.cpp", "-o", drivers / "libVesaliusPictures.so.0"], check=True)


def compile_program(libraries):
    (libraries / "libOpenNI2.so.0").symlink_to("libOpenNI2.so")
    subprocess.run([os.environ.get("CXX", "c++"), "-std=c++11", "-isystem", "/usr/include/openni2", f"-I{SOURCE / 'src/nite2/include'}",
                    SOURCE / "tests/nite2/openni_program.cpp", f"-L{libraries}", "-lNiTE2", "-lOpenNI2", f"-Wl,-rpath,{libraries}",
                    "-Wl,--allow-shlib-undefined", "-o", libraries / "program"], check=True)


def run_program(program, wanted, environment):
    """A program in C++ with OpenNI's own classes, that shuts everything down or nothing."""
    visible = [sum(person["state"] in ("new", "tracked") for person in people) for people, _, _ in wanted]
    expected = "".join(f"{i * STEP_USEC} {visible[i]} {int((ids == people[0]['id']).sum())}\n" for i, (people, ids, _) in enumerate(wanted[:3]))
    for more in ([], ["leave"]):
        said = subprocess.run([program, *more], env=environment, check=True, capture_output=True, text=True).stdout
        assert said == expected, f"{said}, expected {expected}"


def write_pictures(folder, is_mirrored, work):
    """What the driver plays, and the same as a folder for `vesalius detect`: as the camera sees it, whose principal point OpenNI has at half
    the width and height of the picture that it gives."""
    meta = json.loads((folder / "meta.json").read_text())
    depths = [cv2.imread(str(path), cv2.IMREAD_UNCHANGED) for path in sorted((folder / "depth").glob("*.png"))]
    height, width = depths[0].shape
    across, down = (2 * math.atan(side / (2 * meta[f])) for side, f in ((width, "fx"), (height, "fy")))
    played = work / "pictures"
    with played.open("wb") as out:
        out.write(struct.pack("<iiffii", width, height, across, down, is_mirrored, STEP_USEC))
        for depth in depths:
            out.write(np.ascontiguousarray(depth[:, ::-1] if is_mirrored else depth).tobytes())
    same = work / "folder"
    (same / "depth").mkdir(parents=True)
    for i, depth in enumerate(depths):
        cv2.imwrite(str(same / "depth" / f"{i:04}.png"), depth)
    half = width / 2
    (same / "meta.json").write_text(json.dumps({**meta, "cx": width - 1 - half if is_mirrored else half, "cy": height / 2, "rate_hz": RATE_HZ}))
    return played, same, depths


def detected(vesalius, folder, out):
    """[(people, mask of their ids)] of each frame."""
    done = subprocess.run([vesalius, "detect", folder, "--json", "-", "--out", out, "--save", "mask", "-q"], check=True, capture_output=True,
                          text=True)
    found = []
    for line in map(json.loads, done.stdout.splitlines()):
        if "people" not in line:
            continue
        mask = cv2.imread(str(out / "mask" / (line["frame"] + ".png")), cv2.IMREAD_UNCHANGED)
        ids = np.zeros(256, np.int16)
        for person in line["people"]:
            if person.get("index") is not None:
                ids[person["index"]] = person["id"]
        found.append((line["people"], ids[mask], line["floor"]))
    return found


def their_client():
    """Their package. It describes NiTE 2.3.0.16, whose skeletons have a number more than those that NiTE 2.2's headers and programs have."""
    import openni
    spec = importlib.util.find_spec("openni._nite2")
    module = types.ModuleType("openni._nite2")
    source = Path(spec.origin).read_text().replace("    ('internalState', ctypes.c_int),\n", "")
    sys.modules[module.__name__] = openni._nite2 = module
    exec(compile(source, spec.origin, "exec"), module.__dict__)
    from openni import nite2, openni2
    return openni2, nite2


def expect_user(user, person, is_new, side, where):
    state = {"lost": 4, "hidden": 0}.get(person["state"], 1) + (2 if is_new else 0)
    assert user.state == state, f"{where}: state {user.state}, expected {state}"
    if is_new or person["state"] == "lost":
        return 0
    assert user.skeleton.state == 2, f"{where}: the skeleton is in state {user.skeleton.state}"
    known = 0
    for number, name in enumerate(NAMES):
        joint, theirs = person["joints"]["nite15"][name], user.skeleton.joints[number]
        assert theirs.jointType == number
        if joint["state"] == "none":
            assert theirs.positionConfidence == 0, f"{where}: {name}"
            continue
        at = theirs.position
        off_mm = np.abs(np.array([side * at.x, -at.y, at.z]) - 1000 * np.array(joint["xyz_m"])).max()
        assert off_mm < 0.06, f"{where}: {name} is {off_mm} mm off"  # JSON is rounded to a tenth of a millimetre
        assert abs(theirs.positionConfidence - joint["confidence"]) < 1e-3, f"{where}: {name} has {theirs.positionConfidence}"
        known += 1
    return known


def compare(nite2, openni2, tracker, stream, played, wanted, depths, is_mirrored):
    known, users, joints, pixels = set(), 0, 0, 0
    for i, (people, ids, floor) in enumerate(wanted):
        frame, where = tracker.read_frame(), f"{played}, frame {i}"
        assert (frame.timestamp, frame.frameIndex) == (i * STEP_USEC, i + 1), f"{where}: {frame.timestamp} {frame.frameIndex}"
        picture = frame.get_depth_frame()
        seen = np.ctypeslib.as_array(picture.get_buffer_as_uint16()).reshape(ids.shape)
        assert np.array_equal(seen, depths[i][:, ::-1] if is_mirrored else depths[i]), f"{where}: another picture"
        their_map = frame.userMap
        assert their_map.stride == 2 * their_map.width
        of = np.ctypeslib.as_array(their_map.pixels, ids.shape)
        assert np.array_equal(of[:, ::-1] if is_mirrored else of, ids), f"{where}: the map of users differs"
        for person in people:
            user = frame.users_by_id[person["id"]]
            is_new = person["id"] not in known
            joints += expect_user(user, person, is_new, -1 if is_mirrored else 1, f"{where}, user {user.id}")
            if is_new:
                known.add(user.id)
                tracker.start_skeleton_tracking(user.id)
            if person["state"] == "lost":
                known.remove(user.id)
            at = user.skeleton.joints[8].position
            if at.z > 0:
                ours, theirs = tracker.convert_joint_coordinates_to_depth(at.x, at.y, at.z), openni2.convert_world_to_depth(stream, at.x, at.y, at.z)
                assert np.abs(np.array(ours) - np.array(theirs[:2])).max() < 1.0, f"{where}: {ours}, by OpenNI {theirs}"
        gone = known - {person["id"] for person in people}
        assert gone == {user.id for user in frame.users} - {person["id"] for person in people}, f"{where}: {gone} should be lost"
        known -= gone
        assert frame.floorConfidence == (0 if floor is None else 1), f"{where}: floor"
        if floor is not None:
            assert abs(np.hypot(np.hypot(frame.floor.point.x, frame.floor.point.y), frame.floor.point.z) - 1000 * abs(floor["height_m"])) < 1
        users, pixels = users + len(people), pixels + int((ids != 0).sum())
        close(nite2, frame)
    assert users > 0 and joints > 0
    print(f"same{' mirrored' if is_mirrored else ''}: {users} users, {joints} joints, {pixels} pixels in {len(wanted)} frames", flush=True)


def close(nite2, frame):
    """Their wrapper takes a reference besides the one that a frame comes with, and gives one back."""
    nite2.c_api.niteUserTrackerFrameRelease(frame._user_tracker_handle, frame._handle)
    picture = frame._depth_frame
    if picture is not None:
        picture.close()
    frame.close()


def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


def grow(nite2, tracker, count):
    before, start = 0, time.monotonic()
    for done in range(1, count + 1):
        close(nite2, tracker.read_frame())
        if done == count // 3:
            before = resident()
    grown = resident() - before
    print(f"{count} frames, {count / (time.monotonic() - start):.1f} a second; {grown / 2**20:.1f} MiB more after the first third", flush=True)
    assert grown < MOST_GROWTH, f"memory grew by {grown / 2**20:.1f} MiB"


def client(library, folder, is_mirrored, work, count):
    """In a process of its own: OpenNI looks for drivers once."""
    depths = [cv2.imread(str(path), cv2.IMREAD_UNCHANGED) for path in sorted((folder / "depth").glob("*.png"))]
    openni2, nite2 = their_client()
    openni2.initialize(str(library.parent))
    nite2.initialize(str(library.parent))
    print("version", nite2.get_version().major, nite2.get_version().minor)
    device = openni2.Device.open_any()
    stream = device.create_depth_stream()
    tracker = nite2.UserTracker(device)
    wanted = detected(os.environ["VESALIUS"], folder, work / "out")
    compare(nite2, openni2, tracker, stream, folder.parent.name, wanted, depths, is_mirrored)
    if count:
        grow(nite2, tracker, count)
    tracker.close()
    stream.close()
    device.close()
    nite2.unload()
    openni2.unload()


def main():
    if sys.argv[1] == "--client":
        return client(Path(sys.argv[2]), Path(sys.argv[3]), sys.argv[4] == "True", Path(sys.argv[5]), int(sys.argv[6]))
    vesalius, library, *folders = (Path(each).resolve() for each in sys.argv[1:])
    count = int(os.environ.get("VESALIUS_FRAMES", "300"))
    with tempfile.TemporaryDirectory(prefix="nite2_") as made:
        libraries = Path(made) / "libraries"
        libraries.mkdir()
        make_openni(libraries)
        (libraries / "libNiTE2.so").symlink_to(library)
        compile_program(libraries)
        for folder in folders:
            for is_mirrored in (False, True):
                work = Path(made) / f"{folder.name}_{is_mirrored}"
                work.mkdir()
                played, same, _ = write_pictures(folder, is_mirrored, work)
                environment = {**os.environ, "VESALIUS_PICTURES": str(played), "VESALIUS": str(vesalius)}
                subprocess.run([sys.executable, __file__, "--client", libraries / "libNiTE2.so", same, str(is_mirrored), work,
                                str(count if folder == folders[0] and not is_mirrored else 0)], check=True, env=environment)
                run_program(libraries / "program", detected(vesalius, same, work / "again"), environment)
                shutil.rmtree(work)
    return 0


if __name__ == "__main__":
    sys.exit(main())
