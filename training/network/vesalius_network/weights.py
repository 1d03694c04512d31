"""Files of networks: a .npz with an array for each parameter under its name in nets.py, and `about`, a JSON text:
`config` (nets.CONFIGS), `classes`, `body` (TOML), `made_from` (how it was learnt). Weights are averaged ones."""

import argparse
import hashlib
import io
import json
import sys
from pathlib import Path

import numpy as np
import torch

from .body import read_body
from .errors import InputError
from .nets import CONFIGS, PERSON, Network

# Names of configurations in files of weights that were learnt before this tool.
OLD_CONFIGS = {"f": "small", "g": "default"}


def write_whole(path, data):
    """Writes a file beside its place and renames it."""
    beside = Path(f"{path}.tmp")
    beside.write_bytes(data)
    beside.replace(path)


def floats(state):
    """Returns the parameters of a state that are numbers to learn, or their statistics."""
    return {name: value for name, value in state.items() if value.is_floating_point()}


def save(path, config, body, state, made_from):
    about = {"config": config, "classes": body.classes, "made_from": made_from, "body": body.text}
    arrays = {name: value.cpu().numpy() for name, value in floats(state).items()}
    memory = io.BytesIO()
    np.savez(memory, about=np.array(json.dumps(about)), **arrays)
    write_whole(path, memory.getvalue())


def _read_npz(path):
    with np.load(path) as arrays:
        about = json.loads(str(arrays["about"]))
        return about, {name: torch.from_numpy(arrays[name]).float() for name in arrays.files if name != "about"}


def _read_old(path):
    """Reads what torch.save wrote of `ema`, averaged weights in halves. Their heads have rows that nobody uses."""
    file = torch.load(path, map_location="cpu", weights_only=True)
    state = {name: value.float() for name, value in floats(file["ema"]).items()}
    parts = state["labels.bias"].shape[0] - 1
    for head, rows in (("inst", PERSON), ("joints", 3 * parts)):
        for name in (f"{head}.weight", f"{head}.bias"):
            state[name] = state[name][:rows].clone()
    made_from = f"SHA-256 of the averaged weights: {hashlib.sha256(path.read_bytes()).hexdigest()}"
    return {"config": OLD_CONFIGS[file["config"]], "classes": parts + 1, "made_from": made_from, "body": ""}, state


def load(path):
    """Returns what a file says of itself and its parameters. Takes a .npz of `save`, or a .pt from before."""
    path = Path(path)
    try:
        return _read_old(path) if path.suffix == ".pt" else _read_npz(path)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or 'expected the weights of a network'}") from error
    except Exception as error:
        raise InputError(f"{path}: expected the weights of a network, a .npz of this tool") from error


def network_of(path, body=None):
    """Returns a network with the weights of a file, and its body, which a .pt does not tell."""
    about, state = load(path)
    body = body or read_body(about["body"], path)
    network = Network(CONFIGS[about["config"]], body.parts)
    network.load_state_dict(state, strict=False)
    return network.eval(), body


def convert(old, new, body):
    """Writes a .npz of a .pt."""
    about, state = load(old)
    save(new, about["config"], body, state, about["made_from"])


def main(arguments):
    parser = argparse.ArgumentParser(description="Writes the weights of a .pt as .npz.")
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--body", required=True, help="the body model whose parts it labels (TOML)")
    options = parser.parse_args(arguments)
    try:
        convert(options.old, options.new, read_body(Path(options.body).read_text(), options.body))
    except (InputError, OSError) as error:
        sys.exit(f"vesalius_network: {error}")


if __name__ == "__main__":
    main(sys.argv[1:])
