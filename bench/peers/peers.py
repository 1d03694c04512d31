#!/usr/bin/env python3
"""Runs MediaPipe Pose on the colour of the frames that `vesalius evaluate` is measured on, and prints both.

  python3 -m venv peers && peers/bin/pip install --require-hashes -r tools/python/pins/peers.txt
  peers/bin/python bench/peers/peers.py build/release/src/cli/vesalius data/models/default.model real/alina_wave ...

Options: --step N (the first of every N frames), --threads N (of vesalius; MediaPipe takes what it wants), --joints FOLDER (compare
joints on these frames), --csv FILE. README.md beside this file says what is counted. The models are in MediaPipe's wheel.
"""
import argparse
import csv
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from counts import Counts, across_ray_m, markdown  # noqa: E402

LEAST_VISIBLE = 0.5
DEPTH_WINDOW = 2  # pixels to each side of a landmark whose median depth is taken
# Our joint, its joint set, and MediaPipe's landmark.
JOINTS = {"l_shoulder": ("nite15", 11), "r_shoulder": ("nite15", 12), "l_ankle": ("k4abt32", 27), "r_ankle": ("k4abt32", 28)}
NAMES = ("people.found", "people.false", "frames.empty_with_person", "mask.iou_where_found", "ms", "cpu_ms")


def bits(mask):
    """A picture of booleans as a whole number with a bit for each pixel."""
    return int.from_bytes(np.packbits(mask).tobytes(), "big")


def read_set(folder, step):
    """[{name, people}] of a folder of frames, from frames.csv in it or beside it."""
    folder = Path(folder)
    own = folder / "frames.csv"
    table = own if own.is_file() else folder.parent / "frames.csv"
    with open(table, encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if own.is_file() or row["set"] == folder.name]
    frames = [{"name": row["frame"].removesuffix(".png"), "people": int(row["people"])} for row in rows]
    return frames[::step]


def read_mask(folder, frame, people):
    """The true mask as booleans, or None. A blank one of a frame with people was never made."""
    path = Path(folder) / "mask" / (frame + ".png")
    if not path.is_file():
        return None
    mask = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) > 0
    return mask if mask.any() or people == 0 else None


def read_depth(folder, frame):
    return cv2.imread(str(Path(folder) / "depth" / (frame + ".png")), cv2.IMREAD_UNCHANGED)


def read_colour(folder, frame):
    for extension in (".jpg", ".png"):
        path = Path(folder) / "rgb" / (frame + extension)
        if path.is_file():
            return cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB)
    return None


class MediaPipe:
    """MediaPipe Pose, full model. In video mode it carries a person from frame to frame; else each frame is looked at alone."""

    def __init__(self, video):
        import mediapipe
        self.pose = mediapipe.solutions.pose.Pose(static_image_mode=not video, model_complexity=1, enable_segmentation=True)

    def look(self, colour):
        """(landmarks or None, mask or None, wall ms, processor ms) of a picture."""
        wall, cpu = time.perf_counter(), time.process_time()
        result = self.pose.process(colour)
        wall_ms, cpu_ms = 1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - cpu)
        if result.pose_landmarks is None or result.segmentation_mask is None:
            return None, None, wall_ms, cpu_ms
        return result.pose_landmarks.landmark, result.segmentation_mask > 0.5, wall_ms, cpu_ms


def run_mediapipe(folder, frames, pose):
    """Counts over the frames that have colour, and how many have not."""
    counts, without_colour = Counts(), 0
    for frame in frames:
        colour, depth = read_colour(folder, frame["name"]), read_depth(folder, frame["name"])
        if colour is None:
            without_colour += 1
            continue
        _, mask, wall_ms, cpu_ms = pose.look(colour)
        truth = read_mask(folder, frame["name"], frame["people"])
        counts.add(frame["people"], None if truth is None else bits(truth), None if mask is None else bits(mask), bits(depth > 0))
        counts.add_time(wall_ms, cpu_ms)
    return counts.figures(), without_colour


