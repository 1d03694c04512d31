"""What users write, for mypy and pyright to check (test_types.py); nobody runs it. Each line that ends with WRONG must be an error."""

import numpy
from numpy.typing import NDArray

import vesalius

detector = vesalius.Detector(refine_min_score=0.9, threads=1)
tracker = vesalius.Tracker(detector)
names: list[str] = detector.joint_names("k4abt32")
values: dict[str, "float | int | bool | str"] = vesalius.options()
for frame in vesalius.open("recording.mcap", start=1.5):
    people: vesalius.People = tracker.update(frame)
    joints: NDArray[numpy.float32] = people.joints("k4abt32")
    pixels: NDArray[numpy.float64] = people.pixels()
    drawn: NDArray[numpy.uint8] = people.draw(frame)
    if frame.colour is not None:
        drawn = people.draw(frame.colour)
    floor = people.floor
    if floor is not None:
        over_floor: NDArray[numpy.float32] = joints @ floor.up + floor.height
    for event in people.events:
        print(event.id, f"{event.time:.1f}", event.what.upper())
    for index, person in enumerate(people):
        cloud: NDArray[numpy.float32] = person.points(frame)
        print(index, person.id, person.stance.upper(), person.smoothed().shape, cloud.shape)
        print([bone.name for bone in person.bones])

depth: NDArray[numpy.uint16] = numpy.zeros((480, 640), numpy.uint16)
camera = vesalius.Camera(fx=525, fy=525, cx=319.5, cy=239.5)
found = detector.detect(depth, camera)
print(camera.project(found.joints()[..., :3]), found[0].score + 1)

detector.detect(depth)  # WRONG
detector.detect("recording.mcap")  # WRONG
vesalius.Camera(525, 525, "319.5", 239.5)  # WRONG
vesalius.open(3)  # WRONG
found.floor.height  # WRONG
found[0].stature + 1  # WRONG
found.draw(3)  # WRONG
len(found[0].score)  # WRONG
found.skeletons  # WRONG
