#!/usr/bin/env python3
"""libk4abt.so under a client that others wrote (PyPI pykinect-azure), on Microsoft's own libk4a (PyPI pyk4a-bundle).

Has Microsoft's library record the frames of each FOLDER (depth/*.png, rgb/*, meta.json) as an Azure Kinect would: depth alone in narrow mode,
the same with colour, and in wide mode behind a lens. The client plays each recording into the tracker. Its bodies, joints, rotations, ids and index map must be
those of `vesalius detect` on the same file. Then plays VESALIUS_FRAMES frames (300) more, which must need no more memory.

Needs a Python with: tools/python/pins/k4abt.txt

usage: other_side.py VESALIUS LIBK4ABT FOLDER...
"""
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import time
from importlib import metadata
from pathlib import Path

import cv2
import numpy as np

FIRST_USEC, STEP_USEC = 5_000_000, 33_333
SENSOR = 1024  # pixels of a side
FOUND = ("new", "tracked")
# k1 to k6, the centre of distortion, p2 p1: about an Azure Kinect's, but what floats have exactly.
LENS = [0.5625, -0.00390625, -0.000244140625, 0.890625, 0.0625, -0.0009765625, 0.0, 0.0, 0.000244140625, -0.00048828125]
MOST_GROWTH = 24 << 20  # bytes: what allocators keep


def link_libraries(folder, libk4abt):
    """Their libraries under the names that programs look for, in a folder whose path has no k4a but in these."""
    (bundle,) = {Path(str(f.locate())).parent for f in metadata.files("pyk4a-bundle") if f.name.startswith("libk4a-")}
    for name in ("libk4a", "libk4arecord"):
        (folder / f"{name}.so").symlink_to(next(bundle.glob(f"{name}-*")))
    for library in bundle.iterdir():
        (folder / library.name).symlink_to(library)
    (folder / "libk4abt.so").symlink_to(libk4abt)
    # The client loads this before the tracker, whatever it is.
    (folder / "libonnxruntime.so.1.10.0").symlink_to(libk4abt)


def frames(folder):
    for path in sorted((folder / "depth").glob("*.png")):
        colours = list((folder / "rgb").glob(path.stem + ".*"))
        yield cv2.imread(str(path), cv2.IMREAD_UNCHANGED), cv2.imread(str(colours[0])) if colours else None


def in_mode(depth, meta, width, height, scale):
    """A picture in the middle of one of another size, and its focal length and principal point there."""
    depth = cv2.resize(depth, None, fx=scale, fy=scale, interpolation=cv2.INTER_NEAREST)
    left, top = (width - depth.shape[1]) // 2, (height - depth.shape[0]) // 2
    picture = np.zeros((height, width), np.uint16)
    picture[top:top + depth.shape[0], left:left + depth.shape[1]] = depth
    return picture, (round(meta["cx"] * scale) + left + 0.5, round(meta["cy"] * scale) + top + 0.5, meta["fx"] * scale, meta["fy"] * scale)


