"""Tests of vesalius_network: `network_test.py VESALIUS`, with the program, which renders frames. Without PyTorch the
exit code is 77: skipped."""

import math
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
try:
    import numpy as np
    import torch
    import zstandard  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

from vesalius_network import nets, place, quantise, weights
from vesalius_network.beginning import begin_from, state_of
from vesalius_network.body import headings_of, middles_of, read_body
from vesalius_network.damage import KINDS, Scene, damaged
from vesalius_network.errors import InputError
from vesalius_network.figures import figures_of
from vesalius_network.inputs import inputs_of, without_blended
from vesalius_network.losses import loss_of_centres
from vesalius_network.model_file import read_network, read_sections
from vesalius_network.nets import CONFIGS, Network, answer
from vesalius_network.rounds import Rounds, read_pools
from vesalius_network.shards import Dataset
from vesalius_network.train import Plan, Training
from vesalius_network.views import Chance, joined

CPU = torch.device("cpu")
DATA = Path(__file__).parents[3] / "data"
BODIES, MODELS = DATA / "bodies", DATA / "models"
FRAMES = ["--sensor.width", "96", "--sensor.height", "72", "--people.none", "0.2", "--count", "12", "--seed", "5"]
program, folder = None, None


def setUpModule():
    global program, folder
    folder = tempfile.TemporaryDirectory()
    program = sys.argv[1]
    render("shards", [])


def tearDownModule():
    folder.cleanup()


def path(name):
    return str(Path(folder.name) / name)


def render(name, more):
    command = [program, "synth", "-q", *FRAMES, "--no-sensor.colour", "--out", path(name), *more]
    subprocess.run(command, check=True)


def frames_as_views():
    dataset = Dataset(path("shards"))
    pool = read_pools([(dataset, 0)], dataset.body, CPU)[0]
    return pool.views(slice(None)), dataset.body


