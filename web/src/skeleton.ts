// What is drawn of a person: points and the lines between them.
import { Body, BoneFacts, CameraFacts, Person, State, Xyz } from './protocol';
import { isHidden } from './track';

export type SkeletonChoice = 'bones' | 'smoothed' | 'joints' | 'parts' | 'none';

export interface SkeletonPoint {
  xyz: Xyz;
  state: State;
  confidence: number;
}

export interface SkeletonLines {
  points: (SkeletonPoint | null)[];
  links: [number, number][];
}

/** The joint set that is drawn, and its lines. */
const DRAWN_SET = 'nite15';
const JOINT_LINKS = [
  'head neck', 'neck torso',
  'neck l_shoulder', 'l_shoulder l_elbow', 'l_elbow l_hand', 'torso l_hip', 'l_hip l_knee', 'l_knee l_foot',
  'neck r_shoulder', 'r_shoulder r_elbow', 'r_elbow r_hand', 'torso r_hip', 'r_hip r_knee', 'r_knee r_foot',
].map((names) => names.split(' '));

/** Chooses and makes skeletons. */
export class Skeletons {
  choice: SkeletonChoice = 'parts';
  private links: [number, number][] = [];
  private parts: string[] = [];
  private bones: BoneFacts[] = [];

  setBody(body: Body, bones: BoneFacts[]): void {
    this.links = body.links;
    this.parts = body.parts.map((part) => part.name);
    this.bones = bones;
  }

  /** Where there is not what was chosen, parts are drawn. */
  of(person: Person): SkeletonLines {
    const drawn = this.chosen(person) ?? this.ofParts(person);
    if (isHidden(person)) for (const point of drawn.points) if (point) point.state = 'predicted';
    return drawn;
  }

  /** What has a name at its place: parts where they are drawn, otherwise joints, which bones have at their heads. */
  named(person: Person): { name: string; xyz: Xyz }[] {
    const joints = (this.choice === 'smoothed' ? person.smoothed : undefined) ?? person.joints;
    const points = (this.choice !== 'parts' && joints[DRAWN_SET]) || person.parts;
    return Object.entries(points).flatMap(([name, { xyz_m }]) => (xyz_m ? [{ name, xyz: xyz_m }] : []));
  }

  private chosen(person: Person): SkeletonLines | null {
    switch (this.choice) {
      case 'none':
        return { points: [], links: [] };
      case 'bones':
        return this.ofBones(person);
      case 'smoothed':
        return Skeletons.ofJoints(person.smoothed);
      case 'joints':
        return Skeletons.ofJoints(person.joints);
      default:
        return null;
    }
  }

  private ofParts(person: Person): SkeletonLines {
    const points = this.parts.map((name) => {
      const { xyz_m, state, confidence } = person.parts[name];
      return xyz_m && { xyz: xyz_m, state, confidence };
    });
    return { points, links: this.links };
  }

  /** Heads of bones, each joined to that of its parent, and the tails of the last ones. */
  private ofBones(person: Person): SkeletonLines | null {
    if (!person.body) return null;
    const points: (SkeletonPoint | null)[] = [];
    const links: [number, number][] = [];
    this.bones.forEach(({ name, parent }, b) => {
      const bone = person.body?.bones[name];
      points[b] = bone ? { xyz: bone.head_m, state: bone.state, confidence: bone.confidence } : null;
      if (parent >= 0) links.push([parent, b]);
    });
    this.bones.forEach(({ name }, b) => {
      const bone = person.body?.bones[name];
      if (!bone || this.bones.some(({ parent }) => parent === b)) return;
      links.push([b, points.length]);
      points.push({ xyz: bone.tail_m, state: bone.state, confidence: bone.confidence });
    });
    return { points, links };
  }

  private static ofJoints(sets: Person['joints'] | undefined): SkeletonLines | null {
    const joints = sets?.[DRAWN_SET];
    if (!joints) return null;
    const names = Object.keys(joints);
    const points = names.map((name) => {
      const { xyz_m, state, confidence } = joints[name];
      return xyz_m && { xyz: xyz_m, state, confidence };
    });
    const links = JOINT_LINKS.map(([a, b]): [number, number] => [names.indexOf(a), names.indexOf(b)]);
    return { points, links };
  }
}

export function isSeen(a: SkeletonPoint, b: SkeletonPoint): boolean {
  return a.state === 'observed' && b.state === 'observed';
}

/** Column and row of a point; null behind the camera. */
export function project([x, y, z]: Xyz, { fx, fy, cx, cy }: CameraFacts): [number, number] | null {
  return z > 0 ? [(x / z) * fx + cx, (y / z) * fy + cy] : null;
}
