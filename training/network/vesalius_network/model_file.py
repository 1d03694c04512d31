"""Model files and their networks of integers (docs/formats.md)."""

from pathlib import Path

import numpy as np

from .errors import InputError
from .quantise import Convolution
from .shards import Bytes

MAGIC, VERSION = b"\x89VSL\r\n\x1a\n", 3


def read_sections(path):
    """Returns the sections of a model file by name: what each was made from, a text, and its bytes."""
    file = Bytes(Path(path).read_bytes(), path)
    if bytes(file.take(len(MAGIC))) != MAGIC:
        file.fail("no model file")
    version, count, _, _ = file.numbers("HHIQ")
    if version != VERSION:
        raise InputError(f"{path}: version {version} of model files, expected {VERSION}, which `vesalius convert` makes")
    heads = []
    for _ in range(count):
        name, _, made_from, (size, _) = file.text().decode(), file.numbers("HH"), file.text().decode(), file.numbers("QQ")
        heads.append((name, made_from, size))
    return {name: (made_from, bytes(file.take(size))) for name, made_from, size in heads}


def read_network(content, place="network"):
    """Returns the convolutions of a section `network`, and those of the classes, the person and the parts' centres: -1 where
    there are none, as in a section of version 1."""
    file, convolutions = Bytes(content, place), []
    for _ in range(file.numbers("H")[0]):
        source, side, stride, inputs, outputs, added, added_scale, wide = file.numbers("HBBHHHfB")
        scale, offset = (np.frombuffer(file.take(4 * outputs), "<f4") for _ in range(2))
        weights = np.frombuffer(file.take(outputs * side * side * inputs), np.int8)
        weights = weights.reshape(outputs, side, side, inputs).transpose(0, 3, 1, 2)
        added = max(0, added - 1)
        convolutions.append(Convolution(source, stride, added, added_scale, bool(wide), scale, offset, weights))
    classes, person = file.numbers("HH")
    centres = file.numbers("H")[0] - 1 if file.at < len(file.data) else -1
    return convolutions, classes, person, centres