def run(command):
    """What a command prints. Where it fails, it has said why, and that is the end."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    except OSError as error:
        sys.exit(f"{command[0]}: {error.strerror}")
    if done.returncode != 0:
        sys.exit(1)
    return done.stdout


def run_json(command):
    return json.loads(run(command))


def run_vesalius(folder, options, following):
    """The same figures from `vesalius evaluate`, and the times from `vesalius bench`, of single frames or of people who are followed."""
    flags = ["-q", "--model", options.model, *(["--track"] if following else []), "--json", "-"]
    evaluate = [options.program, "evaluate", folder, "--step", str(options.step), *flags]
    measured = run_json(evaluate)["sets"][0]["figures"]
    figures = {}
    for name in ("people.found", "frames.empty_with_person"):
        if name in measured:
            figures[name] = (round(measured[name]["numerator"]), round(measured[name]["denominator"]))
    figures["people.false"] = round(measured["people.false"]["numerator"])
    if "mask.iou_where_found" in measured:
        figures["mask.iou_where_found"] = measured["mask.iou_where_found"]["value"]
    bench = [options.program, "bench", folder, "--threads", str(options.threads), *flags]
    timed = run_json(bench)["runs"][0]
    figures["ms"] = timed["stages"]["detect"]["median_ms"]
    figures["cpu_ms"] = timed["processor_ms_a_frame"]
    return figures


def cell(value):
    if isinstance(value, tuple):
        return f"{value[0]} of {value[1]}" if value[1] else None
    return f"{value:.3g}" if isinstance(value, float) else value


def landmark_depth_m(depth, u, v):
    """The median of the readings around a pixel in metres, or None."""
    around = depth[max(0, v - DEPTH_WINDOW):v + DEPTH_WINDOW + 1, max(0, u - DEPTH_WINDOW):u + DEPTH_WINDOW + 1]
    readings = around[around > 0]
    return float(np.median(readings)) * 1e-3 if readings.size else None


def compare_joints(folder, pose, options):
    """[joint, frames, median cm across the ray, median cm downwards, median cm in 3-D] of the surest person of each frame."""
    rows = {name: [] for name in JOINTS}
    with tempfile.TemporaryDirectory() as scratch:
        lines = os.path.join(scratch, "people.json")
        run([options.program, "detect", folder, "--model", options.model, "--json", lines])
        with open(lines, encoding="utf-8") as file:
            found = [json.loads(line) for line in file]
    for frame in [line for line in found if line.get("people")][::options.step]:
        colour, depth = read_colour(folder, frame["frame"]), read_depth(folder, frame["frame"])
        if colour is None:
            continue
        landmarks, _, _, _ = pose.look(colour)
        if landmarks is None:
            continue
        camera = frame["camera"]
        for name, (joint_set, index) in JOINTS.items():
            joint, landmark = frame["people"][0]["joints"][joint_set][name], landmarks[index]
            at = (landmark.x * camera["width"], landmark.y * camera["height"])
            inside = 0 <= at[0] < camera["width"] and 0 <= at[1] < camera["height"]
            if joint["px"] is None or not inside or landmark.visibility < LEAST_VISIBLE:
                continue
            depth_m = landmark_depth_m(depth, int(at[0]), int(at[1]))
            if depth_m is None:
                continue
            across, down = across_ray_m(joint["px"], at, depth_m, (camera["fx"], camera["fy"]))
            point = ((at[0] - camera["cx"]) * depth_m / camera["fx"], (at[1] - camera["cy"]) * depth_m / camera["fy"], depth_m)
            rows[name].append((100 * across, 100 * down, 100 * float(np.linalg.norm(np.subtract(joint["xyz_m"], point)))))
    table = []
    for name, samples in rows.items():
        medians = [f"{statistics.median(column):.1f}" for column in zip(*samples)] or [None] * 3
        table.append([name, len(samples), *medians])
    return table


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="vesalius")
    parser.add_argument("model", help="trained model")
    parser.add_argument("folders", nargs="*", help="folders of frames with rgb/ and frames.csv")
    parser.add_argument("--step", type=int, default=1)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--joints", metavar="FOLDER")
    parser.add_argument("--csv", metavar="FILE")
    options = parser.parse_args()
    rows, lines = [], []
    for folder in options.folders:
        name = Path(folder).name
        found = {"vesalius": run_vesalius(folder, options, False), "vesalius, following": run_vesalius(folder, options, True)}
        frames = read_set(folder, options.step)
        for who, video in (("MediaPipe Pose", False), ("MediaPipe Pose, video mode", True)):
            figures, without_colour = run_mediapipe(folder, frames, MediaPipe(video))
            if without_colour < len(frames):
                found[who] = figures
        if without_colour:
            print(f"{name}: {without_colour} frames have no colour; MediaPipe's figures are without them", file=sys.stderr)
        for who, figures in found.items():
            rows.append([name, who, *(cell(figures.get(key)) for key in NAMES)])
    header = ["set", "by", "people found", "false", "empty frames with somebody", "mask IoU where found", "ms a frame",
              "processor ms a frame"]
    if rows:
        lines.append(markdown(header, rows))
    if options.joints:
        table = compare_joints(options.joints, MediaPipe(False), options)
        lines.append(markdown(["joint", "frames", "across the ray, cm", "of it downwards, cm", "in 3-D, cm"], table))
    print("\n\n".join(lines))
    if options.csv:
        with open(options.csv, "w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([header, *rows])


if __name__ == "__main__":
    main()
