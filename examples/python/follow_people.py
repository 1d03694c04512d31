"""Follows people over time and keeps where they went: usage: follow_people.py SOURCE OUT.npz

OUT.npz has, for every person with an id, `times_ID` (n,) seconds and `joints_ID` (n, 32, 3) metres.
"""

import sys
from collections import defaultdict

import numpy

import vesalius

source, out = sys.argv[1:]
tracker = vesalius.Tracker(vesalius.Detector())
times, joints = defaultdict(list), defaultdict(list)
for number, frame in enumerate(vesalius.open(source)):
    for person in tracker.update(frame):
        if person.state in ("new", "tracked"):
            times[person.id].append(number / 30 if frame.time is None else frame.time)
            joints[person.id].append(person.joints("k4abt32"))
numpy.savez(out, **{f"times_{who}": numpy.array(seen) for who, seen in times.items()},
            **{f"joints_{who}": numpy.array(seen) for who, seen in joints.items()})
for who, seen in times.items():
    print(f"person {who}: {len(seen)} frames, {seen[-1] - seen[0]:.1f} s")
