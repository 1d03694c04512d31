"""Learns a network from labelled frames."""

import copy
import math
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import torch

from . import weights
from .beginning import begin_from
from .damage import damaged
from .errors import InputError
from .figures import figures_of
from .inputs import inputs_of
from .losses import WEIGHTS, losses_of, targets_of, weights_of_parts
from .nets import CONFIGS, Network, answer, multiply_adds, padded
from .rounds import Rounds, draw, open_datasets, read_pools
from .shards import BACKGROUND
from .views import Chance

SIZE = (240, 320)  # height and width of the views
BETAS = (0.9, 0.99)
DECAY = 0.01  # of weights; neither of offsets nor of scales
LONGEST_GRADIENT = 2.0
WARM_SHARE = 1 / 14  # of the batches, while the rate rises
LEAST_RATE = 0.005  # of the rate, at the end
PLAIN_SHARE = 0.08  # of the batches: the last ones are neither zoomed nor turned
AVERAGE_SHARE = 1 / 6  # of the batches, over which weights are averaged
WRONG_FOCAL_SHARE, WRONG_FOCAL = 0.3, 0.06  # a focal length that is a little wrong
COUNTED_FRAMES = 400  # in which pixels of parts are counted
MEASURED_BATCHES = 3
LOOKED_AT_BATCHES = 4  # of a model that a training begins with
SAVED_EVERY_S = 120.0
TOLD_EVERY_S = 10.0


