"""`python -m vesalius_network DATA... --out FOLDER`: learns a network (README.md)."""

import argparse
import ctypes
import os
import signal
import sys
from pathlib import Path

import torch

from .errors import InputError
from .nets import CONFIGS
from .quantise import MOST_FRAMES, write_network
from .train import Plan, Training

BATCH = {"cuda": 192, "cpu": 16}
RATE, RATE_BATCH = 3e-3, 192  # batches of another size have a rate as its square root
FIGURES, LEAST_BETWEEN = 20, 2000  # times in a training; views from one to the next
STOPPED = 130  # exit code
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # of mallopt, glibc


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="vesalius_network", description="Learns a network that labels depth pictures from labelled frames."
    )
    parser.add_argument("data", nargs="+", help="folders that `vesalius synth --out` wrote")
    parser.add_argument("--out", required=True, help="folder for network.npz; a training in it goes on")
    parser.add_argument("--held-out", nargs="+", default=[], metavar="DATA", help="folders to measure it on")
    parser.add_argument("--config", choices=CONFIGS, default="default", help="size of the network (%(default)s)")
    parser.add_argument("--views", type=int, default=Plan.views, help="pictures to learn from (%(default)s)")
    parser.add_argument("--batch", type=int, help="pictures at once (192 on a card, else 16)")
    parser.add_argument("--rate", type=float, help="learning rate (3e-3 times the root of batch / 192)")
    parser.add_argument("--seed", type=int, default=Plan.seed, help="of all that is random (%(default)s)")
    parser.add_argument("--init", default="", metavar="FILE", help="weights (.npz) or a model to begin with")
    parser.add_argument("--device", default="auto", help="cpu, cuda, cuda:N or auto, a card where one works")
    parser.add_argument("--precision", choices=["auto", "bf16", "float32"], default="auto", help="of products")
    parser.add_argument("--threads", type=int, help="of the processor (all)")
    parser.add_argument("--memory", type=float, help="GiB for frames (half of the card's or the machine's)")
    parser.add_argument("--figures-every", type=int, metavar="VIEWS", help="between measurements (a twentieth)")
    parser.add_argument("--estimate", action="store_true", help="only say how long it takes")
    parser.add_argument("--restart", action="store_true", help="forget the training in the folder")
    options = parser.parse_args(arguments)
    for name in ("views", "batch", "rate", "threads", "memory", "figures_every"):
        value = getattr(options, name)
        if value is not None and not value > 0:
            parser.error(f"--{name.replace('_', '-')} {value}: expected more than 0")
    return options


def device_of(name):
    if name == "auto":
        name = "cuda" if torch.cuda.is_available() else "cpu"
    kind, _, number = name.partition(":")
    if kind not in BATCH or (number and not (kind == "cuda" and number.isdigit())):
        raise InputError(f"--device {name}: expected cpu, cuda, cuda:N or auto")
    if kind == "cuda" and int(number or 0) >= torch.cuda.device_count():
        raise InputError(f"--device {name}: PyTorch sees {torch.cuda.device_count()} cards")
    return torch.device(name)


def takes_bf16(device):
    """Returns whether products in bf16 are quicker there: on cards, and on processors that have them."""
    if device.type == "cuda":
        return torch.cuda.is_bf16_supported()
    return any(getattr(torch.cpu, name, bool)() for name in ("_is_avx512_bf16_supported", "_is_amx_tile_supported"))


def memory_of(device):
    if device.type == "cuda":
        return torch.cuda.get_device_properties(device).total_memory
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def plan_of(options, device):
    batch = min(options.batch or BATCH[device.type], options.views)
    rate = options.rate or RATE * (batch / RATE_BATCH) ** 0.5
    bf16 = takes_bf16(device) if options.precision == "auto" else options.precision == "bf16"
    return Plan(options.config, options.views, batch, rate, options.seed, bf16, options.init)


def keep_freed_memory():
    """Pictures of a batch come and go: giving their memory back each time takes an eighth of a processor's time."""
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(M_MMAP_THRESHOLD, 2**25)
        mallopt(M_TRIM_THRESHOLD, 2**31 - 1)


class Signals:
    """Notes that the user wants an end, so that the batch at hand is finished and saved."""

    def __init__(self):
        self.came = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._note)

    def _note(self, *_):
        self.came = True


def run(options):
    keep_freed_memory()
    if options.threads:
        torch.set_num_threads(options.threads)
    device = device_of(options.device)
    torch.backends.cudnn.benchmark = True
    plan = plan_of(options, device)
    memory = options.memory * 2**30 if options.memory else memory_of(device) / 2
    if options.restart:
        (Path(options.out) / "training.pt").unlink(missing_ok=True)

    def tell(text):
        print(text, flush=True)

    network = Path(options.out) / "network.network"
    training = Training(plan, options.data, options.held_out, options.out, device, memory, tell)
    if training.batch == plan.batches and network.exists():
        tell(f"{network}: made already")
        return 0
    tell(training.estimate())
    if options.estimate:
        return 0
    signals = Signals()
    if training.run(options.figures_every or max(LEAST_BETWEEN, plan.views // FIGURES), lambda: signals.came):
        write_network(network.with_suffix(".npz"), options.data, network, MOST_FRAMES)
        tell(f"{network}: learnt from {plan.batches * plan.batch} views")
        return 0
    tell(f"stopped after {training.batch * plan.batch} views; the same command goes on")
    return STOPPED


def main():
    try:
        return run(parse(sys.argv[1:]))
    except (InputError, OSError) as error:
        print(f"vesalius_network: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
