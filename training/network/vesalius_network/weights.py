"""Files of networks: a .npz with an array for each parameter under its name in nets.py, and `about`, a JSON text:
`config` (nets.CONFIGS), `classes`, `body` (TOML), `made_from` (how it was learnt). Weights are averaged ones."""

import io
import json
from pathlib import Path

import numpy as np
import torch

from .errors import InputError


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


def load(path):
    """Returns what a file says of itself and its parameters."""
    path = Path(path)
    try:
        with np.load(path) as arrays:
            about = json.loads(str(arrays["about"]))
            return about, {name: torch.from_numpy(arrays[name]).float() for name in arrays.files if name != "about"}
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or 'expected the weights of a network'}") from error
    except Exception as error:
        raise InputError(f"{path}: expected the weights of a network, a .npz of this tool") from error
