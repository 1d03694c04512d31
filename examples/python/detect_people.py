"""Finds the people in every frame of a source: usage: detect_people.py SOURCE"""

import sys

import vesalius

detector = vesalius.Detector()
for frame in vesalius.open(sys.argv[1]):
    for person in detector.detect(frame):
        head = dict(zip(detector.joint_names("coco17"), person.joints("coco17")))["nose"]
        print(f"{frame.name}: score {person.score:.2f}, box {person.box}, nose at {head.round(2)} m")
