// What packs the pictures of a frame (docs/formats.md).

/** Unpacks depth that RVL packed (Wilson, ISS 2017): numbers in groups of three bits, eight groups to a word. */
export function unpackRvl(bytes: DataView, pixels: number): Uint16Array {
  const depth = new Uint16Array(pixels);
  let byte = 0;
  let word = 0;
  let groups = 0;
  const number = (): number => {
    let value = 0;
    for (let shift = 0; ; shift += 3) {
      if (groups === 0) {
        word = bytes.getUint32(byte, true);
        byte += 4;
        groups = 8;
      }
      const group = word >>> 28;
      word <<= 4;
      --groups;
      value |= (group & 7) << shift;
      if ((group & 8) === 0) return value;
    }
  };
  let previous = 0;
  for (let at = 0; at < pixels; ) {
    at += number();
    if (at >= pixels) break;
    const end = Math.min(pixels, at + number());
    while (at < end) {
      const zigzag = number();
      previous += (zigzag >>> 1) ^ -(zigzag & 1);
      depth[at++] = previous;
    }
  }
  return depth;
}

/** Unpacks labels: runs of a value in one byte and a number of pixels in base 128. */
export function unpackRuns(bytes: Uint8Array, pixels: number): Uint8Array {
  const labels = new Uint8Array(pixels);
  let filled = 0;
  for (let at = 0; at < bytes.length; ) {
    const value = bytes[at++];
    let length = 0;
    for (let shift = 0; ; shift += 7) {
      const digit = bytes[at++];
      length |= (digit & 127) << shift;
      if (digit < 128) break;
    }
    labels.fill(value, filled, filled + length);
    filled += length;
  }
  return labels;
}
