"""Reads labelled datasets, which `vesalius synth --out DIR` writes (docs/formats.md, "Labelled dataset")."""

import json
import struct
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import zstandard

from .body import read_body
from .errors import InputError

VERSION = 3
MAGIC = b"\x89VSD\r\n\x1a\n"
HEADER = struct.Struct("<8sHHIQQQ")
ENTRY = struct.Struct("<IQ")
BACKGROUND = 255
HAS_COLOUR, HAS_TIME, HAS_UP, HAS_POSTURES, HAS_HEIGHT, HAS_POSE = 1, 2, 4, 8, 16, 32
MOST_PIXELS = 1 << 26
ESCAPE = 255  # this symbol's number stands among the wide steps
FRAMES_AT_ONCE = 32  # whose diagonals fit into a processor's cache


class Bytes:
    """Reads little-endian numbers one after the other."""

    def __init__(self, data, place):
        self.data, self.at, self.place = memoryview(data), 0, place

    def fail(self, what):
        raise InputError(f"{self.place}: damaged at byte {self.at}: {what}")

    def take(self, count):
        if count > len(self.data) - self.at:
            self.fail(f"expected {count} bytes, {len(self.data) - self.at} are left")
        self.at += count
        return self.data[self.at - count : self.at]

    def numbers(self, form):
        form = struct.Struct("<" + form)
        return form.unpack(self.take(form.size))

    def text(self):
        return bytes(self.take(self.numbers("I")[0]))

    def points(self, count):
        return np.frombuffer(self.take(12 * count), "<f4").reshape(count, 3)

    def stream(self, most):
        """Returns the bytes of a zstd frame, of which there may be at most so many."""
        size, packed = self.numbers("II")
        if size > most:
            self.fail(f"stream of {size} bytes, expected at most {most}")
        frame = self.take(packed)
        try:
            out = zstandard.ZstdDecompressor().decompress(frame, max_output_size=size) if size else b""
        except zstandard.ZstdError as error:
            self.fail(error)
        if len(out) != size:
            self.fail(f"stream of {len(out)} bytes, expected {size}")
        return np.frombuffer(out, np.uint8)


@dataclass
class Frames:
    """n frames."""

    depth_mm: np.ndarray  # [n, height, width] uint16, 0 = no reading
    labels: np.ndarray  # [n, height, width] uint8, 255 = background
    person: np.ndarray  # the same: index of the person
    camera: np.ndarray  # [n, 4] float32: fx, fy, cx, cy
    people: np.ndarray  # [n] number of people
    centres: np.ndarray  # [n, most people, parts, 3] float32 m, NaN = not known


@dataclass
class _Frame:
    """A frame whose depth is still in ranks."""

    size: tuple  # height, width
    camera: tuple
    centres: np.ndarray
    values: np.ndarray
    hole: np.ndarray
    step: np.ndarray
    labels: np.ndarray
    person: np.ndarray


def _varints(stream, source):
    """Returns the numbers of a stream: seven bits in each byte, the lowest first; the high bit says that more follow."""
    if not len(stream):
        return np.zeros(0, np.int64)
    last = np.flatnonzero(stream < 0x80)
    if not len(last) or last[-1] != len(stream) - 1:
        source.fail("number without an end")
    first = np.concatenate([[0], last[:-1] + 1]).astype(np.int64)
    if (last - first).max() > 2:
        source.fail("number of more than three bytes")
    padded = np.concatenate([stream, [0, 0]]).astype(np.int64)
    numbers = padded[first] & 0x7F
    for byte in (1, 2):
        numbers |= np.where(first + byte <= last, padded[first + byte] & 0x7F, 0) << (7 * byte)
    return numbers


def _read_depth(source, height, width):
    """Returns the values that occur with 0 before them, where the holes are, and the ranks less their predictions."""
    values = np.concatenate([[0], np.cumsum(_varints(source.stream(3 * MOST_PIXELS), source))])
    if values[-1] > 65535:
        source.fail("depth beyond 65535 mm")
    symbols = source.stream(height * width)
    if len(symbols) != height * width:
        source.fail("expected a symbol for each pixel")
    codes = symbols.astype(np.int32)
    wide = _varints(source.stream(3 * height * width), source)
    escaped = np.flatnonzero(symbols == ESCAPE)
    if len(escaped) != len(wide):
        source.fail(f"{len(wide)} wide steps, expected {len(escaped)}")
    codes[escaped] += wide.astype(np.int32)
    code = np.maximum(codes - 1, 0)
    return values.astype(np.uint16), codes == 0, (code >> 1) ^ -(code & 1)


def _read_plane(source, height, width):
    plane = source.stream(height * width)
    if len(plane) != height * width:
        source.fail("expected a byte for each pixel")
    return plane.reshape(height, width)


def _parse(data, parts, place):
    """Reads a frame but for its depth, colour, joints and circumstances."""
    source = Bytes(data, place)
    _, _, flags = source.numbers("QQB")
    source.text()
    source.numbers("d")
    width, height, *camera = source.numbers("2I4f")
    if not 0 < width * height <= MOST_PIXELS:
        source.fail(f"picture of {width}x{height}")
    (people,) = source.numbers("B")
    centres = source.points(people * parts).reshape(people, parts, 3)
    (joints,) = source.numbers("B")
    source.take(12 * people * joints)
    source.take(12 if flags & HAS_UP else 0)
    for _ in range(people if flags & HAS_POSTURES else 0):
        source.text()
    source.take((4 if flags & HAS_HEIGHT else 0) + (48 if flags & HAS_POSE else 0))
    values, hole, step = _read_depth(source, height, width)
    labels, person = _read_plane(source, height, width), _read_plane(source, height, width)
    if (labels[labels != BACKGROUND] >= parts).any() or (person[person != BACKGROUND] >= people).any():
        source.fail("label or person beyond those that there are")
    return _Frame((height, width), camera, centres, values, hole, step, labels, person)


