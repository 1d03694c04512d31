#!/usr/bin/env python3
"""Reads what `vesalius export` writes with the tools of others, and compares it with the people that went in.

Usage: other_side.py PROGRAM SOURCE [--blender BLENDER]

SOURCE is what `vesalius detect` reads. CSV by pandas, COCO by pycocotools, glTF by pygltflib, TRC by OpenSim's rules for
the format, Azure Kinect's JSON by its keys, BVH in Blender where it is given. Joints are within 1 mm, those of BVH, whose
bones have one length each, within 5 mm in the median; rotations within 1 degree.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
import pandas
import pygltflib
from pycocotools.coco import COCO
from pygltflib import validator

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


def check_glb(path, frames, person_id):
    gltf = pygltflib.GLTF2().load(str(path))
    validator.validate(gltf)  # throws what it finds
    blob = gltf.binary_blob()

    def values(index, width):
        accessor = gltf.accessors[index]
        begin = gltf.bufferViews[accessor.bufferView].byteOffset or 0
        return numpy.frombuffer(blob, numpy.float32, accessor.count * width, begin).reshape(-1, width)

    tracks = {}
    for channel in gltf.animations[0].channels:
        output = gltf.animations[0].samplers[channel.sampler].output
        tracks[channel.target.node, channel.target.path] = values(output, 4 if channel.target.path == "rotation" else 3)
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


BLENDER = """
import bpy, builtins, json, sys
plain_open = builtins.open  # Debian 12's Blender opens BVH with a mode that its Python has no more
builtins.open = lambda file, mode="r", *more, **options: plain_open(file, mode.replace("U", ""), *more, **options)
path, out = sys.argv[-2:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_anim.bvh(filepath=path, global_scale=0.01, axis_forward="-Z", axis_up="Y", rotate_mode="QUATERNION",
                        update_scene_duration=True)
armature = next((o for o in bpy.data.objects if o.type == "ARMATURE"), None)
places = {}
first, last = bpy.context.scene.frame_start, bpy.context.scene.frame_end
for frame in range(int(first), int(last) + 1):
    bpy.context.scene.frame_set(frame)
    for bone in armature.pose.bones:
        x, y, z = armature.matrix_world @ bone.head
        places.setdefault(bone.name, []).append([x, z, -y])
json.dump(places, open(out, "w"))
"""


def check_in_blender(blender, path, frames, person_id, folder):
    script, out = folder / "read.py", folder / "places.json"
    script.write_text(BLENDER)
    done = subprocess.run([blender, "--background", "--python", str(script), "--", str(path), str(out)],
                          capture_output=True, text=True)
    expect(out.exists(), f"Blender: {done.stdout[-500:]} {done.stderr[-500:]}")
    places = {name: [numpy.array(p) for p in all_of] for name, all_of in json.loads(out.read_text()).items()}
    return compare_bones("BVH in Blender", places, frames, person_id, 5)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("source")
    parser.add_argument("--blender")
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
        if arguments.blender:
            print("BVH in Blender:", check_in_blender(arguments.blender, folder / "p.bvh", frames, person_id, folder))
    return 0


if __name__ == "__main__":
    sys.exit(main())
