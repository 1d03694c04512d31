#!/usr/bin/env python3
"""Makes the built-in body (data/builtin_body/) of MakeHuman's files (CC0): the base mesh with a fifth of its vertices, the
bones that poses move, and what sex, age and weight change in the mean of all peoples, muscles and heights.

Usage: make_builtin_body.py DATA OUT, where DATA is the folder `data` of the package (`vesalius assets makehuman`).
The files have MakeHuman's formats, with joints as vertices of their own; lengths are in decimetres.
"""

import heapq
import itertools
import json
import sys
from pathlib import Path

EDGE = 0.222  # longest edge of trunk and limbs that is taken out, decimetres
FINER = {"head": 0.6, "hand": 0.36, "foot": 0.65}  # edges there, as shares of that
BENT = 0.2  # least cosine between a triangle's normals before and after one of its corners moved


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def read_mesh(path):
    points, triangles, group = [], [], ""
    for line in path.read_text().splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            points.append(tuple(float(word) for word in words[1:4]))
        elif words[0] == "g":
            group = words[1]
        elif words[0] == "f" and group == "body":
            corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
            triangles += [(corners[0], corners[k - 1], corners[k]) for k in range(2, len(corners))]
    return points, triangles


def thinned(points, triangles, wanted, middle):
    """Moves vertices onto neighbours, those with the shortest edges for their place first. Half a body goes in; its border,
    the vertices of `middle`, stays one, so that the mirror image closes it."""
    around = [set() for _ in points]  # of each vertex its triangles
    live = dict(enumerate(triangles))
    for number, triangle in live.items():
        for corner in triangle:
            around[corner].add(number)

    def neighbours(v):
        return {corner for number in around[v] for corner in live[number]} - {v}

    def length(a, b):
        d = sub(points[a], points[b])
        return dot(d, d) ** 0.5 / min(wanted[a], wanted[b])

    def bend(gone, to):
        """The least cosine of a turn if `gone` moved onto `to`; -1 if the surface would fold or close upon itself."""
        shared = around[gone] & around[to]
        if len(neighbours(gone) & neighbours(to)) != len(shared) or gone in middle and len(shared) != 1:
            return -1
        least = 1.0
        for number in around[gone] - shared:
            if all(corner in middle or corner == gone for corner in live[number]) and to in middle:
                return -1
            before = [points[corner] for corner in live[number]]
            after = [points[to if corner == gone else corner] for corner in live[number]]
            m, n = (cross(sub(p[1], p[0]), sub(p[2], p[0])) for p in (before, after))
            size = (dot(m, m) * dot(n, n)) ** 0.5
            least = min(least, dot(m, n) / size if size > 1e-12 else -1)
        return least

    queue = [(length(a, b), a, b) for a in range(len(points)) if around[a] for b in neighbours(a) if a < b]
    heapq.heapify(queue)
    while queue:
        size, a, b = heapq.heappop(queue)
        if size > 1 or not around[a] or not around[b] or not around[a] & around[b]:
            continue
        bends = (bend(a, b), bend(b, a))
        if max(bends) < BENT:
            continue
        gone, to = (a, b) if bends[0] >= bends[1] else (b, a)
        for number in sorted(around[gone]):
            if number in around[to]:
                for corner in live[number]:
                    around[corner].discard(number)
                del live[number]
            else:
                live[number] = tuple(to if corner == gone else corner for corner in live[number])
                around[to].add(number)
        around[gone] = set()
        for n in sorted(neighbours(to)):
            heapq.heappush(queue, (length(min(n, to), max(n, to)), min(n, to), max(n, to)))
    return list(live.values())


def mirrored(name):
    return name.replace(".L", ".*").replace(".R", ".L").replace(".*", ".R")


def on_the_left(name):
    return name.replace(".R", ".L")


def place_of(bone):
    """Returns the key in FINER of what a rig bone moves, or an empty text."""
    name = bone.split(".")[0]
    if name.startswith(("finger", "metacarpal", "wrist")):
        return "hand"
    return "foot" if name.startswith(("foot", "toe")) else "head" if name == "head" else ""


