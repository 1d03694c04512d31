"""Tests of the Python package as it is installed.

Usage: test_vesalius.py PROGRAM FRAMES

PROGRAM is `vesalius`, with whose numbers the package's are compared on the frames of a folder that it reads.
"""

import base64
import gc
import io
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
from xml.etree import ElementTree

started = time.perf_counter()
import vesalius  # noqa: E402  (its time is measured)

IMPORT_MS = 1000 * (time.perf_counter() - started)

import numpy  # noqa: E402
from PIL import Image  # noqa: E402

# Imports the package in each kind of subinterpreter that this Python has, and prints what each says; the main one works on.
SUBINTERPRETERS = """
import sys, tempfile
import vesalius
try:
    import _interpreters as interpreters
    kinds = [interpreters.new_config(kind) for kind in ("legacy", "isolated")]
    create = interpreters.create
except ImportError:
    import _xxsubinterpreters as interpreters
    kinds = [False, True]
    create = lambda isolated: interpreters.create(isolated=isolated)

def find_people():
    frames = list(vesalius.open(sys.argv[1]))
    try:
        vesalius.open(sys.argv[1] + "/none")
        sys.exit("a source that is missing was opened")
    except vesalius.Error:
        return [len(vesalius.Detector(threads=1).detect(frame)) for frame in frames[:1]]

people = find_people()
for kind in kinds:
    other = create(kind)
    with tempfile.NamedTemporaryFile() as said:
        interpreters.run_string(other, f'''
import sys
sys.path[:0] = {sys.path!r}
try:
    import vesalius
    said = "imported"
except ImportError as error:
    said = str(error)
with open({said.name!r}, "w") as file:
    file.write(said)
''')
        assert people == find_people()
        interpreters.destroy(other)
        assert people == find_people()
        print(open(said.name).read())
"""

PROGRAM, FOLDER = sys.argv.pop(1), Path(sys.argv.pop(1))
DEMO = FOLDER.parent / "demo"
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


def lines_of_program(source, *flags):
    out = subprocess.run([PROGRAM, "detect", str(source), "-q", "--json", "-", *flags], check=True, capture_output=True, text=True)
    return {line["frame"]: line for line in map(json.loads, out.stdout.splitlines()) if "frame" in line}


