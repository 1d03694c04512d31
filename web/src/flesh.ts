// The surface of a fitted body's bones (docs/formats.md): ellipses joined by straight lines, with rounded ends.
import * as THREE from 'three';

const AROUND = 14;      // points of an ellipse
const ROUNDINGS = [-1, -0.92, -0.7, -0.38];  // sines of an end's rings, from its pole on

/** The points of many bones, and the triangles between them. Coordinates are those of the optical frame. */
export class FleshSurface {
  readonly places: number[] = [];
  readonly triangles: number[] = [];
  readonly tints: number[] = [];

  /** `tint` is red, green, blue and opacity, each 0 to 1. */
  add(bone: number[][], tint: number[]): void {
    const sections = bone.map((n) => ({
      centre: new THREE.Vector3(n[0], n[1], n[2]),
      first: new THREE.Vector3(n[3], n[4], n[5]),
      second: new THREE.Vector3(n[6], n[7], n[8]),
    }));
    const [head, tail] = [sections[0], sections[sections.length - 1]];
    const along = tail.centre.clone().sub(head.centre);
    const rings: { centre: THREE.Vector3; first: THREE.Vector3; second: THREE.Vector3 }[] = [];
    const round = (end: typeof head, sine: number): void => {
      const out = new THREE.Vector3().crossVectors(end.first, end.second).normalize();
      if (out.dot(along) < 0) out.negate();
      const reach = Math.min(end.first.length(), end.second.length());
      const narrow = Math.sqrt(1 - sine * sine);
      rings.push({
        centre: end.centre.clone().addScaledVector(out, sine * reach),
        first: end.first.clone().multiplyScalar(narrow),
        second: end.second.clone().multiplyScalar(narrow),
      });
    };
    for (const sine of ROUNDINGS) round(head, sine);
    rings.push(...sections);
    for (const sine of [...ROUNDINGS].reverse()) round(tail, -sine);
    const start = this.places.length / 3;
    const at = new THREE.Vector3();
    for (const { centre, first, second } of rings) {
      for (let i = 0; i < AROUND; ++i) {
        const angle = (2 * Math.PI * i) / AROUND;
        at.copy(centre).addScaledVector(first, Math.cos(angle)).addScaledVector(second, Math.sin(angle));
        this.places.push(at.x, at.y, at.z);
        this.tints.push(...tint);
      }
    }
    // Outwards is where the rings' order and their sense of turning say.
    const turns = new THREE.Vector3().crossVectors(head.first, head.second).dot(along) > 0;
    for (let r = 0; r + 1 < rings.length; ++r) {
      for (let i = 0; i < AROUND; ++i) {
        const [a, b] = [start + r * AROUND + i, start + r * AROUND + ((i + 1) % AROUND)];
        const [c, d] = [a + AROUND, b + AROUND];
        this.triangles.push(...(turns ? [a, b, c, b, d, c] : [a, c, b, b, c, d]));
      }
    }
  }
}
