import { Body } from './protocol';

export type Rgb = [number, number, number];

/** Colours of people: those of Okabe and Ito, which the colour-blind can tell. Numbers stand beside them anyway. */
const PEOPLE: Rgb[] = [
  [230, 159, 0],
  [86, 180, 233],
  [0, 158, 115],
  [204, 121, 167],
  [240, 228, 66],
  [213, 94, 0],
  [0, 114, 178],
];

/** From near to far: light yellow to dark blue, ever darker, so that it reads without hue as well. */
const DEPTH: Rgb[] = [
  [255, 234, 70],
  [188, 175, 111],
  [124, 123, 120],
  [64, 81, 110],
  [12, 40, 84],
];

const LIGHTNESSES = [46, 72, 58, 84];  // neighbours in the body's list differ

export function personColour(index: number): Rgb {
  return PEOPLE[index % PEOPLE.length];
}

export function css(colour: Rgb): string {
  return `rgb(${colour.join(' ')})`;
}

/** `share` is 0 for near and 1 for far. */
export function depthColour(share: number): Rgb {
  const at = Math.min(Math.max(share, 0), 1) * (DEPTH.length - 1);
  const from = Math.min(Math.floor(at), DEPTH.length - 2);
  const t = at - from;
  return DEPTH[from].map((value, i) => Math.round(value + t * (DEPTH[from + 1][i] - value))) as Rgb;
}

function fromHsl(hue: number, saturation: number, lightness: number): Rgb {
  const amount = saturation * Math.min(lightness, 1 - lightness);
  const channel = (n: number): number => {
    const k = (n + hue / 30) % 12;
    return Math.round(255 * (lightness - amount * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [channel(0), channel(8), channel(4)];
}

/**
 * Colours of body parts: those of the body model, or by side: left ones blue, right ones orange, those on the middle line
 * grey, which the colour-blind can tell.
 */
export function partColours(body: Body, bySide: boolean): Rgb[] {
  if (!bySide) return body.parts.map((part) => part.colour);
  let kinds = 0;
  const lightness = new Map<number, number>();
  return body.parts.map((part, index) => {
    const twin = lightness.get(part.mirror);
    const l = twin ?? LIGHTNESSES[kinds++ % LIGHTNESSES.length] / 100;
    lightness.set(index, l);
    if (part.mirror === index || part.mirror < 0) return fromHsl(0, 0, l);
    const isLeft = /^l(eft)?_/.test(part.name) || (!/^r(ight)?_/.test(part.name) && index < part.mirror);
    return isLeft ? fromHsl(211, 0.85, l) : fromHsl(28, 0.9, l);
  });
}

/** The depths in mm of the nearest and the farthest hundredth of the readings. */
export function depthRange(depth: Uint16Array): [number, number] {
  const counts = new Uint32Array(4096);
  let readings = 0;
  for (let i = 0; i < depth.length; i += 7) {
    if (depth[i] === 0) continue;
    ++counts[depth[i] >> 4];
    ++readings;
  }
  if (readings === 0) return [500, 5000];
  const at = (share: number): number => {
    let left = share * readings;
    const bin = counts.findIndex((count) => (left -= count) <= 0);
    return 16 * Math.max(bin, 0);
  };
  const near = at(0.01);
  return [near, Math.max(at(0.99) + 16, near + 100)];
}
