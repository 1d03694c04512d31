"""Tests of the Python package as it is installed.

Usage: test_vesalius.py PROGRAM FRAMES

PROGRAM is `vesalius`, with whose numbers the package's are compared on the frames of a folder that it reads.
"""

import gc
import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

started = time.perf_counter()
import vesalius  # noqa: E402  (its time is measured)

IMPORT_MS = 1000 * (time.perf_counter() - started)

import numpy  # noqa: E402
from PIL import Image  # noqa: E402

PROGRAM, FOLDER = sys.argv.pop(1), Path(sys.argv.pop(1))
# Two libraries may read a JPEG differently: colour is left out where pictures are compared with the program's.
WITHOUT_COLOUR = tempfile.TemporaryDirectory()
shutil.copytree(FOLDER / "depth", Path(WITHOUT_COLOUR.name) / "depth")
shutil.copy(FOLDER / "meta.json", WITHOUT_COLOUR.name)
META = json.loads((FOLDER / "meta.json").read_text())
CAMERA = vesalius.Camera(META["fx"], META["fy"], META["cx"], META["cy"])


def frames():
    for path in sorted((FOLDER / "depth").iterdir()):
        colour = next((FOLDER / "rgb").glob(path.stem + ".*"))
        yield path.stem, numpy.array(Image.open(path)).astype(numpy.uint16), numpy.array(Image.open(colour))


