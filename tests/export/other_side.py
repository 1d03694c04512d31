#!/usr/bin/env python3
"""Reads what `vesalius export` writes with the tools of others, and compares it with the people that went in.

Usage: other_side.py PROGRAM SOURCE [--blender BLENDER] [--three FOLDER]

SOURCE is what `vesalius detect` reads. CSV by pandas, COCO by pycocotools, glTF by pygltflib, TRC by OpenSim's rules for
the format, Azure Kinect's JSON by its keys, BVH and glTF in Blender where it is given, glTF in three.js where the folder
with it is (web/node_modules). Joints are within 1 mm, those of BVH, whose bones have one length each, within 5 mm in the
median; rotations within 1 degree. The flesh's surface is within 1 mm of what data/bodies/flesh.toml says of the bodies.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import numpy
import pandas
import pygltflib
from pycocotools.coco import COCO
from pygltflib import validator

FLESH = Path(__file__).parent.parent.parent / "data/bodies/flesh.toml"
NAMES = {"pelvis": "Hips", "chest": "Spine1", "head": "Head", "l_forearm": "LeftForeArm", "r_hand": "RightHand",
         "l_shin": "LeftLeg", "r_foot": "RightFoot"}


def expect(condition, what):
    if not condition:
        sys.exit(f"other_side.py: {what}")


def upright(point):
    return numpy.array([point[0], -point[1], -point[2]])


def check_csv(path, frames):
    table = pandas.read_csv(path, dtype={"frame": str})
    rows = [(f, p) for f in frames for p in f["people"]]
    expect(len(table) == len(rows), f"CSV: {len(table)} rows, expected {len(rows)}")
    for (frame, person), (_, row) in zip(rows, table.iterrows()):
        expect(row["frame"] == frame["frame"] and row["person"] == person["id"], "CSV: another frame or person")
        for name, joint in person["joints"]["k4abt32"].items():
            place = [row[f"{name}_{axis}_m"] for axis in "xyz"]
            if joint["xyz_m"] is None:
                expect(all(math.isnan(x) for x in place), f"CSV: {name} has a place")
            else:
                expect(numpy.allclose(place, joint["xyz_m"], atol=1e-3), f"CSV: {name} is elsewhere")
    return len(rows)


def check_trc(path, frames, person_id):
    lines = path.read_text().split("\n")
    head = lines[2].split("\t")
    count, markers = int(head[2]), int(head[3])
    expect(lines[0].startswith("PathFileType\t4\t(X/Y/Z)\t"), "TRC: no header of its kind")
    names = [name for name in lines[3].split("\t")[2:] if name]
    expect(len(names) == markers and head[4] == "mm" and lines[5] == "", "TRC: names, unit or the empty line")
    rows = [line.split("\t") for line in lines[6:] if line]
    expect(len(rows) == count and [int(row[0]) for row in rows] == list(range(1, count + 1)), "TRC: rows")
    first = next(i for i, f in enumerate(frames) if any(p["id"] == person_id for p in f["people"]))
    for row, frame in zip(rows, frames[first:]):
        expect(len(row) == 2 + 3 * markers, "TRC: fields of a row")
        person = next((p for p in frame["people"] if p["id"] == person_id), None)
        for i, name in enumerate(names):
            place = row[2 + 3 * i : 5 + 3 * i]
            joint = person["joints"]["k4abt32"][name] if person else {"xyz_m": None}
            if joint["xyz_m"] is None:
                expect(place == ["", "", ""], f"TRC: {name} has a place")
            else:
                expect(numpy.allclose([float(x) for x in place], 1000 * upright(joint["xyz_m"]), atol=1), f"TRC: {name}")
    return count


def check_coco(path, frames):
    coco = COCO(str(path))
    expect(len(coco.getImgIds()) == len(frames), "COCO: images")
    names = coco.loadCats(1)[0]["keypoints"]
    seen = 0
    for number, frame in enumerate(frames, 1):
        found = coco.loadAnns(coco.getAnnIds(imgIds=number))
        expect(len(found) == len(frame["people"]), "COCO: annotations of an image")
        for annotation, person in zip(found, frame["people"]):
            for i, name in enumerate(names):
                u, v, visible = annotation["keypoints"][3 * i : 3 * i + 3]
                joint = person["joints"]["coco17"][name]
                expect((visible == 2) == (joint["state"] == "observed" and joint["px"] is not None), f"COCO: {name}")
                expect(not visible or numpy.allclose([u, v], joint["px"], atol=0.1), f"COCO: {name} is elsewhere")
            seen += 1
    return seen


def check_k4abt(path, frames):
    data = json.loads(path.read_text())
    for key in ("k4abt_sdk_version", "source_file", "joint_names", "bone_list", "frames"):
        expect(key in data, f"k4abt: no {key}")
    expect(len(data["joint_names"]) == 32 and data["joint_names"][0] == "PELVIS", "k4abt: names of joints")
    for mine, frame in zip(data["frames"], frames, strict=True):
        expect(mine["num_bodies"] == len(mine["bodies"]) == len(frame["people"]), "k4abt: bodies")
        for body, person in zip(mine["bodies"], frame["people"]):
            for place, turn, (name, joint) in zip(body["joint_positions"], body["joint_orientations"],
                                                  person["joints"]["k4abt32"].items(), strict=True):
                if joint["xyz_m"] is not None:
                    expect(numpy.allclose(place, numpy.array(joint["xyz_m"]) * 1000, atol=1), f"k4abt: {name}")
                expect(abs(numpy.linalg.norm(turn) - 1) < 1e-3, f"k4abt: orientation of {name}")
                theirs = person["body"]["joint_rotations_xyzw"]["k4abt32"].get(name) if "body" in person else None
                if theirs:
                    dot = abs(numpy.dot(turn, [theirs[3], *theirs[:3]])) / numpy.linalg.norm(theirs) / numpy.linalg.norm(turn)
                    expect(2 * math.degrees(math.acos(min(1, dot))) < 1, f"k4abt: {name} is turned otherwise")
    return len(data["frames"])


def matrix(quaternion):
    x, y, z, w = quaternion
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def bodies_of(frames, person_id):
    """The person's bodies from the first frame with one to the last; None between where there is none."""
    all_of = [next((p["body"] for p in f["people"] if p["id"] == person_id and p.get("body")), None) for f in frames]
    known = [i for i, body in enumerate(all_of) if body]
    return all_of[known[0] : known[-1] + 1]