def _ranks(hole, step):
    """Returns the ranks [n, height, width] of depth values from what they differ from their predictions by. A pixel is
    predicted from the ones left, above and left above, so a diagonal follows from the two before it: `table` has pixel
    (u, v) at [u + v + 2, v + 1], which lets all of a diagonal be computed at once."""
    frames, height, width = step.shape
    v, u = np.mgrid[:height, :width]
    steps = np.zeros((height + width - 1, height, frames), np.int32)
    holes = np.ones_like(steps, bool)
    steps[u + v, v], holes[u + v, v] = step.transpose(1, 2, 0), hole.transpose(1, 2, 0)
    table = np.zeros((height + width + 1, height + 1, frames), np.int32)
    last_left = np.ones((height, frames), np.int32)
    for diagonal in range(height + width - 1):
        first, end = max(0, diagonal - width + 1), min(height, diagonal + 1)
        left, above = table[diagonal + 1, first + 1 : end + 1], table[diagonal + 1, first:end]
        corner, last = table[diagonal, first:end], last_left[first:end]
        np.copyto(last, left, where=left != 0)
        low, high = np.minimum(left, above), np.maximum(left, above)
        both = np.where(corner == 0, (left + above) // 2, np.maximum(low, np.minimum(high, left + above - corner)))
        one = np.where(left != 0, left, np.where(above != 0, above, last))
        rank = np.where(low != 0, both, one) + steps[diagonal, first:end]
        rank[holes[diagonal, first:end]] = 0
        table[diagonal + 2, first + 1 : end + 1] = rank
    return table[u + v + 2, v + 1].transpose(2, 0, 1)


def _together(frames, parts, place):
    """Decodes the depth of frames of one size."""
    height, width = frames[0].size
    depth = np.empty((len(frames), height, width), np.uint16)
    for begin in range(0, len(frames), FRAMES_AT_ONCE):
        some = frames[begin : begin + FRAMES_AT_ONCE]
        shape = (len(some), height, width)
        ranks = _ranks(np.stack([f.hole for f in some]).reshape(shape), np.stack([f.step for f in some]).reshape(shape))
        for i, frame in enumerate(some):
            if ranks[i].min() < 0 or ranks[i].max() >= len(frame.values):
                raise InputError(f"{place}: damaged: depth that is not among its values")
            depth[begin + i] = frame.values[ranks[i]]
    people = np.array([len(f.centres) for f in frames])
    centres = np.full((len(frames), max(1, people.max()), parts, 3), np.nan, np.float32)
    for i, frame in enumerate(frames):
        centres[i, : people[i]] = frame.centres
    labels, person = np.stack([f.labels for f in frames]), np.stack([f.person for f in frames])
    return Frames(depth, labels, person, np.array([f.camera for f in frames], np.float32), people, centres)


class Dataset:
    """A folder of shards."""

    def __init__(self, folder):
        self.folder = Path(folder)
        path = self.folder / "dataset.json"
        try:
            about = json.loads(path.read_text())
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: expected the description of labelled frames: {error}") from error
        if about.get("format") != VERSION:
            raise InputError(f"{path}: format {about.get('format')}, expected {VERSION}")
        self.body = read_body(about["body"], path)
        self.frames, self.per_shard = about["frames"], about["frames_per_shard"]
        self.seed, self.hash, self.recipe = about["seed"], about["hash"], about["recipe"]

    @property
    def shards(self):
        return -(-self.frames // self.per_shard)

    def frames_of(self, shard):
        return min(self.per_shard, self.frames - shard * self.per_shard)

    @cached_property
    def size(self):
        """Height and width of the first frame, which all others must have as well."""
        return _parse(self._split(0)[0], self.body.parts, self.folder).size

    def read(self, shard):
        """Returns the Frames of a shard."""
        path = self._path(shard)
        packed = enumerate(self._split(shard))
        frames = [_parse(frame, self.body.parts, f"{path}, frame {i}") for i, frame in packed]
        for frame in frames:
            if frame.size != self.size:
                raise InputError(f"{path}: pictures of {frame.size[::-1]} pixels, expected {self.size[::-1]} in all")
        return _together(frames, self.body.parts, path)

    def _path(self, shard):
        return self.folder / f"{shard:06d}.shard"

    def _split(self, shard):
        """Returns the bytes of each frame."""
        path = self._path(shard)
        try:
            data = path.read_bytes()
        except OSError as error:
            raise InputError(f"{path}: {error.strerror}") from error
        source = Bytes(data, path)
        magic, version, _, count, made_by, _, size = HEADER.unpack(source.take(HEADER.size))
        if magic != MAGIC or version != VERSION:
            raise InputError(f"{path}: expected a shard of version {VERSION}")
        if f"{made_by:016x}" != self.hash:
            raise InputError(f"{path}: of another dataset than {self.folder / 'dataset.json'} describes")
        if size != len(data):
            raise InputError(f"{path}: {len(data)} bytes, expected {size}")
        if count != self.frames_of(shard):
            raise InputError(f"{path}: {count} frames, expected {self.frames_of(shard)}")
        sizes = [ENTRY.unpack(source.take(ENTRY.size))[0] for _ in range(count)]
        source.take(8)
        return [source.take(size) for size in sizes]