def people_of_program(*flags):
    out = subprocess.run([PROGRAM, "detect", WITHOUT_COLOUR.name, "-q", "--json", "-", *flags], check=True, capture_output=True, text=True)
    return {line["frame"]: line["people"] for line in map(json.loads, out.stdout.splitlines()) if "frame" in line}


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.detector = vesalius.Detector()
        cls.frames = list(frames())

    def expect_joints(self, person, expected):
        for name, mine, confidence, state in zip(self.detector.joint_names(), person.joints(), person.confidences(),
                                                 person.states()):
            theirs = expected["joints"]["k4abt32"][name]
            self.assertEqual(state, theirs["state"])
            if theirs["xyz_m"] is None:
                self.assertTrue(numpy.isnan(mine).all())
            else:
                numpy.testing.assert_allclose(mine, theirs["xyz_m"], atol=1e-4)
                self.assertAlmostEqual(float(confidence), theirs["confidence"], places=3)

    def test_finds_the_people_of_the_program(self):
        expected = people_of_program()
        found = 0
        for name, depth, _ in self.frames:
            people = self.detector.detect(depth, CAMERA)
            self.assertEqual(len(people), len(expected[name]))
            for person, theirs in zip(people, expected[name]):
                self.assertAlmostEqual(person.score, theirs["score"], places=3)
                self.assertEqual(list(person.box), theirs["box_px"])
                self.expect_joints(person, theirs)
                found += 1
            self.assertEqual(people.joints("coco17").shape, (len(people), 17, 3))
            self.assertEqual(people.masks.shape, (len(people), *depth.shape))
            self.assertEqual(people.ids, [None] * len(people))
        self.assertGreater(found, 0)

    def test_follows_as_the_program_does(self):
        expected = people_of_program("--track", "--track.rate", "30")
        tracker = vesalius.Tracker(self.detector)
        for name, depth, _ in self.frames:
            people = tracker.update(depth, CAMERA)
            self.assertEqual([(p.id, p.state) for p in people], [(p["id"], p["state"]) for p in expected[name]])
            for person, theirs in zip(people, expected[name]):
                self.expect_joints(person, theirs)

    def test_takes_metres_as_millimetres(self):
        _, depth, colour = self.frames[0]
        metres = depth.astype(numpy.float32) / 1000
        metres[depth == 0] = numpy.nan
        one, other = self.detector.detect(depth, CAMERA, colour), self.detector.detect(metres, CAMERA, colour)
        numpy.testing.assert_array_equal(one.joints(), other.joints())
        numpy.testing.assert_array_equal(one.masks, other.masks)
        columns = numpy.ascontiguousarray(depth)
        self.assertEqual(len(self.detector.detect(columns, CAMERA)), len(self.detector.detect(depth.copy(), CAMERA)))

    def test_masks_and_labels_outlive_the_people(self):
        _, depth, colour = self.frames[0]
        people = self.detector.detect(depth, CAMERA, colour)
        person = people[-1]
        mask, labels = person.mask, person.labels
        del people, person
        gc.collect()
        self.assertEqual(mask.dtype, numpy.uint8)
        self.assertTrue(((labels != 255) <= (mask == 1)).all())
        self.assertLess(int(labels[labels != 255].max()), len(self.detector.parts))

    def test_says_what_does_not_fit(self):
        _, depth, colour = self.frames[0]
        detect = self.detector.detect
        for why, wrong in {
            "expected dtype uint16": lambda: detect(depth.astype(numpy.int32), CAMERA),
            "expected height x width": lambda: detect(depth[0], CAMERA),
            "colour: an array of shape": lambda: detect(depth, CAMERA, depth),
            "search_minparts is no option": lambda: vesalius.Detector(search_minparts=3),
            "refine.min-score": lambda: vesalius.Detector(refine_min_score=7.0),
            "expected a whole number": lambda: vesalius.Detector(refine_max_candidates=1.5),
            "threads: expected": lambda: vesalius.Detector(threads=-1),
            "expected one of": lambda: detect(depth, CAMERA, colour).joints("body25"),
            "time: expected": lambda: vesalius.Tracker(self.detector).update(depth, CAMERA, time=math.nan),
        }.items():
            with self.assertRaises(ValueError, msg=why) as raised:
                wrong()
            self.assertIn(why, str(raised.exception))
        for wrong in (lambda: vesalius.Detector("/none.forest"), lambda: vesalius.Detector(__file__),
                      lambda: detect(depth, vesalius.Camera(math.nan, 1, 1, 1))):
            with self.assertRaises(vesalius.Error) as raised:
                wrong()
            self.assertEqual(len(str(raised.exception).splitlines()), 1)
        with self.assertRaises(IndexError):
            detect(depth, CAMERA)[99]
        with self.assertRaises(TypeError):
            detect([1, 2, 3], CAMERA)

    def test_gives_the_same_from_ten_threads(self):
        _, depth, colour = self.frames[0]
        expected = self.detector.detect(depth, CAMERA, colour).joints()
        found = [None] * 10

        def work(i):
            found[i] = self.detector.detect(depth, CAMERA, colour).joints()

        threads = [threading.Thread(target=work, args=(i,)) for i in range(10)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for joints in found:
            numpy.testing.assert_array_equal(joints, expected)

    def test_keeps_its_memory(self):
        """VESALIUS_FRAMES frames, 10,000 in .ci/nightly."""
        _, depth, colour = self.frames[0]
        small = numpy.ascontiguousarray(depth[::4, ::4])
        camera = vesalius.Camera(CAMERA.fx / 4, CAMERA.fy / 4, CAMERA.cx / 4, CAMERA.cy / 4)
        count = int(os.environ.get("VESALIUS_FRAMES", 100))

        def most_kb():
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

        for _ in range(20):
            self.detector.detect(small, camera).masks.sum()
        before = most_kb()
        for _ in range(count):
            people = self.detector.detect(small, camera)
            people.masks, people.joints(), [person.labels for person in people]
        self.assertLess(most_kb() - before, 20_000, "kB more than after the first 20")

    def test_is_imported_quickly_and_says_its_options(self):
        self.assertLess(IMPORT_MS, 500, "numpy apart")
        lines = vesalius.options().splitlines()
        self.assertTrue(any(line.startswith("refine_min_score = 0.8: ") for line in lines))
        self.assertTrue(any(line.startswith("track_rate = 30.0") for line in lines))


if __name__ == "__main__":
    print(f"imported in {IMPORT_MS:.0f} ms")
    unittest.main()
