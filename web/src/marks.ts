// What can be shown of people besides their skeletons: names of joints, axes of bones, angles of joints.
import { FoundPoint, Person, Xyz } from './protocol';
import { Skeletons } from './skeleton';

const ANGLE_SET = 'nite15';
const AXIS_M = 0.09;

/** Joints whose angle is told, each with the two points between which it is. */
export const ANGLES: [name: string, from: string, to: string][] = ['l', 'r'].flatMap((side): [string, string, string][] => [
  [`${side}_shoulder`, `${side}_elbow`, `${side}_hip`],
  [`${side}_elbow`, `${side}_shoulder`, `${side}_hand`],
  [`${side}_hip`, `${side}_shoulder`, `${side}_knee`],
  [`${side}_knee`, `${side}_hip`, `${side}_foot`],
]);

/** "l_upper_arm" as "left upper arm". */
export function inWords(name: string): string {
  return name.replace(/^l_/, 'left ').replace(/^r_/, 'right ').replaceAll('_', ' ');
}

/** A text at a place, to the right of it or to the left, away from the body. */
export interface Mark {
  xyz: Xyz;
  text: string;
  isLeft: boolean;
}

/** Three axes of a bone about its head: x, y and z. */
export interface Axes {
  at: Xyz;
  ends: Xyz[];
}

export interface JointAngle {
  name: string;
  xyz: Xyz;
  degrees: number;
  /** Whether all three points were observed. */
  seen: boolean;
}

/** Colours of x, y and z. */
export const AXIS_COLOURS: [number, number, number][] = [
  [235, 70, 60],
  [70, 200, 90],
  [80, 140, 255],
];

function angleAt(at: Xyz, a: Xyz, b: Xyz): number {
  const u = a.map((value, i) => value - at[i]);
  const v = b.map((value, i) => value - at[i]);
  const dot = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  const cosine = dot / (Math.hypot(...u) * Math.hypot(...v));
  return (180 / Math.PI) * Math.acos(Math.min(Math.max(cosine, -1), 1));
}

/** The angles of shoulders, elbows, hips and knees, 180 degrees where the limb is straight. */
export function anglesOf(person: Person, smoothed = false): JointAngle[] {
  const joints: Record<string, FoundPoint> = (smoothed ? person.smoothed?.[ANGLE_SET] : null) ?? person.joints[ANGLE_SET] ?? {};
  return ANGLES.flatMap(([name, from, to]) => {
    const [at, a, b] = [joints[name], joints[from], joints[to]];
    if (!at?.xyz_m || !a?.xyz_m || !b?.xyz_m) return [];
    const seen = [at, a, b].every((point) => point.state === 'observed');
    return [{ name, xyz: at.xyz_m, degrees: angleAt(at.xyz_m, a.xyz_m, b.xyz_m), seen }];
  });
}

export function angleText({ degrees, seen }: JointAngle): string {
  return `${seen ? '' : '≈ '}${Math.round(degrees)}°`;
}

/** What is chosen to be shown. */
export class Marks {
  names = false;
  axes = false;
  angles = false;

  constructor(private readonly skeletons: Skeletons) {}

  /** Names of the joints, or of the body's parts where those are drawn, and angles at their joints. */
  textsOf(person: Person): Mark[] {
    const { choice } = this.skeletons;
    const texts = new Map<string, { xyz: Xyz; words: string[] }>();
    const at = (name: string, xyz: Xyz): string[] => {
      const there = texts.get(name) ?? { xyz, words: [] };
      texts.set(name, there);
      return there.words;
    };
    if (this.names) {
      for (const { name, xyz } of this.skeletons.named(person)) at(name, xyz).push(inWords(name));
    }
    if (this.angles) {
      for (const angle of anglesOf(person, choice === 'smoothed')) at(angle.name, angle.xyz).push(angleText(angle));
    }
    const all = [...texts.values()];
    const middle = all.reduce((sum, { xyz }) => sum + xyz[0], 0) / all.length;
    return all.map(({ xyz, words }) => ({ xyz, text: words.join(' '), isLeft: xyz[0] < middle }));
  }

  axesOf(person: Person): Axes[] {
    if (!this.axes) return [];
    return Object.values(person.body?.bones ?? {}).map(({ head_m, global_xyzw }) => ({
      at: head_m,
      ends: columns(global_xyzw).map((axis) => head_m.map((value, i) => value + AXIS_M * axis[i]) as Xyz),
    }));
  }
}

/** The axes of a frame that a unit quaternion turns. */
function columns([x, y, z, w]: [number, number, number, number]): Xyz[] {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
}