def sensor_json(purpose, place, side, parameters, lens):
    return {"Intrinsics": {"ModelParameterCount": 14, "ModelParameters": [*parameters, *lens],
                           "ModelType": "CALIBRATION_LensDistortionModelBrownConrady"},
            "Location": f"CALIBRATION_CameraLocation{place}", "Purpose": f"CALIBRATION_CameraPurpose{purpose}", "MetricRadius": 2.0,
            "Rt": {"Rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "Translation": [0, 0, 0]}, "SensorWidth": side[0], "SensorHeight": side[1],
            "Shutter": "CALIBRATION_ShutterTypeUndefined", "ThermalAdjustmentParams": {"Params": [0] * 12}}


def imu_json(kind):
    return {"SensorType": f"CALIBRATION_InertialSensorType_{kind}", "Id": "CALIBRATION_InertialSensorId_LSM6DSM", "ModelTypeMask": 16,
            "BiasTemperatureModel": [0] * 12, "BiasUncertainty": [0] * 3, "MixingMatrixTemperatureModel": [1] * 36, "Noise": [0] * 6,
            "Rt": {"Rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "Translation": [0, 0, 0]}, "SecondOrderScaling": [0] * 9,
            "TemperatureBounds": [5, 60], "TemperatureC": 0}


def calibration_json(depth_parameters, lens):
    cameras = [sensor_json("Depth", "D0", (SENSOR, SENSOR), depth_parameters, lens),
               sensor_json("PhotoVideo", "PV0", (4096, 3072), (0.5, 0.5, 0.45, 0.6), [0] * 10)]
    return json.dumps({"CalibrationInformation": {"Cameras": cameras, "InertialSensors": [imu_json("Gyro"), imu_json("Accelerometer")],
                                                  "Metadata": {}}}).encode()


class Recorder:
    """Microsoft's writer of recordings."""

    def __init__(self, folder):
        self.k4a, self.record = ctypes.CDLL(str(folder / "libk4a.so")), ctypes.CDLL(str(folder / "libk4arecord.so"))
        self.k4a.k4a_image_get_buffer.restype = ctypes.c_void_p

    def image(self, capture, kind, rows, usec, put):
        image = ctypes.c_void_p()
        height, width = rows.shape[:2]
        assert self.k4a.k4a_image_create(kind, width, height, rows.strides[0], ctypes.byref(image)) == 0
        ctypes.memmove(self.k4a.k4a_image_get_buffer(image), np.ascontiguousarray(rows).ctypes.data, rows.nbytes)
        self.k4a.k4a_image_set_device_timestamp_usec(image, ctypes.c_uint64(usec))
        put(capture, image)
        self.k4a.k4a_image_release(image)

    def write(self, path, pictures, mode, calibration):
        from pykinect_azure.k4a import _k4atypes as types
        has_colour = pictures[0][1] is not None
        config = types.k4a_device_configuration_t(color_format=types.K4A_IMAGE_FORMAT_COLOR_BGRA32, depth_mode=mode, camera_fps=2,
                                                  color_resolution=types.K4A_COLOR_RESOLUTION_720P if has_colour else 0)
        recording = ctypes.c_void_p()
        assert self.record.k4a_record_create(str(path).encode(), None, config, ctypes.byref(recording)) == 0
        assert self.record.k4a_record_add_attachment(recording, b"calibration.json", calibration, ctypes.c_size_t(len(calibration))) == 0
        assert self.record.k4a_record_add_tag(recording, b"K4A_CALIBRATION_FILE", b"calibration.json") == 0
        assert self.record.k4a_record_write_header(recording) == 0
        for i, (depth, colour) in enumerate(pictures):
            capture, usec = ctypes.c_void_p(), FIRST_USEC + i * STEP_USEC
            assert self.k4a.k4a_capture_create(ctypes.byref(capture)) == 0
            self.image(capture, types.K4A_IMAGE_FORMAT_DEPTH16, depth, usec, self.k4a.k4a_capture_set_depth_image)
            self.image(capture, types.K4A_IMAGE_FORMAT_IR16, depth, usec, self.k4a.k4a_capture_set_ir_image)
            if has_colour:
                self.image(capture, types.K4A_IMAGE_FORMAT_COLOR_BGRA32, colour, usec, self.k4a.k4a_capture_set_color_image)
            assert self.record.k4a_record_write_capture(recording, capture) == 0
            self.k4a.k4a_capture_release(capture)
        assert self.record.k4a_record_flush(recording) == 0
        self.record.k4a_record_close(recording)


def record_all(recorder, folder, work):
    """Returns recordings with their lenses: (path, camera in pixels, lens)."""
    meta, read = json.loads((folder / "meta.json").read_text()), list(frames(folder))
    made = []
    for name, mode, width, height, corner, side, lens in (("narrow", 2, 640, 576, (192, 180), SENSOR, [0.0] * 10),
                                                          ("colour", 2, 640, 576, (192, 180), SENSOR, [0.0] * 10),
                                                          ("wide", 3, 512, 512, (0, 0), SENSOR // 2, LENS)):
        scale = min(width / meta["width"], 1.0)
        fitted = [in_mode(depth, meta, width, height, scale) for depth, _ in read]
        cx, cy, fx, fy = fitted[0][1]
        colours = [cv2.cvtColor(cv2.resize(colour, (1280, 720)), cv2.COLOR_BGR2BGRA) if name == "colour" and colour is not None else None
                   for _, colour in read]
        if name == "colour" and colours[0] is None:
            continue
        shares = ((cx + corner[0] + 0.5) / side, (cy + corner[1] + 0.5) / side, fx / side, fy / side)
        path = work / f"{folder.name}_{name}.mkv"
        recorder.write(path, list(zip([depth for depth, _ in fitted], colours)), mode, calibration_json(shares, lens))
        made.append((path, (cx, cy, fx, fy), lens))
    return made


def behind_lens(picture, camera, lens):
    """Puts a straightened picture back behind the lens: whoever a camera's pixel shows, by the formula of Brown and Conrady."""
    if not any(lens):
        return picture
    cx, cy, fx, fy = camera
    height, width = picture.shape
    v, u = np.mgrid[:height, :width].astype(np.float64)
    bent_x, bent_y = (u - cx) / fx, (v - cy) / fy
    k1, k2, k3, k4, k5, k6, _, _, p2, p1 = lens

    def bend(x, y):
        r2 = x * x + y * y
        radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
        return x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)

    x, y = bent_x.copy(), bent_y.copy()
    for _ in range(200):
        seen_x, seen_y = bend(x, y)
        x, y = x + bent_x - seen_x, y + bent_y - seen_y
    assert max(np.abs(seen_x - bent_x).max(), np.abs(seen_y - bent_y).max()) < 1e-6
    from_u, from_v = np.rint(x * fx + cx).astype(int), np.rint(y * fy + cy).astype(int)
    inside = (from_u >= 0) & (from_v >= 0) & (from_u < width) & (from_v < height)
    return np.where(inside, picture[from_v.clip(0, height - 1), from_u.clip(0, width - 1)], 255)


def detected(vesalius, recording, out):
    """[(people who were found, index of each for its pixels in the mask, mask)] of each frame."""
    done = subprocess.run([vesalius, "detect", recording, "--json", "-", "--out", out, "--save", "mask", "-q"], check=True,
                          capture_output=True, text=True)
    found = []
    for line in map(json.loads, done.stdout.splitlines()):
        if "people" not in line:
            continue
        mask = cv2.imread(str(out / "mask" / (line["frame"] + ".png")), cv2.IMREAD_UNCHANGED)
        people = [person for person in line["people"] if person["state"] in FOUND]
        renumbered = np.full(256, 255, np.uint8)
        for index, person in enumerate(people):
            renumbered[person["index"]] = index
        found.append((people, renumbered[mask]))
    return found


def expect_body(body, person, where):
    assert body.id == person["id"], f"{where}: id {body.id}, expected {person['id']}"
    rotations = (person.get("body") or {}).get("joint_rotations_xyzw", {}).get("k4abt32", {})
    joints = 0
    for theirs, (name, joint) in zip(body.skeleton.joints, person["joints"]["k4abt32"].items(), strict=True):
        level = theirs.confidence_level
        if joint["state"] == "none":
            assert level == 0, f"{where}: {name} has level {level}"
            continue
        off_mm = np.abs(np.array(list(theirs.position.v)) - 1000 * np.array(joint["xyz_m"])).max()
        assert off_mm < 0.06, f"{where}: {name} is {off_mm} mm off"  # JSON is rounded to a tenth of a millimetre
        assert level == (2 if joint["confidence"] >= 0.5 else 1) or abs(joint["confidence"] - 0.5) < 1e-4, f"{where}: {name} has level {level}"
        joints += 1
        if name in rotations:
            w, x, y, z = theirs.orientation.v
            assert np.abs(np.array([x, y, z, w]) - rotations[name]).max() < 1e-4, f"{where}: {name} is turned otherwise"
    return joints


def play(pykinect, path):
    """The client's loop. Yields (time, bodies, index map, where Microsoft's calibration puts each body's chest in the depth picture)."""
    playback = pykinect.start_playback(str(path))
    tracker = pykinect.start_body_tracker(calibration=playback.get_calibration())
    while True:
        more, capture = playback.update()
        if not more:
            return
        frame = tracker.update(capture=capture)
        has_map, index_map = frame.get_body_index_map_image()
        assert has_map
        segmented, colours = frame.get_segmentation_image()
        assert segmented and colours.shape == (*index_map.shape, 3)
        frame.draw_bodies(colours)
        count = range(frame.get_num_bodies())
        chests = [frame.get_body2d(i).joints[2].get_coordinates() for i in count]
        yield frame.get_device_timestamp_usec(), [frame.get_body(i).handle() for i in count], index_map, chests


def compare(pykinect, vesalius, path, camera, lens, out):
    wanted, bodies, joints, differing, pixels, covered = detected(vesalius, path, out), 0, 0, 0, 0, 0
    played = list(play(pykinect, path))
    assert len(played) == len(wanted), f"{path.name}: {len(played)} frames, expected {len(wanted)}"
    for i, ((usec, found, index_map, chests), (people, mask)) in enumerate(zip(played, wanted)):
        where = f"{path.name}, frame {i}"
        assert usec == FIRST_USEC + i * STEP_USEC, f"{where}: time {usec}"
        assert len(found) == len(people), f"{where}: {len(found)} bodies, expected {len(people)}"
        joints += sum(expect_body(body, person, where) for body, person in zip(found, people))
        inside = lambda u, v: 0 <= u < index_map.shape[1] and 0 <= v < index_map.shape[0]  # whoever leaves may have it outside
        covered += sum(inside(u, v) and index_map[v, u] == index for index, (u, v) in enumerate(chests))
        mask = behind_lens(mask, camera, lens)
        differing, pixels, bodies = differing + (index_map != mask).sum(), pixels + (mask != 255).sum(), bodies + len(found)
        assert any(lens) or np.array_equal(index_map, mask), f"{where}: the index map differs"
    assert bodies > 0 and differing <= 1e-3 * pixels, f"{path.name}: {differing} of {pixels} pixels differ"
    # Joints lie inside of people, so somebody in front may cover one.
    assert covered >= 0.8 * bodies, f"{path.name}: {covered} of {bodies} chests lie on their bodies' pixels"
    print(f"same: {path.name}: {bodies} bodies, {joints} joints, {pixels} pixels, {covered} chests on them in {len(played)} frames", flush=True)


def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


def grow(pykinect, path, count):
    """Plays a recording again and again into one tracker."""
    playback = pykinect.start_playback(str(path))
    tracker = pykinect.start_body_tracker(calibration=playback.get_calibration())
    done, before, start = 0, 0, time.monotonic()
    while done < count:
        more, capture = playback.update()
        if not more:
            playback.seek_timestamp(0)
            continue
        frame = tracker.update(capture=capture)
        frame.get_body_index_map_image()
        done += 1
        if done == count // 3:
            before = resident()
    grown = resident() - before
    print(f"{count} frames, {count / (time.monotonic() - start):.1f} a second; {grown / 2**20:.1f} MiB more after the first third", flush=True)
    assert grown < MOST_GROWTH, f"memory grew by {grown / 2**20:.1f} MiB"


def client(vesalius, libraries, folders):
    ctypes.CDLL(str(next(libraries.glob("libudev*"))), mode=ctypes.RTLD_GLOBAL)
    import pykinect_azure as pykinect
    pykinect.initialize_libraries(str(libraries / "libk4a.so"), str(libraries / "libk4abt.so"), track_body=True)
    with tempfile.TemporaryDirectory(prefix="recordings_") as work:
        recordings = [made for folder in folders for made in record_all(Recorder(libraries), folder, Path(work))]
        for path, camera, lens in recordings:
            compare(pykinect, vesalius, path, camera, lens, Path(work) / path.stem)
        grow(pykinect, recordings[0][0], int(os.environ.get("VESALIUS_FRAMES", "300")))


def main():
    vesalius, libk4abt, *folders = (Path(each).resolve() for each in sys.argv[1:])
    libraries = os.environ.get("OTHER_SIDE_LIBRARIES")
    if libraries:
        return client(vesalius, Path(libraries), folders)
    with tempfile.TemporaryDirectory(prefix="libraries_") as made:
        link_libraries(Path(made), libk4abt)
        # The loader reads this path once, when a program starts.
        return subprocess.run([sys.executable, *sys.argv], env={**os.environ, "LD_LIBRARY_PATH": made, "OTHER_SIDE_LIBRARIES": made, "K4A_LOG_LEVEL": "c"},
                              check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