def main(data, out):
    points, triangles = read_mesh(data / "3dobjs/base.obj")
    skeleton = json.loads((data / "rigs/default.mhskel").read_text())
    weights = json.loads((data / "rigs/default_weights.mhw").read_text())["weights"]
    bones, joints = skeleton["bones"], skeleton["joints"]

    def kept_bone(bone):  # bones of face and toes move with head and foot
        chain = list(itertools.takewhile(lambda b: b, iterate(lambda b: bones[b]["parent"], bone)))
        for each in ("head", "foot.L", "foot.R"):
            if each in chain:
                return bone if bone.startswith("toe2-") else each
        return chain[1] if bone.startswith("breast") else bone

    skin = {}
    for bone, entries in weights.items():
        for vertex, weight in entries:
            of = skin.setdefault(vertex, {})
            of[kept_bone(bone)] = of.get(kept_bone(bone), 0) + weight
    wanted = [EDGE] * len(points)
    for vertex, of in skin.items():
        wanted[vertex] *= FINER.get(place_of(max(of, key=of.get)), 1)
    left = [triangle for triangle in triangles if all(points[corner][0] > -1e-4 for corner in triangle)]
    middle = {corner for triangle in left for corner in triangle if points[corner][0] < 1e-4}
    left = thinned(points, left, wanted, middle)
    on_left = sorted({corner for triangle in left for corner in triangle})
    twins = {vertex: len(on_left) + k for k, vertex in enumerate(v for v in on_left if v not in middle)}
    number = {vertex: k for k, vertex in enumerate(on_left)}
    triangles = [[number[c] for c in t] for t in left] + [[twins.get(c, number[c]) for c in t[::-1]] for t in left]

    # The mean of all targets that say the same of sex, age and weight, as offsets of vertices and joints.
    kept = {bone: of for bone, of in bones.items() if kept_bone(bone) == bone}
    ends = sorted({of[end] for of in kept.values() for end in ("head", "tail")})
    sources = [[vertex] for vertex in on_left + list(twins)] + [joints[on_the_left(end)] for end in ends]
    count = len(on_left) + len(twins)
    sides = [0 if v in middle else 1 for v in on_left] + [-1] * len(twins)
    sides += [1 if ".L_" in end else -1 if ".R_" in end else 0 for end in ends]
    folder = data / "targets/macrodetails"
    builds = sorted(folder.glob("universal-*.target"))
    peoples = sorted(set(folder.glob("*-*-*.target")) - set(builds))
    shapes = {}

    def placed(offsets):  # of the vertices and joints of both sides; the right ones mirror the left ones
        means = ([sum(offsets[vertex][axis] for vertex in of) / len(of) for axis in range(3)] for of in sources)
        return [[side * p[0], p[1], p[2]] for side, p in zip(sides, means)]

    def mean(paths):
        sums = [[0.0] * 3 for _ in points]
        for path in paths:
            if path not in shapes:
                lines = (line.split() for line in path.read_text().splitlines() if line and line[0] != "#")
                shapes[path] = [(int(words[0]), [float(x) for x in words[1:4]]) for words in lines]
            for vertex, offset in shapes[path]:
                for axis in range(3):
                    sums[vertex][axis] += offset[axis] / len(paths)
        return placed(sums)

    def chosen(paths, *words):
        return [path for path in paths if all(word in path.stem.split("-") for word in words)]

    def whole(sex, age):  # a body of usual weight and muscles
        return plus(mean(chosen(peoples, sex, age)), mean(chosen(builds, sex, age, "averagemuscle", "averageweight")))

    def plus(a, b, sign=1):
        return [[x + sign * y for x, y in zip(p, q)] for p, q in zip(a, b)]

    bodies = {f"{sex}-{age}": whole(sex, age) for sex in ("female", "male") for age in ("child", "young", "old")}
    base = plus(placed(points), bodies["female-young"])
    targets = {name: plus(offsets, bodies["female-young"], -1) for name, offsets in bodies.items() if name != "female-young"}
    usual = mean(chosen(builds, "averagemuscle", "averageweight"))
    for weight in ("minweight", "maxweight"):
        change = plus(mean(chosen(builds, "averagemuscle", weight)), usual, -1)
        targets[weight] = plus(change, change)  # twice: muscles, by which bodies differ too, are left out

    out.mkdir(parents=True, exist_ok=True)

    def text(p):
        return " ".join(f"{x:.3f}".rstrip("0").rstrip(".") if abs(x) >= 5e-4 else "0" for x in p)

    lines = ["# Made of MakeHuman's base mesh (CC0) by tools/make_builtin_body.py", "g body"]
    lines += [f"v {text(p)}" for p in base] + ["f " + " ".join(str(c + 1) for c in t) for t in triangles]
    (out / "base.obj").write_text("\n".join(lines) + "\n")
    for name, offsets in targets.items():
        lines = [f"{k} {text(p)}" for k, p in enumerate(offsets) if max(map(abs, p)) >= 0.002]
        (out / f"{name}.target").write_text("\n".join(lines) + "\n")
    places = {end: [count + k] for k, end in enumerate(ends)}
    rig = {"bones": {bone: {key: of[key] for key in ("head", "tail", "parent")} for bone, of in kept.items()}, "joints": places}
    (out / "rig.mhskel").write_text(json.dumps(rig, separators=(",", ":")).replace("},", "},\n") + "\n")
    rows = {bone: [] for bone in kept}
    for vertex in on_left:
        of = skin[vertex]
        if vertex in middle:
            of = {bone: (of.get(bone, 0) + of.get(mirrored(bone), 0)) / 2 for bone in {*of, *map(mirrored, of)}}
        strongest = sorted(of.items(), key=lambda each: (-each[1], each[0]))[:4]
        total = sum(weight for _, weight in strongest)
        for bone, weight in strongest:
            if weight / total < 0.02:
                continue
            rows[bone].append([number[vertex], round(weight / total, 2)])
            if vertex in twins:
                rows[mirrored(bone)].append([twins[vertex], round(weight / total, 2)])
    text_of_rows = json.dumps({"weights": {bone: row for bone, row in rows.items() if row}}, separators=(",", ":"))
    (out / "weights.mhw").write_text(text_of_rows.replace("]],", "]],\n") + "\n")
    print(f"{count} vertices, {len(triangles)} triangles, {len(kept)} bones, "
          f"{sum(path.stat().st_size for path in out.iterdir())} bytes")


def iterate(step, value):
    while True:
        yield value
        value = step(value)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