def read_png(name):
    """Reads a grey picture of 8 or 16 bits."""
    data, at, packed = Path(name).read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        content = data[at + 8 : at + 8 + size]
        if kind == b"IHDR":
            width, height, depth = struct.unpack(">IIB", content[:9])
        packed += content if kind == b"IDAT" else b""
        at += size + 12
    step = depth // 8
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * step)
    out = np.zeros((height + 1, (width + 1) * step), np.uint8)  # a row above and a pixel on the left are 0
    for v, (kind, *row) in enumerate(rows.tolist()):
        above, here = out[v].tolist(), [0] * step
        for i, value in enumerate(row):
            a, b, c = here[i], above[i + step], above[i]
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            here.append((value + [0, a, b, (a + b) // 2, nearest][kind]) % 256)
        out[v + 1] = here
    pixels = out[1:, step:].reshape(height, width, step)
    return pixels[..., 0].astype(np.uint16) if step == 1 else pixels.astype(np.uint16) @ np.array([256, 1], np.uint16)


def equal(a, b):
    return torch.equal(a.nan_to_num(), b.nan_to_num()) and torch.equal(a.isnan(), b.isnan())


class Shards(unittest.TestCase):
    def test_are_the_frames_of_a_folder(self):
        render("folder", ["--format", "folder"])
        frames = Dataset(path("shards")).read(0)
        names = sorted(p.name for p in Path(path("folder"), "depth").iterdir())
        self.assertEqual(len(names), 12)
        for i, name in enumerate(names):
            for kind, pictures in (("depth", frames.depth_mm), ("labels", frames.labels), ("person", frames.person)):
                np.testing.assert_array_equal(read_png(Path(path("folder"), kind, name)), pictures[i], f"{kind} {name}")

    def test_damaged_ones_are_refused_with_their_file(self):
        render("damaged", [])
        shard = Path(path("damaged"), "000000.shard")
        whole = shard.read_bytes()
        for size in (10, 60, len(whole) - 1):
            shard.write_bytes(whole[:size])
            with self.assertRaisesRegex(InputError, "000000.shard"):
                Dataset(path("damaged")).read(0)
        shard.unlink()
        with self.assertRaisesRegex(InputError, "000000.shard"):
            Dataset(path("damaged")).read(0)
        with self.assertRaisesRegex(InputError, "dataset.json"):
            Dataset(path("nowhere"))

    def test_take_turns_where_memory_has_no_room(self):
        dataset = Dataset(path("shards"))
        dataset.size, dataset.per_shard = (72, 96), 3
        room = 7 * 4 * 72 * 96
        rounds = Rounds([dataset], 4, room, 1)
        self.assertFalse(rounds.at_once)
        first, second = rounds.of(0), rounds.of(rounds.of(0).end)
        self.assertEqual(len(first.shards), 2)
        self.assertEqual(len({number for _, number in first.shards + second.shards}), 4)
        self.assertEqual(rounds.of(first.end - 1).shards, first.shards)
        self.assertEqual(Rounds([dataset], 4, 8 * room, 1).of(0).end, math.inf)


class Bodies(unittest.TestCase):
    def test_trunks_come_from_the_file(self):
        for name, below in (("paper25", "hips"), ("upper_body", "belly")):
            body = read_body((BODIES / f"{name}.toml").read_text(), name)
            trunk = {part for part, counts in zip(body.names, body.trunk) if counts}
            self.assertEqual(trunk, {f"l_{below}", f"r_{below}", "l_chest", "r_chest"})

    def test_a_turned_body_has_its_heading(self):
        body = read_body((BODIES / "paper25.toml").read_text(), "")
        x = np.where(body.left, 0.2, np.where(body.left[body.mirror], -0.2, 0))
        upright = np.stack([x, np.where(body.upper, -0.5, 0.5), 0 * x], 1)
        for yaw in (0, 0.7, -1.2, 3):
            turn = np.array([[math.cos(yaw), 0, -math.sin(yaw)], [0, 1, 0], [math.sin(yaw), 0, math.cos(yaw)]])
            centres = (upright @ turn.T + [0, 0, 3]).astype(np.float32)
            self.assertAlmostEqual(float(headings_of(centres, body)), yaw, 5)
            np.testing.assert_allclose(middles_of(centres, body)[2], 3, atol=1e-5)
        self.assertTrue(np.isnan(headings_of(np.full((body.parts, 3), np.nan, np.float32), body)))


class Places(unittest.TestCase):
    def test_mirrored_twice_is_the_same(self):
        views, body = frames_as_views()
        which = torch.arange(12) % 3 > 0
        once = place.mirrored(views, which, body)
        twice = place.mirrored(once, which, body)
        for name in vars(views):
            self.assertTrue(equal(getattr(views, name), getattr(twice, name)), name)
        self.assertFalse(equal(views.labels, once.labels))
        self.assertTrue(equal(views.labels[0], once.labels[0]))

    def test_a_mirrored_body_has_the_other_heading(self):
        views, body = frames_as_views()
        once = place.mirrored(views, torch.ones(12, dtype=torch.bool), body)
        found, told = torch.from_numpy(headings_of(once.centres.numpy(), body)), ~views.headings.isnan()
        self.assertTrue(told.any())
        torch.testing.assert_close(found[told], once.headings[told], atol=1e-4, rtol=0)

    def test_points_stay_where_they_are(self):
        """A camera that is zoomed, turned and shifted sees the same points, turned: f/z * size is kept."""
        views, body = frames_as_views()
        chance = Chance(1, 2, CPU)
        n, size = len(views), (240, 320)
        zoom, turn = chance.between(0.75, 2.8, n), chance.between(-3, 3, n)
        origin = place.choose_origin(views, zoom, turn, size, chance)
        seen = place.seen_from(views, zoom, turn, origin, size)
        torch.testing.assert_close(seen.focal, views.focal * zoom)
        pixels = 0
        for i, v, u in (seen.depth > 0).nonzero()[::501].tolist():
            z = float(seen.depth[i, v, u])
            ray = (torch.tensor([u, v]) - origin[i]) / seen.focal[i] * z
            there = place.turned(torch.tensor([[*ray.tolist(), z]]), -turn[i : i + 1])[0]
            u0, v0 = (there[:2] / z * views.focal[i] + views.origin[i]).round().long().tolist()
            beside = views.depth[i, max(0, v0 - 1) : v0 + 2, max(0, u0 - 1) : u0 + 2]
            self.assertTrue((beside == z).any())
            pixels += 1
        self.assertGreater(pixels, 200)

    def test_near_views_show_somebody(self):
        views, body = frames_as_views()
        seen = place.placed(views, body, (240, 320), Chance(1, 3, CPU), plain=False)
        near = seen.focal > 1.3 * views.focal
        somebody = ~views.middles[:, :, 0].isnan().all(1)
        self.assertTrue((near & somebody).any())
        self.assertTrue((seen.labels[near & somebody] != 255).any())


class Inputs(unittest.TestCase):
    def test_known_answers(self):
        depth = torch.zeros(1, 8, 8)
        depth[0, :, :7] = 2.0 + 0.01 * torch.arange(7)
        x = inputs_of(depth, torch.tensor([570.0]))[0]
        torch.testing.assert_close(x[0, 3, 0], torch.tensor(2 * 570 / 285 / 2.0 - 0.7))
        self.assertEqual(x[:, 3, 7].tolist(), [0, 0, 0, 0])
        self.assertEqual(x[1, 3].tolist(), [1] * 7 + [0])
        torch.testing.assert_close(x[2, 3, 3], torch.tensor(0.04 * 570 / (4 * 2.03)))
        self.assertEqual(x[2, 3, 5], 0)  # beside it there is no reading
        self.assertEqual(x[3, 3, 3], 0)
        steep = torch.ones(1, 8, 8)
        steep[0, :, 4:] = 5
        self.assertEqual(inputs_of(steep, torch.tensor([500.0]))[0, 2].max(), 3)

    def test_blended_readings_go_as_in_the_program(self):
        chance = Chance(4, 5, CPU)
        depth = chance.whole(900, 1100, 3, 20, 24).float()
        depth[chance.share(*depth.shape) < 0.15] = 0
        found = without_blended(depth)
        self.assertGreater(int(((depth > 0) & (found == 0)).sum()), 20)
        np.testing.assert_array_equal(found.numpy(), np.stack([slow_without_blended(d) for d in depth.numpy()]))


def slow_without_blended(depth):
    """Pixel by pixel, as src/vesalius/base/blended_depth.h describes it."""
    out, holes = depth.copy(), np.argwhere(depth == 0)
    for _ in range(3):
        blended = set()
        for v, u in holes:
            for dv, du in ((a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b):
                if 0 <= v + 2 * dv < out.shape[0] and 0 <= u + 2 * du < out.shape[1]:
                    near, far = out[v + dv, u + du], out[v + 2 * dv, u + 2 * du]
                    if near != 0 and near < np.float32(0.95) * far:
                        blended.add((v + dv, u + du))
        for pixel in blended:
            out[pixel] = 0
        holes = list(blended)
    return out


class Damage(unittest.TestCase):
    def test_depth_stays_depth(self):
        views, body = frames_as_views()
        many = joined([views] * 4)
        depth = damaged(many, body, Chance(1, 1, CPU))
        self.assertTrue(torch.isfinite(depth).all() and (depth >= 0).all())
        torch.testing.assert_close(depth * 1000, (depth * 1000).round(), atol=1e-2, rtol=0)
        left = (depth > 0).flatten(1).sum(1) / (many.depth > 0).flatten(1).sum(1)
        self.assertGreater(int((left < 0.95).sum()), 8)

    def test_each_kind_keeps_the_size(self):
        views, body = frames_as_views()
        labels = torch.where(views.labels == 255, body.parts, views.labels.long())
        scene = Scene(labels, labels < body.parts, torch.from_numpy(body.upper))
        for _, spoil in KINDS:
            depth = spoil(views.depth.clone(), scene, Chance(1, 1, CPU))
            self.assertEqual(depth.shape, views.depth.shape, spoil.__name__)
            self.assertTrue(torch.isfinite(depth).all(), spoil.__name__)


class Losses(unittest.TestCase):
    def test_who_is_near_to_a_part_says_where_it_is(self):
        target = torch.zeros(1, 6, 1, 2)  # two parts, two pixels: one is in the first part, 0.9 m from the second
        target[0, 3, 0] = 0.9
        target[..., 1] = float("nan")  # shows nobody

        def loss(part, error_m):
            said = target.nan_to_num()
            said[0, 3 * part, 0, 0] += error_m
            said[..., 1] += 5
            return float(loss_of_centres(said, target))

        self.assertEqual(loss(0, 0.0), 0.0)
        self.assertAlmostEqual(loss(0, 0.2) / loss(1, 0.2), 10.0, 4)
        self.assertEqual(float(loss_of_centres(target.nan_to_num(), target * float("nan"))), 0.0)


class Files(unittest.TestCase):
    def test_weights_come_back(self):
        body = read_body((BODIES / "paper25.toml").read_text(), "")
        network = Network(CONFIGS["small"], body.parts).eval()
        weights.save(path("a.npz"), "small", body, network.state_dict(), "a test")
        about, state = weights.load(path("a.npz"))
        self.assertEqual(read_body(about["body"], "a").names, body.names)
        again = Network(CONFIGS["small"], body.parts).eval()
        again.load_state_dict(state, strict=False)
        x = torch.rand(1, 4, 50, 70)
        for a, b in zip(answer(network, x), answer(again, x)):
            self.assertTrue(torch.equal(a, b))
        with self.assertRaisesRegex(InputError, "a.npz: a network of config small"):
            begin_from(Network(CONFIGS["default"], 25), "default", body, path("a.npz"), None)

    def test_another_body_begins_with_new_heads(self):
        body = read_body((BODIES / "paper25.toml").read_text(), "")
        other = read_body((BODIES / "upper_body.toml").read_text(), "")
        old, new = Network(CONFIGS["small"], body.parts), Network(CONFIGS["small"], other.parts)
        weights.save(path("b.npz"), "small", body, old.state_dict(), "a test")
        self.assertIn("anew", begin_from(new, "small", other, path("b.npz"), None))
        self.assertTrue(torch.equal(new.stem[0].weight, old.stem[0].weight))

    def test_others_are_refused(self):
        Path(path("bad.npz")).write_bytes(b"nothing")
        for name in ("bad.npz", "none.npz"):
            with self.assertRaisesRegex(InputError, name):
                weights.load(path(name))


class Quantising(unittest.TestCase):
    def network(self, parts=3):
        torch.manual_seed(3)
        network = Network(CONFIGS["small"], parts).eval()
        for module in network.modules():
            if isinstance(module, torch.nn.BatchNorm2d):
                torch.nn.init.uniform_(module.weight, 0.5, 1.5)
                torch.nn.init.uniform_(module.bias, -0.3, 0.3)
                torch.nn.init.uniform_(module.running_mean, -0.2, 0.2)
                torch.nn.init.uniform_(module.running_var, 0.5, 1.5)
        return network

    def inputs(self):
        views, _ = frames_as_views()
        return nets.padded(inputs_of(views.depth, views.focal))

    @torch.no_grad()
    def test_layers_say_what_the_network_says(self):
        network, x = self.network(), self.inputs()
        layers, *heads = quantise.layers_of(weights.floats(network.state_dict()))
        results = quantise.run_layers(layers, x)
        self.assertEqual(len(heads), 3)
        for head, expected in zip(heads, network(x)):
            self.assertLess(float((results[head] - expected).abs().max()), 1e-3)

    @torch.no_grad()
    def test_integers_are_near_real_numbers(self):
        x = self.inputs()
        layers, *heads = quantise.layers_of(weights.floats(self.network().state_dict()))
        real = quantise.run_layers(layers, x)
        tops = quantise.Tops(layers)
        tops.add(real)
        whole = quantise.run_convolutions(quantise.quantise(layers, tops), quantise.channels_of(x))
        units = quantise.LOGIT_UNIT, quantise.PERSON_UNITS[:, None, None], quantise.CENTRE_UNIT
        for layer, unit in zip(heads, units):
            off = (whole[layer + 1] * torch.as_tensor(unit) - real[layer]).abs().mean()
            spread = real[layer].std()
            self.assertLess(float(off / spread), 0.1)

    def model(self, network, name):
        """Writes the network as a model."""
        body = read_body((BODIES / "paper25.toml").read_text(), "paper25.toml")
        weights.save(path("n.npz"), "small", body, network.state_dict(), "a test")
        quantise.write_network(path("n.npz"), [path("shards")], path("n.network"), 4)
        subprocess.run([program, "convert", "-q", path("n.network"), path(name)], check=True)

    def test_the_program_reads_what_is_written(self):
        self.model(self.network(25), "n.model")
        said = subprocess.run([program, "info", path("n.model")], check=True, capture_output=True, text=True).stdout
        self.assertIn("a test", said)

    @torch.no_grad()
    def test_begins_with_what_a_model_says(self):
        network, x = self.network(25), self.inputs()
        self.model(network, "begin.model")
        body = read_body((BODIES / "paper25.toml").read_text(), "")
        begun = Network(CONFIGS["small"], body.parts)
        self.assertIn("a test", begin_from(begun, "small", body, path("begin.model"), lambda: x))
        for said, expected in zip(begun.eval()(x), network(x)):
            self.assertLess(float((said - expected).abs().mean() / expected.std()), 0.1)
        # A training takes away a batch's own statistics, which are those of these pictures.
        for learning, said in zip(begun.train()(x), begun.eval()(x)):
            self.assertLess(float((learning - said).abs().mean() / said.std()), 0.02)

    def test_begins_with_a_model_without_centres(self):
        network = self.network(25)
        self.model(network, "all.model")
        convolutions, *_, centres = read_network(read_sections(path("all.model"))["network"][1])
        self.assertEqual(centres, len(convolutions) - 1)
        _, state = state_of(convolutions, 25, "all")
        _, older = state_of(convolutions[:-3], 25, "older")
        self.assertTrue(all(name.startswith("joints.") for name in set(state) - set(older)))
        self.assertIn("joints.1.bias", set(state) - set(older))
        self.assertTrue(torch.equal(state["inst.weight"], older["inst.weight"]))

    def test_sections_come_back_with_and_without_centres(self):
        self.model(self.network(25), "all.model")
        section = read_sections(path("all.model"))["network"][1]
        convolutions, classes, person, centres = read_network(section)
        self.assertEqual(quantise.section_of(convolutions, classes, person, centres), section)
        none = quantise.section_of(convolutions[:-1], classes, person, -1)
        for content in (none, none[:-2]):  # of version 2, and of version 1
            self.assertEqual(read_network(content)[1:], (classes, person, -1))

    def test_other_models_are_no_beginning(self):
        body = read_body((BODIES / "paper25.toml").read_text(), "")
        forest, default = str(MODELS / "capsule.forest"), str(MODELS / "default.model")
        content = Path(default).read_bytes()
        Path(path("cut.model")).write_bytes(content[:5000])
        Path(path("old.model")).write_bytes(content[:8] + b"\2" + content[9:])
        for model, expected in (
            (path("cut.model"), "cut.model: damaged at byte"),
            (path("old.model"), "old.model: version 2"),
            (forest, "capsule.forest: expected a model with a network"),
            (default, "config default, expected small"),
            (path("no.model"), "no.model: No such file"),
        ):
            with self.assertRaisesRegex(InputError, expected):
                begin_from(Network(CONFIGS["small"], body.parts), "small", body, model, None)


class Learning(unittest.TestCase):
    def setUp(self):
        torch.set_num_threads(1)

    def training(self, views, out, **more):
        plan = Plan(**{"config": "small", "views": views, "batch": 2, "rate": 2e-3, **more})
        return Training(plan, [path("shards")], [], path(out), CPU, 1e9, tell=lambda text: None)

    def test_answers_have_the_size_of_the_picture(self):
        network = Network(CONFIGS["small"], 3).eval()
        shapes = [tuple(a.shape) for a in answer(network, torch.zeros(1, 4, 41, 63))]
        self.assertEqual(shapes, [(1, 4, 21, 32), (1, 5, 11, 16), (1, 9, 6, 8)])

    def test_losses_fall(self):
        training = self.training(120, "falls")
        losses = [training.step() for _ in range(60)]
        for name in ("body", "parts", "middle"):
            first, last = (np.mean([float(step[name]) for step in part]) for part in (losses[:8], losses[-20:]))
            self.assertLess(last, 0.9 * first, name)
        self.assertTrue(torch.isfinite(torch.tensor(figures_of(training.average, training.pools, training.body).iou)))

    def test_goes_on_to_the_same_weights(self):
        whole, begun = self.training(12, "whole"), self.training(12, "halves")
        for _ in range(6):
            whole.step()
        for _ in range(3):
            begun.step()
        begun.estimate()
        begun.save()
        resumed = self.training(12, "halves")
        self.assertEqual(resumed.batch, 3)
        self.assertTrue(resumed.run(1000))
        for name, value in whole.average.state_dict().items():
            self.assertTrue(torch.equal(value, resumed.average.state_dict()[name]), name)
        about, state = weights.load(path("halves/network.npz"))
        self.assertEqual(about["classes"], 26)
        self.assertIn("views = 12", about["made_from"])
        self.assertTrue(torch.equal(state["labels.bias"], whole.average.state_dict()["labels.bias"]))

    def test_does_not_go_on_with_another_plan(self):
        self.training(12, "plan").save()
        with self.assertRaisesRegex(InputError, "training.pt: begun with views 12, not 24"):
            self.training(24, "plan")


if __name__ == "__main__":
    result = unittest.main(argv=[sys.argv[0], "-v"], exit=False).result
    sys.exit(0 if result.wasSuccessful() else 1)