def compare_bones(what, places, frames, person_id, within_mm):
    """`places`: name -> metres in every frame, y up."""
    apart = []
    for i, body in enumerate(bodies_of(frames, person_id)):
        for bone, name in NAMES.items():
            if body:
                apart.append(1000 * numpy.linalg.norm(places[name][i] - upright(body["bones"][bone]["head_m"])))
    expect(numpy.median(apart) < within_mm, f"{what}: bones are {numpy.median(apart):.1f} mm from where they were")
    return f"{numpy.median(apart):.2f} mm in the median, {numpy.percentile(apart, 95):.1f} in 95 of 100, of {len(apart)}"


def flesh_of():
    """The bones of the population's flesh, right ones too: name -> axis, stations, mean, shapes."""
    bones = {}
    for bone in tomllib.loads(FLESH.read_text())["bone"]:
        axis = "xyz".index(bone["axis"])
        numbers = numpy.array([bone["mean"], *bone["shapes"]])
        bones[bone["name"]] = axis, bone["stations"], numbers
        if bone["name"].startswith("l_"):
            other = numbers.copy()
            other[:, [0, 3] if axis == 0 else [0, 3, 6, 10, 14]] *= -1
            bones["r_" + bone["name"][2:]] = axis, bone["stations"], other
    return bones