@dataclass(frozen=True)
class Plan:
    """What decides how a network comes out, besides the frames."""

    config: str = "default"
    views: int = 1_500_000
    batch: int = 16
    rate: float = 1e-3
    seed: int = 1
    bf16: bool = False
    init: str = ""  # file of weights that it begins with

    @property
    def batches(self):
        return max(1, self.views // self.batch)

    def rate_at(self, batch):
        """Rises, then falls as a cosine does."""
        risen = min(1.0, (batch + 1) / max(1.0, WARM_SHARE * self.batches))
        fallen = 0.5 * (1 + math.cos(math.pi * batch / self.batches))
        return self.rate * risen * (LEAST_RATE + (1 - LEAST_RATE) * fallen)

    def kept_of_average(self, batch):
        """Returns how much of the averaged weights stays after a batch."""
        return max(0.0, min(1 - 1 / max(1.0, AVERAGE_SHARE * self.batches), (1 + batch) / (20 + batch)))

    def is_plain(self, batch):
        return batch >= (1 - PLAIN_SHARE) * self.batches


def duration(seconds):
    minutes = round(seconds / 60)
    if minutes == 0:
        return f"{seconds:.0f} s"
    return f"{minutes // 60} h {minutes % 60:02d} min" if minutes >= 60 else f"{minutes} min"


def part_weights(pools, body):
    """Returns the weight of a pixel of each part, after how many there are in some of the frames."""
    counts = torch.zeros(body.parts, dtype=torch.long, device=pools[0].labels.device)
    for pool in pools:
        labels = pool.labels[: COUNTED_FRAMES // len(pools)].flatten()
        counts += torch.bincount(labels[labels != BACKGROUND].long(), minlength=body.parts)
    return weights_of_parts(counts)


class Training:
    """A training in a folder: `training.pt` is where it stands, `network.npz` the averaged weights."""

    def __init__(self, plan, data, held_out, out, device, memory_bytes, tell=print):
        self.plan, self.device, self.tell = plan, device, tell
        self.out = Path(out)
        datasets = open_datasets([*data, *held_out])
        self.body, self.datasets = datasets[0].body, datasets[: len(data)]
        self.held_out = [(d, shard) for d in datasets[len(data) :] for shard in range(d.shards)]
        self.rounds = Rounds(self.datasets, plan.batch, memory_bytes, plan.seed)
        self.round, self.pools, self.held_out_pools = None, None, None
        torch.manual_seed(plan.seed)
        network = Network(CONFIGS[plan.config], self.body.parts)
        self.network = network.to(device).to(memory_format=torch.channels_last)
        self.batch, self.weights, self.begun_from = 0, None, ""
        begun = self._state_path.exists()
        if plan.init and not begun:
            self.begun_from = begin_from(self.network, plan.config, self.body, plan.init, self._some_inputs)
        self.average = copy.deepcopy(self.network).eval()
        self.optimiser = self._optimiser(self.network)
        if begun:
            self._go_on()

    def _optimiser(self, network):
        kernels = [p for p in network.parameters() if p.dim() > 1]
        others = [p for p in network.parameters() if p.dim() <= 1]
        groups = [{"params": kernels, "weight_decay": DECAY}, {"params": others, "weight_decay": 0.0}]
        return torch.optim.AdamW(groups, lr=self.plan.rate, betas=BETAS, fused=self.device.type == "cuda")

    @property
    def _state_path(self):
        return self.out / "training.pt"

    @property
    def _key(self):
        """What must be the same for a training to go on."""
        return {**asdict(self.plan), "frames": [[d.hash, d.frames] for d in self.datasets], "room": self._room}

    @property
    def _room(self):
        return 0 if self.rounds.at_once else self.rounds.room

    def _go_on(self):
        try:
            state = torch.load(self._state_path, map_location=self.device, weights_only=True)
            key = state["key"]
        except Exception as error:
            raise InputError(f"{self._state_path}: expected a training to go on with: {error}") from error
        differing = [name for name, value in self._key.items() if key.get(name) != value]
        if differing:
            name = differing[0]
            raise InputError(
                f"{self._state_path}: begun with {name} {key.get(name)}, not {self._key[name]}: "
                "expected the same, another folder, or --restart"
            )
        self.network.load_state_dict(state["network"])
        self.average.load_state_dict(state["average"])
        self.optimiser.load_state_dict(state["optimiser"])
        self.batch, self.weights, self.begun_from = state["batch"], state["weights"], state["begun_from"]

    def save(self):
        self.out.mkdir(parents=True, exist_ok=True)
        beside = Path(f"{self._state_path}.tmp")
        names = ("batch", "weights", "begun_from")
        models = {name: getattr(self, name).state_dict() for name in ("network", "average", "optimiser")}
        torch.save({"key": self._key, **models, **{name: getattr(self, name) for name in names}}, beside)
        beside.replace(self._state_path)
        weights.save(self.out / "network.npz", self.plan.config, self.body, self.average.state_dict(), self.made_from)

    @property
    def made_from(self):
        """How the network was learnt, as TOML."""
        plan = self.plan
        lines = [f'config = "{plan.config}"', f"views = {self.batch * plan.batch}", f"of_views = {plan.views}"]
        lines += [f"batch = {plan.batch}", f"rate = {plan.rate:g}", f"seed = {plan.seed}"]
        if self.begun_from:
            lines.append(f"begun_from = '''\n{self.begun_from}'''")
        for dataset in self.datasets:
            lines += ["[[frames]]", f"count = {dataset.frames}", f"seed = {dataset.seed}", f'hash = "{dataset.hash}"']
        return "\n".join(lines) + "\n"

    def _load(self):
        """Brings the frames of the next batch into memory."""
        if self.round is not None and self.round.first <= self.batch < self.round.end:
            return
        self.pools = None
        self.round = self.rounds.of(self.batch)
        self.pools = read_pools(self.round.shards, self.body, self.device)
        if self.weights is None:
            self.weights = part_weights(self.pools, self.body)

    @torch.no_grad()
    def _examples(self, batch):
        """Returns inputs and targets."""
        chance = Chance(self.plan.seed, batch, self.device)
        views = draw(self.pools, self.plan.batch, self.body, SIZE, chance, self.plan.is_plain(batch))
        depth = damaged(views, self.body, chance)
        off = chance.between(1 - WRONG_FOCAL, 1 + WRONG_FOCAL, len(views))
        focal = torch.where(chance.share(len(views)) < WRONG_FOCAL_SHARE, views.focal * off, views.focal)
        return inputs_of(depth, focal), targets_of(views, depth, self.body)

    def _some_inputs(self):
        self._load()
        return padded(torch.cat([self._examples(batch)[0] for batch in range(LOOKED_AT_BATCHES)]))

    def _learn(self, network, optimiser, batch):
        """Learns from a batch. Returns the losses by name."""
        inputs, targets = self._examples(batch)
        for group in optimiser.param_groups:
            group["lr"] = self.plan.rate_at(batch)
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.plan.bf16):
            answers = answer(network, inputs)
        losses = losses_of(answers, targets, self.weights)
        optimiser.zero_grad(set_to_none=True)
        sum(WEIGHTS[name] * loss for name, loss in losses.items()).backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), LONGEST_GRADIENT)
        optimiser.step()
        return {name: loss.detach() for name, loss in losses.items()}

    @torch.no_grad()
    def _average(self):
        kept = self.plan.kept_of_average(self.batch)
        means, news = (list(weights.floats(network.state_dict()).values()) for network in (self.average, self.network))
        torch._foreach_lerp_(means, news, 1 - kept)

    def step(self):
        """Learns from the next batch. Returns the losses by name."""
        self._load()
        self.network.train()
        losses = self._learn(self.network, self.optimiser, self.batch)
        self._average()
        self.batch += 1
        return losses

    def figures(self):
        """Returns the averaged weights' Figures on the held-out frames, or nothing where there are none."""
        if not self.held_out:
            return None
        if self.held_out_pools is None:
            self.held_out_pools = read_pools(self.held_out, self.body, self.device)
        return figures_of(self.average, self.held_out_pools, self.body)

    def estimate(self):
        """Returns what is left to do and about how long it takes, in lines. A copy learns from some batches for it."""
        self._load()
        network = copy.deepcopy(self.network).train()
        optimiser = self._optimiser(network)
        self._learn(network, optimiser, self.batch)
        start = time.monotonic()
        for i in range(MEASURED_BATCHES):
            losses = self._learn(network, optimiser, self.batch + i)
        [float(loss) for loss in losses.values()]  # waits for the card
        seconds = (time.monotonic() - start) / MEASURED_BATCHES
        left = self.plan.batches - self.batch
        count = sum(p.numel() for p in self.network.parameters())
        precision = "bf16" if self.plan.bf16 else "float32"
        memory = "all of them in memory" if self.rounds.at_once else f"{self.rounds.room} of them in memory at a time"
        return (
            f"network   {self.plan.config}, {count / 1e6:.2f} million weights, "
            f"{multiply_adds(self.average) / 1e6:.0f} million multiply-adds a picture of 320x256\n"
            f"frames    {self.rounds.frames}, {memory}\n"
            f"views     {left * self.plan.batch} of {self.plan.batches * self.plan.batch} left, {self.plan.batch} at a "
            f"time, on {self.device.type} in {precision}, {self.plan.batch / seconds:.1f} views/s\n"
            f"time      about {duration(seconds * left)}"
        )

    def run(self, figures_every, stopped=lambda: False):
        """Learns from all batches that are left, and writes where it stands. Returns False if it was stopped before."""
        progress = Progress(self.plan, self.batch, self.tell)
        next_figures = (self.batch * self.plan.batch // figures_every + 1) * figures_every
        saved = time.monotonic()
        while self.batch < self.plan.batches and not stopped():
            progress.add(self.step(), self.batch)
            if self.batch * self.plan.batch >= next_figures and self.batch < self.plan.batches:
                next_figures += figures_every
                progress.say(self.batch)
                self._tell_figures()
                progress.begin(self.batch)
            if time.monotonic() - saved > SAVED_EVERY_S:
                self.save()
                saved = time.monotonic()
        progress.say(self.batch)
        self.save()
        if self.batch < self.plan.batches:
            return False
        self._tell_figures()
        return True

    def _tell_figures(self):
        if figures := self.figures():
            self.tell(f"held out  after {self.batch * self.plan.batch} views: {figures}")


class Progress:
    """Says now and then how far a training is. Losses that are not finite end it."""

    def __init__(self, plan, batch, tell):
        self.plan, self.tell = plan, tell
        self.begin(batch)

    def begin(self, batch):
        self.since, self.first, self.sums = time.monotonic(), batch, {}

    def add(self, losses, batch):
        for name, loss in losses.items():
            self.sums[name] = self.sums.get(name, 0) + loss
        if time.monotonic() - self.since > TOLD_EVERY_S:
            self.say(batch)

    def say(self, batch):
        count = batch - self.first
        if count == 0:
            return
        means = {name: float(total) / count for name, total in self.sums.items()}
        if not all(map(math.isfinite, means.values())):
            raise InputError(f"losses are not finite after {batch * self.plan.batch} views: expected a smaller --rate")
        seconds = (time.monotonic() - self.since) / count
        left = duration(seconds * (self.plan.batches - batch))
        losses = ", ".join(f"{name} {mean:.3f}" for name, mean in means.items())
        speed = self.plan.batch / seconds
        done = f"{batch * self.plan.batch} of {self.plan.batches * self.plan.batch}"
        self.tell(f"views     {done}, {speed:.1f}/s, {left} left; losses: {losses}")
        self.begin(batch)
