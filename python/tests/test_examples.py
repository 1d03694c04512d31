"""Runs the examples with the package as it is installed; those that need others where these are there.

Usage: test_examples.py PROGRAM FRAMES
"""

import importlib.util
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy

import vesalius

PROGRAM, FOLDER = Path(sys.argv.pop(1)).resolve(), Path(sys.argv.pop(1)).resolve()
EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"


def needs(*modules):
    def is_there(name):
        parent = name.rpartition(".")[0]
        return (not parent or is_there(parent)) and importlib.util.find_spec(name) is not None

    missing = [name for name in modules if not is_there(name)]
    return unittest.skipIf(missing, f"without {', '.join(missing)}")


def said_by(cell):
    """The text that a cell of a notebook gives, without the bytes of pictures."""
    said = [output.get("text", "") + "".join(value for kind, value in sorted(output.get("data", {}).items()) if kind.startswith("text/"))
            for output in cell.get("outputs", [])]
    return re.sub("base64,[^\"]*", "", "".join(said))


def run(name, *arguments):
    environment = dict(os.environ, PATH=f"{PROGRAM.parent}:{os.environ['PATH']}")
    command = [sys.executable, str(EXAMPLES / name), *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout


class Examples(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = Path(place.name)
        self.clip = self.place / "clip"
        subprocess.run([PROGRAM, "synth", "--clip", "0.5", "--count", "1", "--seed", "3", "--format", "folder", "--out", self.clip,
                        "-q"], check=True)

    def test_detects_people(self):
        detector = vesalius.Detector()
        count = sum(len(detector.detect(frame)) for frame in vesalius.open(FOLDER))
        self.assertEqual(len(run("detect_people.py", FOLDER).splitlines()), count)

    def test_follows_people(self):
        out = self.place / "out.npz"
        lines = run("follow_people.py", self.clip, out).splitlines()
        with numpy.load(out) as kept:
            self.assertEqual(len(kept.files), 2 * len(lines))
            longest = max((kept[name] for name in kept.files if name.startswith("joints")), key=len)
            self.assertGreaterEqual(len(longest), 10)
            self.assertEqual(longest.shape[1:], (32, 3))

    @needs("nbclient", "ipykernel", "matplotlib")
    def test_runs_the_notebook(self):
        import nbclient
        import nbformat

        os.environ["VESALIUS_SOURCE"] = str(FOLDER.parent / "demo")
        notebook = nbformat.read(EXAMPLES / "people.ipynb", as_version=4)
        shown = [said_by(cell) for cell in notebook.cells]
        nbclient.NotebookClient(notebook, timeout=120).execute()
        self.assertEqual(shown, [said_by(cell) for cell in notebook.cells], "what people.ipynb shows is not what it says today")
        pictures = [output for cell in notebook.cells for output in cell.get("outputs", [])
                    if "image/png" in output.get("data", {})]
        self.assertEqual(len(pictures), 4)

    @needs("rerun.chunk")
    def test_shows_people_in_rerun(self):
        from rerun.chunk import RrdReader

        import vesalius.rerun  # noqa: F401

        out = self.place / "people.rrd"
        run("show_in_rerun.py", self.clip, out)
        shown, cleared = {}, 0
        for chunk in RrdReader(out).stream():
            entity, batch = str(chunk.entity_path), chunk.to_record_batch()
            cleared += chunk.num_rows if entity == "/vesalius/people" else 0
            if entity.endswith("/joints"):
                for points in batch.column("Points3D:positions").to_pylist():
                    shown.setdefault(int(entity.split("/")[3]), []).append(points)
        tracker = vesalius.Tracker(vesalius.Detector())
        expected, frames = {}, 0
        for frame in vesalius.open(self.clip):
            frames += 1
            for person in tracker.update(frame):
                joints = person.joints()
                expected.setdefault(person.id, []).append(joints[~numpy.isnan(joints).any(axis=1)].tolist())
        self.assertEqual(cleared, frames)
        self.assertGreater(len(expected), 0)
        self.assertEqual({who: len(points) for who, points in shown.items()}, {who: len(points) for who, points in expected.items()})
        for who, points in expected.items():
            for one, other in zip(points, shown[who]):
                numpy.testing.assert_allclose(numpy.reshape(other, (-1, 3)), one, atol=1e-6)

    @unittest.skipUnless(os.environ.get("VESALIUS_FRAMES"), "takes a minute")
    def test_trains_a_forest(self):
        lines = run("train_forest.py", self.place / "forest").splitlines()
        people = [int(line.split()[-2]) for line in lines if line.endswith(" people")]
        self.assertEqual(len(people), 3)
        self.assertGreater(sum(people), 0)


if __name__ == "__main__":
    unittest.main()