def people_of_program(*flags):
    return {frame: line["people"] for frame, line in lines_of_program(WITHOUT_COLOUR.name, *flags).items()}


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.detector = vesalius.Detector()
        cls.frames = list(frames())

    def test_has_the_programs_version(self):
        said = subprocess.run([PROGRAM, "--version"], check=True, capture_output=True, text=True).stdout
        self.assertEqual(said, f"vesalius {vesalius.__version__}\n")

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
        joints = expected["joints"]["k4abt32"].values()
        self.assertEqual(person.unseen(), [joint.get("unseen") for joint in joints])
        self.assertEqual(person.behind(), [joint.get("behind") for joint in joints])

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

    def test_opens_what_the_program_opens(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = Path(folder) / "demo.mcap"
            subprocess.run([PROGRAM, "record", str(FOLDER), "--out", str(recording), "-q"], check=True)
            for source in (FOLDER, str(recording)):
                expected = lines_of_program(source, "--no-track")
                opened = vesalius.open(source)
                names = []
                for frame in opened:
                    people = self.detector.detect(frame)
                    self.assertEqual(json.loads(people.json()), expected[frame.name])
                    names.append(frame.name)
                self.assertEqual(names, list(expected))
                self.assertIsNone(next(opened, None))
                self.assertFalse(opened.is_live)
        self.assertEqual(vesalius.open(FOLDER).size, len(self.frames))

    def test_follows_what_it_opens_as_the_program_does(self):
        expected = lines_of_program(FOLDER, "--track")
        tracker = vesalius.Tracker(self.detector)
        for frame in vesalius.open(FOLDER):
            people = tracker.update(frame)
            self.assertEqual(json.loads(people.json()), expected[frame.name])
            for person, theirs in zip(people, expected[frame.name]["people"]):
                self.assertEqual(person.stance, theirs["stance"])
                body = theirs["body"]
                self.assertAlmostEqual(person.stature, body["stature_m"], places=3)
                self.assertEqual([bone.name for bone in person.bones], list(body["bones"]))
                for bone in person.bones:
                    length = math.dist(bone.head, bone.tail)
                    self.assertAlmostEqual(bone.length, length, places=4)
                    numpy.testing.assert_allclose(bone.head, body["bones"][bone.name]["head_m"], atol=1e-3)
                rotations = dict(zip(self.detector.joint_names(), person.rotations()))
                for joint, xyzw in body["joint_rotations_xyzw"]["k4abt32"].items():
                    numpy.testing.assert_allclose(rotations.pop(joint), xyzw, atol=1e-3)
                self.assertTrue(all(numpy.isnan(unknown).all() for unknown in rotations.values()))

    def test_shows_a_frame_without_copying_it(self):
        with vesalius.open(FOLDER) as source:
            frame = next(source)
            self.assertIsNone(frame.time)
        self.assertIsNone(next(source, None))
        self.assertTrue(numpy.shares_memory(frame.depth, frame.depth))
        name, depth, colour = self.frames[0]
        numpy.testing.assert_array_equal(frame.depth, depth)
        self.assertEqual(frame.colour.shape, colour.shape)
        self.assertEqual((frame.name, frame.camera.fx), (name, numpy.float32(META["fx"])))
        shown = frame.depth
        self.assertGreater(len(self.detector.detect(frame)), 0)
        shown[:] = 0
        self.assertEqual(len(self.detector.detect(frame)), 0)
        del frame, source
        gc.collect()
        self.assertEqual(int(shown.max()), 0)
        made = vesalius.Frame(depth, CAMERA, colour, time=2.5, up=(0, -2, 0), name="made")
        self.assertEqual((made.name, made.time, list(made.up)), ("made", 2.5, [0, -1, 0]))
        numpy.testing.assert_array_equal(self.detector.detect(made).joints(),
                                         self.detector.detect(depth, CAMERA, colour).joints())

    def test_gives_parts_as_the_program_does(self):
        expected = lines_of_program(FOLDER)
        for frame in vesalius.open(FOLDER):
            people = self.detector.detect(frame)
            self.assertEqual(people.part_names, self.detector.parts)
            self.assertEqual(len(people.links), len(people.part_names) - 1)
            self.assertEqual(people.parts.shape, (len(people), len(people.part_names), 3))
            numpy.testing.assert_array_equal((people.labels != 255) <= (people.masks == 1), True)
            for person, theirs in zip(people, expected[frame.name]["people"]):
                self.assertEqual(person.part_unseen, [part.get("unseen") for part in theirs["parts"].values()])
                self.assertEqual(person.part_behind, [part.get("behind") for part in theirs["parts"].values()])
                for name, mine, confidence, state in zip(people.part_names, person.parts, person.part_confidences,
                                                         person.part_states):
                    part = theirs["parts"][name]
                    self.assertEqual(state, part["state"])
                    self.assertEqual("unseen" in part, state != "observed")
                    if part["xyz_m"] is None:
                        self.assertTrue(numpy.isnan(mine).all())
                    else:
                        numpy.testing.assert_allclose(mine, part["xyz_m"], atol=1e-3)
                        self.assertAlmostEqual(float(confidence), part["confidence"], places=3)

    def test_goes_on_after_a_frame_that_cannot_be_read(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(FOLDER, folder, dirs_exist_ok=True)
            names = sorted(path.stem for path in (Path(folder) / "depth").iterdir())
            (Path(folder) / "depth" / f"{names[1]}.png").write_bytes(b"no picture")
            source = vesalius.open(folder)
            read = []
            while True:
                try:
                    read.append(next(source).name)
                except vesalius.Error as e:
                    self.assertIn(f"{names[1]}.png", str(e))
                except StopIteration:
                    break
            self.assertEqual(read, names[:1] + names[2:])

    def test_takes_metres_as_millimetres(self):
        _, depth, colour = self.frames[0]
        metres = depth.astype(numpy.float32) / 1000
        metres[depth == 0] = numpy.nan
        one, other = self.detector.detect(depth, CAMERA, colour), self.detector.detect(metres, CAMERA, colour)
        numpy.testing.assert_array_equal(one.joints(), other.joints())
        numpy.testing.assert_array_equal(one.masks, other.masks)
        columns = numpy.ascontiguousarray(depth)
        self.assertEqual(len(self.detector.detect(columns, CAMERA)), len(self.detector.detect(depth.copy(), CAMERA)))

    def test_finds_people_with_a_camera_on_its_side(self):
        _, depth, _ = self.frames[0]
        side = numpy.ascontiguousarray(numpy.rot90(depth))
        camera = vesalius.Camera(META["fy"], META["fx"], META["cy"], depth.shape[1] - 1 - META["cx"])
        people = self.detector.detect(vesalius.Frame(depth, CAMERA))
        turned = self.detector.detect(vesalius.Frame(side, camera, turn=90))
        by_gravity = self.detector.detect(vesalius.Frame(side, camera, up=(-1, 0, 0)))
        self.assertGreater(len(people), 0)
        for others in (turned, by_gravity):
            self.assertEqual(len(others), len(people))
            for person, other in zip(people, others):
                numpy.testing.assert_array_equal(other.mask, numpy.rot90(person.mask))

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

    def test_has_the_pixels_of_joints(self):
        for frame in vesalius.open(FOLDER):
            people = self.detector.detect(frame)
            for points in ("k4abt32", "coco17"):
                x, y, z = numpy.moveaxis(people.joints(points).astype(float), -1, 0)
                expected = numpy.stack([x / z * frame.camera.fx + frame.camera.cx, y / z * frame.camera.fy + frame.camera.cy], -1)
                numpy.testing.assert_allclose(people.pixels(points), expected, atol=1e-5)
                for person, of_all in zip(people, people.pixels(points)):
                    numpy.testing.assert_array_equal(person.pixels(points), of_all)
        unknown = CAMERA.project([[1, 2, 0], [1, 2, -1], [math.nan, 2, 1]])
        self.assertTrue(numpy.isnan(unknown).all(axis=1).all())
        numpy.testing.assert_allclose(CAMERA.project(numpy.float32([0, 0, 2])), [CAMERA.cx, CAMERA.cy])

    def test_has_the_points_of_people(self):
        for frame in vesalius.open(FOLDER):
            rows, columns = numpy.indices(frame.depth.shape)
            z = frame.depth / 1000.0
            camera = frame.camera
            places = numpy.stack([(columns - camera.cx) / camera.fx * z, (rows - camera.cy) / camera.fy * z, z], -1)
            people = self.detector.detect(frame)
            self.assertGreater(len(people), 0)
            for person in people:
                points = person.points(frame)
                self.assertEqual(points.dtype, numpy.float32)
                numpy.testing.assert_allclose(points, places[(person.mask == 1) & (frame.depth > 0)], atol=1e-5)
                numpy.testing.assert_array_equal(person.points(frame.depth), points)
                self.assertGreater(len(points), 500)

    def test_draws_people(self):
        for frame in vesalius.open(FOLDER):
            people = self.detector.detect(frame)
            before = frame.colour.copy()
            picture = people.draw(frame.colour)
            numpy.testing.assert_array_equal(frame.colour, before)
            numpy.testing.assert_array_equal(people.draw(frame), picture)
            changed = (picture != before).any(axis=2)
            # Each person's pixels are tinted, and what lies 60 pixels off them, their boxes and their parts is as before.
            for person in people:
                self.assertGreater(changed[person.mask == 1].mean(), 0.9)
            near = numpy.zeros(changed.shape, bool)
            for person in people:
                at = frame.camera.project(person.parts)
                at = at[~numpy.isnan(at).any(axis=1)]
                u, v, width, height = person.box
                low = numpy.minimum(at.min(axis=0), (u, v)).astype(int) - 60
                high = numpy.maximum(at.max(axis=0), (u + width, v + height)).astype(int) + 60
                near[max(0, low[1]):max(0, high[1]), max(0, low[0]):max(0, high[0])] = True
            self.assertFalse(changed[~near].any())
            over_depth = people.draw(frame.depth)
            self.assertEqual(over_depth.shape, picture.shape)
            self.assertTrue((over_depth != picture).any())
        small = vesalius.Frame(numpy.ascontiguousarray(frame.depth[::2, ::2]),
                               vesalius.Camera(CAMERA.fx / 2, CAMERA.fy / 2, CAMERA.cx / 2, CAMERA.cy / 2))
        self.assertEqual(self.detector.detect(small).draw(small).shape, (*frame.depth.shape, 3))

    def test_tells_what_happened(self):
        program = subprocess.run([PROGRAM, "detect", str(DEMO), "-q", "--track", "--json", "-"], check=True, capture_output=True, text=True)
        expected = [(event["id"], event["time_s"], event["stance"]) for line in map(json.loads, program.stdout.splitlines())
                    for event in line.get("events", [])]
        events, floors = [], []
        tracker = vesalius.Tracker(self.detector)
        for frame in vesalius.open(DEMO):
            people = tracker.update(frame)
            self.assertEqual((people.frame, people.time), (frame.name, frame.time))
            events += people.events
            if people.floor is not None:
                floors.append(people.floor)
                feet = people.joints()[:, self.detector.joint_names().index("l_ankle")] @ people.floor.up + people.floor.height
                self.assertTrue((abs(feet[~numpy.isnan(feet)]) < 0.5).all())
        self.assertEqual([(event.id, round(event.time, 6), event.stance) for event in events], expected)
        said = [(event.id, round(event.time, 1), event.what, event.before) for event in events]
        self.assertIn((1, 2.3, "fell", "standing"), said)
        self.assertIn((1, 5.1, "stood up", "sitting"), said)
        self.assertIn("2.27 s person 1 fell", str(events))
        self.assertGreater(len(floors), 100)
        self.assertAlmostEqual(float(numpy.linalg.norm(floors[-1].up)), 1.0, places=5)
        self.assertIn(f"{floors[-1].height:.2f} m", repr(floors[-1]))
        self.assertEqual(self.detector.detect(frame).events, [])
        self.assertIsNone(self.detector.detect(frame).floor)

    def test_smooths_joints_as_the_program_does(self):
        expected = lines_of_program(FOLDER, "--track")
        tracker = vesalius.Tracker(self.detector)
        for frame in vesalius.open(FOLDER):
            people = tracker.update(frame)
            self.assertEqual(people.smoothed().shape, people.joints().shape)
            for person, theirs in zip(people, expected[frame.name]["people"]):
                for name, mine in zip(self.detector.joint_names(), person.smoothed()):
                    if theirs["smoothed"]["k4abt32"][name]["xyz_m"] is not None:
                        numpy.testing.assert_allclose(mine, theirs["smoothed"]["k4abt32"][name]["xyz_m"], atol=1e-3)

    def test_shows_itself_in_a_notebook(self):
        _, depth, colour = self.frames[0]
        frame = vesalius.Frame(depth, CAMERA, colour, name="<b>one & two</b>")
        people = self.detector.detect(frame)
        self.assertGreater(len(people), 0)
        page = people._repr_html_()
        root = ElementTree.fromstring(page.replace("<br>", "<br/>").replace('"></div>', '"/></div>'))  # else it is XML
        rows = root.findall(".//tr")
        self.assertEqual(len(rows), 1 + len(people))
        heads = [cell.text for cell in rows[0]]
        for index, (person, row) in enumerate(zip(people, rows[1:])):
            cells = dict(zip(heads, (cell.text for cell in row)))
            self.assertEqual((cells["person"], cells["score"]), (str(index), f"{person.score:.2f}"))
            self.assertIn(f"\n  {index}: seen, score {person.score:.2f}", repr(people))
        self.assertNotIn("<b>", page)
        self.assertIn("one & two", "".join(root.itertext()))
        self.assertIn("one & two", repr(people))
        picture = self.picture_of(page)
        self.assertLess(numpy.abs(picture - people.draw(frame).astype(int)).mean(), 4.0)
        # Without the frame they stand on black.
        del frame
        gc.collect()
        picture = self.picture_of(people._repr_html_())
        self.assertGreater(picture[people[0].mask == 1].mean(), 20)
        self.assertLess(picture[:, -5:].mean(), 3)
        nobody = self.detector.detect(numpy.zeros((48, 64), numpy.uint16), CAMERA)
        self.assertIn("0 people", nobody._repr_html_())
        self.assertEqual(repr(nobody), "<vesalius.People: 0>")

    def picture_of(self, page):
        return numpy.array(Image.open(io.BytesIO(base64.b64decode(page.split("base64,")[1].split('"')[0])))).astype(int)

    def test_says_in_one_line_what_a_call_should_have_been(self):
        _, depth, colour = self.frames[0]
        detect, frame = self.detector.detect, vesalius.Frame(depth, CAMERA, colour)
        people = detect(frame)
        for why, wrong in {
            "with its camera: detect(depth, vesalius.Camera(fx, fy, cx, cy), colour); got (ndarray)": lambda: detect(depth),
            "got (list, Camera)": lambda: detect([1, 2, 3], CAMERA),
            "got (ndarray, camera=NoneType)": lambda: detect(depth, camera=None),
            "got (Frame, name=str)": lambda: vesalius.Tracker(self.detector).update(frame, name="one"),
            "Camera(fx, fy, cx, cy): four numbers, in pixels; got (int, int, float)": lambda: vesalius.Camera(525, 525, 319.5),
            "four numbers, in pixels; got (int, int, str, int)": lambda: vesalius.Camera(525, 525, "319.5", 240),
            "four numbers, in pixels; got (focal=int)": lambda: vesalius.Camera(focal=525),
            "a vesalius.Camera(fx, fy, cx, cy); got (ndarray)": lambda: vesalius.Frame(depth),
            "Tracker(detector): a vesalius.Detector; got ()": lambda: vesalius.Tracker(),
            "got (str, fz=int)": lambda: vesalius.open("/none", fz=3),
            "not int": lambda: vesalius.open(3),
            "threads=0": lambda: vesalius.Detector(threads="many"),
            "the name of a joint set": lambda: people.joints(4),
            "a vesalius.Frame, or a picture": lambda: people.draw("picture.png"),
            "or its depth as a numpy array; got ()": lambda: people[0].points(),
            "a whole number; got (str)": lambda: people["first"],
        }.items():
            with self.assertRaises(TypeError, msg=why) as raised:
                wrong()
            self.assertIn(why, str(raised.exception))
            self.assertEqual(len(str(raised.exception).splitlines()), 1)
        self.assertEqual(vesalius.Camera(525, 525, 319, 239).fx, 525)  # whole numbers are numbers
        self.assertIn("joints(self, set: str = 'k4abt32')", people.joints.__doc__)

    def test_says_what_does_not_fit(self):
        _, depth, colour = self.frames[0]
        detect = self.detector.detect
        for why, wrong in {
            "expected dtype uint16": lambda: detect(depth.astype(numpy.int32), CAMERA),
            "expected height x width": lambda: detect(depth[0], CAMERA),
            "colour: an array of shape": lambda: detect(depth, CAMERA, depth),
            "search_minparts is no option; did you mean search_min_parts?": lambda: vesalius.Detector(search_minparts=3),
            "min_score is no option; did you mean refine_min_score?": lambda: vesalius.Detector(min_score=0.5),
            "nonsense is no option; vesalius.options() lists them": lambda: vesalius.Detector(nonsense=3),
            "an array of dtype float64": lambda: detect(depth.astype(float), CAMERA),
            "draw: a picture of 640x10, expected 640x480": lambda: detect(depth, CAMERA).draw(depth[:10]),
            "expected 480x640x3 of dtype uint8": lambda: detect(depth, CAMERA).draw(colour / 255.0),
            "points: a picture of 640x10": lambda: detect(depth, CAMERA)[0].points(depth[:10]),
            "smoothed: a Detector sees one frame alone": lambda: detect(depth, CAMERA).smoothed(),
            "expected an array of points (..., 3)": lambda: CAMERA.project([1, 2]),
            "refine.min-score": lambda: vesalius.Detector(refine_min_score=7.0),
            "expected a whole number": lambda: vesalius.Detector(refine_max_candidates=1.5),
            "threads: expected": lambda: vesalius.Detector(threads=-1),
            "expected one of": lambda: detect(depth, CAMERA, colour).joints("body25"),
            "up: expected": lambda: vesalius.Frame(depth, CAMERA, up=(0, 0, 0)),
            "turn: expected": lambda: vesalius.Frame(depth, CAMERA, turn=45),
            "a turn of 45": lambda: vesalius.open(FOLDER, turn=45),
            'depth_bits is "big"': lambda: vesalius.open(FOLDER, depth_bits="big"),
            "a start of 1000000 s": lambda: vesalius.open(FOLDER, start=1e6),
            "time: expected": lambda: vesalius.Tracker(self.detector).update(depth, CAMERA, time=math.nan),
        }.items():
            with self.assertRaises(ValueError, msg=why) as raised:
                wrong()
            self.assertIn(why, str(raised.exception))
            self.assertEqual(len(str(raised.exception).splitlines()), 1)
        for wrong in (lambda: vesalius.Detector("/none.forest"), lambda: vesalius.Detector(__file__),
                      lambda: vesalius.open("/none"), lambda: vesalius.open(Path(__file__)),
                      lambda: vesalius.open("realsense:none"), lambda: vesalius.open(FOLDER, camera_file="/none"),
                      lambda: detect(depth, vesalius.Camera(math.nan, 1, 1, 1))):
            with self.assertRaises(vesalius.Error) as raised:
                wrong()
            self.assertEqual(len(str(raised.exception).splitlines()), 1)
        with self.assertRaises(IndexError):
            detect(depth, CAMERA)[99]

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

    def test_leaves_the_main_interpreter_alone(self):
        done = subprocess.run([sys.executable, "-c", SUBINTERPRETERS, str(FOLDER)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        said = done.stdout.splitlines()
        self.assertEqual(len(said), 2)
        for line in said:
            self.assertIn("main interpreter only", line)

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
        lines = vesalius.describe_options().splitlines()
        self.assertTrue(any(line.startswith("refine_min_score = 0.8: ") for line in lines))
        self.assertTrue(any(line.startswith("track_rate = 30.0") for line in lines))
        options = vesalius.options()
        self.assertEqual(list(options), [line.split(" = ")[0] for line in lines])
        self.assertEqual((options["refine_min_score"], options["track_rate"]), (0.8, 30.0))
        # What is said is taken, and nothing else is changed by it.
        self.assertEqual(vesalius.Detector(**options).options(), options)
        self.assertEqual(vesalius.Detector(refine_min_score=0.9).options(), options | {"refine_min_score": 0.9})


if __name__ == "__main__":
    print(f"imported in {IMPORT_MS:.0f} ms")
    unittest.main()