def surface_of(body, flesh):
    """Points of a body's flesh, y up: of each bone three ellipses."""
    points = []
    angles = 2 * math.pi * numpy.arange(14) / 14
    for name, bone in body["bones"].items():
        axis, stations, numbers = flesh[name]
        numbers = numbers[0] + numpy.array(body["shape"]) @ numbers[1:]
        first, second = [a for a in range(3) if a != axis]
        for i, station in enumerate(stations):
            u, v, half_u, half_v = numbers[6 + 4 * i : 10 + 4 * i]
            ring = numpy.zeros((14, 3))
            ring[:, axis] = station * numbers[3 + axis]
            ring[:, first] = u + half_u * numpy.cos(angles)
            ring[:, second] = v + half_v * numpy.sin(angles)
            points.append(numpy.array(bone["head_m"]) + ring @ matrix(bone["global_xyzw"]).T)
    return numpy.concatenate(points) * [1, -1, -1]


def sampled(frames, person_id):
    """Places in bodies_of of some bodies, the first among them, as bodies change most at first."""
    bodies = bodies_of(frames, person_id)
    return [i for i in sorted({0, 1, 2, 5, *range(0, len(bodies), 12)}) if i < len(bodies) and bodies[i]]


def compare_surface(what, vertices, frames, person_id):
    """`vertices`: of each sampled frame all points of the mesh, metres, y up."""
    bodies, flesh, worst = bodies_of(frames, person_id), flesh_of(), 0
    for i, mesh in zip(sampled(frames, person_id), vertices, strict=True):
        expected = surface_of(bodies[i], flesh)
        apart = [numpy.linalg.norm(numpy.asarray(mesh) - point, axis=1).min() for point in expected]
        worst = max(worst, 1000 * max(apart))
    expect(worst < 1, f"{what}: the surface is {worst:.1f} mm from where it was")
    return f"surface at most {worst:.2f} mm from where it was, in {len(vertices)} frames"


def check_glb(path, frames, person_id):
    gltf = pygltflib.GLTF2().load(str(path))
    validator.validate(gltf)  # throws what it finds
    blob = gltf.binary_blob()

    def values(index):
        accessor = gltf.accessors[index]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor.type]
        begin = gltf.bufferViews[accessor.bufferView].byteOffset or 0
        return numpy.frombuffer(blob, numpy.float32, accessor.count * width, begin).reshape(-1, width)

    tracks = {}
    for channel in gltf.animations[0].channels:
        tracks[channel.target.node, channel.target.path] = values(gltf.animations[0].samplers[channel.sampler].output)
    places = {}

    def walk(node, above, at):
        turn = [m @ matrix(q) for m, q in zip(above, tracks[node, "rotation"])]
        places[gltf.nodes[node].name.split(":")[-1]] = at
        for child in gltf.nodes[node].children or []:
            walk(child, turn, [p + m @ offset for p, m, offset in zip(at, turn, tracks[child, "translation"])])

    root = gltf.scenes[0].nodes[0]
    count = len(tracks[root, "rotation"])
    walk(root, [numpy.eye(3)] * count, list(tracks[root, "translation"]))
    return compare_bones("glTF", places, frames, person_id, 1)


IN_BLENDER = """
import bpy, builtins, json, sys
plain_open = builtins.open  # Debian 12's Blender opens BVH with a mode that its Python has no more
builtins.open = lambda file, mode="r", *more, **options: plain_open(file, mode.replace("U", ""), *more, **options)
path, times, out = sys.argv[-3:]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
is_bvh = path.endswith(".bvh")
if is_bvh:
    bpy.ops.import_anim.bvh(filepath=path, global_scale=0.01, axis_forward="-Z", axis_up="Y", rotate_mode="QUATERNION",
                            update_scene_duration=True)
else:
    bpy.ops.import_scene.gltf(filepath=path, import_shading="SMOOTH")  # the other shadings want NumPy before 1.24
armature = next((o for o in bpy.data.objects if o.type == "ARMATURE"), None)
mesh = next((o for o in bpy.data.objects if o.type == "MESH" and o.find_armature() == armature), None)
frames = range(int(scene.frame_start), int(scene.frame_end) + 1)
if not is_bvh:
    frames = [t * scene.render.fps / scene.render.fps_base for t in json.loads(times)]
found = {"bones": {}, "vertices": []}
for frame in frames:
    scene.frame_set(int(frame), subframe=frame % 1)
    for bone in armature.pose.bones:
        x, y, z = armature.matrix_world @ bone.head
        found["bones"].setdefault(bone.name, []).append([x, z, -y])
    if mesh:
        shown = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
        places = [shown.matrix_world @ v.co for v in shown.to_mesh().vertices]
        found["vertices"].append([[x, z, -y] for x, y, z in places])
        shown.to_mesh_clear()
json.dump(found, open(out, "w"))
"""


