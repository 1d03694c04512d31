// The distance between two points that are clicked.
import { Found, Xyz } from './protocol';

type Vector = [number, number, number];

export interface Difference {
  distance: number;
  /** To the right, upwards and away from the camera. Metres; their squares add up to that of the distance. */
  across: number;
  up: number;
  depth: number;
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** The part of `v` that is at right angles to the unit vector `n`, with length 1. */
function across(v: Vector, n: Vector): Vector {
  const flat = v.map((value, i) => value - dot(v, n) * n[i]) as Vector;
  const length = Math.hypot(...flat);
  return flat.map((value) => value / length) as Vector;
}

/** From `a` to `b`, both in the optical frame; `up` is a unit vector in it. */
export function difference(a: Xyz, b: Xyz, up: Xyz): Difference {
  const by = b.map((value, i) => value - a[i]) as Vector;
  // Of a camera that looks straight down the top of the picture is ahead.
  const ahead = across(Math.abs(up[2]) < 0.999 ? [0, 0, 1] : [0, -1, 0], up);
  return { distance: Math.hypot(...by), across: dot(by, cross(ahead, up)), up: dot(by, up), depth: dot(by, ahead) };
}

const UP_OF_CAMERA: Xyz = [0, -1, 0];

/** Two points, one after the other. A third begins anew. */
export class Measure {
  points: Xyz[] = [];

  add(point: Xyz): void {
    this.points = this.points.length === 2 ? [point] : [...this.points, point];
  }

  /** Up is away from the floor where it is known, otherwise that of the picture. */
  text(found: Found | null, isOn: boolean): string {
    const [a, b] = this.points;
    if (!a) return isOn ? 'Measure: choose two points in the 3-D view or in the picture.' : '';
    if (!b) return `From ${a[2].toFixed(2)} m away to: choose the second point. Escape clears.`;
    const floor = found?.floor?.up;
    const { distance, ...along } = difference(a, b, floor ?? UP_OF_CAMERA);
    const signed = (metres: number): string => `${metres < 0 ? '−' : '+'}${Math.abs(metres).toFixed(3)}`;
    const parts = [`across ${signed(along.across)}`, `up ${signed(along.up)}`, `depth ${signed(along.depth)}`];
    return `${distance.toFixed(3)} m: ${parts.join(', ')} m, ${floor ? 'level with the floor' : 'as the camera stands'}. Escape clears.`;
  }
}