def blender_finds(blender, path, times_s, folder):
    script, out = folder / "read.py", folder / f"{path.name}.json"
    script.write_text(IN_BLENDER)
    done = subprocess.run([blender, "--background", "--python", str(script), "--", str(path), json.dumps(times_s), str(out)],
                          capture_output=True, text=True)
    expect(out.exists(), f"Blender: {done.stdout[-500:]} {done.stderr[-500:]}")
    return json.loads(out.read_text())


def three_finds(modules, path, times_s, folder):
    out = folder / "three.json"
    subprocess.run(["node", str(Path(__file__).parent / "three.mjs"), modules, str(path), json.dumps(times_s), str(out)],
                   check=True)
    return json.loads(out.read_text())


def sampled_times(frames, person_id):
    """Times of the sampled frames, from the person's first body on."""
    times = [f["track_time_s"] for f in frames if any(p["id"] == person_id and p.get("body") for p in f["people"])]
    bodies = bodies_of(frames, person_id)
    first = next(i for i, f in enumerate(frames) if f["track_time_s"] == times[0])
    return [frames[first + i]["track_time_s"] - times[0] for i in sampled(frames, person_id) if bodies[i]]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("source")
    parser.add_argument("--blender")
    parser.add_argument("--three")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        people = folder / "people.jsonl"

        def run(*words):
            subprocess.run([str(arguments.program), *map(str, words)], check=True, capture_output=True)

        run("detect", arguments.source, "--track", "--json", people, "-q")
        lines = [json.loads(line) for line in people.read_text().splitlines()]
        frames = [line for line in lines if "frame" in line]
        ids = [p["id"] for f in frames for p in f["people"] if p.get("body")]
        expect(ids, "nobody has a body")
        person_id = max(set(ids), key=ids.count)
        for name, more in (("p.csv", []), ("p.trc", ["--person", person_id]), ("p.bvh", ["--person", person_id]),
                           ("p.glb", ["--person", person_id]), ("coco.json", ["--format", "coco"]),
                           ("k4abt.json", ["--format", "k4abt"])):
            run("export", people, "--to", folder / name, "--frame", "camera", *more)
        print("CSV:", check_csv(folder / "p.csv", frames), "rows")
        print("TRC:", check_trc(folder / "p.trc", frames, person_id), "rows")
        print("COCO:", check_coco(folder / "coco.json", frames), "people")
        print("k4abt:", check_k4abt(folder / "k4abt.json", frames), "frames")
        print("glTF:", check_glb(folder / "p.glb", frames, person_id))
        times_s = sampled_times(frames, person_id)
        if arguments.blender:
            found = blender_finds(arguments.blender, folder / "p.bvh", [], folder)
            print("BVH in Blender:", compare_bones("BVH in Blender", found["bones"], frames, person_id, 5))
            found = blender_finds(arguments.blender, folder / "p.glb", times_s, folder)
            print("glTF in Blender:", compare_surface("glTF in Blender", found["vertices"], frames, person_id))
        if arguments.three:
            found = three_finds(arguments.three, folder / "p.glb", times_s, folder)
            print("glTF in three.js:", compare_surface("glTF in three.js", found, frames, person_id))
    return 0


if __name__ == "__main__":
    sys.exit(main())
