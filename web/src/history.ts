// Measurements of people over time, as far as they were seen on this page.
import { ANGLES, anglesOf } from './marks';
import { Frame, Person, Xyz } from './protocol';
import { isHidden, numberOf, shownPeople } from './track';

/** More are not kept: an hour of one person at 30 frames a second. */
const MOST_SAMPLES = 108000;
/** Between frames that are farther apart nobody knows. */
const MOST_GAP_S = 2;
const SET = 'nite15';

/** What is measured; angles follow, in the order of ANGLES. */
export enum Measure {
  height,
  speed,
  score,
  confidence,
  angle,
}

/** NaN is what is not known. */
function measured(person: Person, floor: Frame['floor']): Float32Array {
  const joints = (person.smoothed ?? person.joints)[SET] ?? {};
  const place = (name: string): Xyz | null => joints[name]?.xyz_m ?? null;
  const values = new Float32Array(Measure.angle + ANGLES.length).fill(NaN);
  const head = place('head');
  if (head && floor) values[Measure.height] = floor.offset_m - head.reduce((sum, value, i) => sum + value * floor.normal[i], 0);
  if (person.velocity_m_s) values[Measure.speed] = Math.hypot(...person.velocity_m_s);
  const all = Object.values(joints);
  values[Measure.score] = 100 * person.score;
  values[Measure.confidence] = (100 * all.reduce((sum, joint) => sum + joint.confidence, 0)) / all.length;
  for (const angle of anglesOf(person, true)) values[Measure.angle + ANGLES.findIndex(([name]) => name === angle.name)] = angle.degrees;
  return values;
}

interface Moment {
  at_s: number;
  people: Map<number, Float32Array>;
}

/** What a curve is drawn of: times, and for each measure the values, null where there is a gap. */
export interface Series {
  at_s: number[];
  values: (number | null)[][];
}

/** A frame that is shown again takes the place of what was known of its time. Where too much is known, what is farthest from now goes. */
export class History {
  private moments: Moment[] = [];
  private samples = 0;
  private readonly counts = new Map<number, number>();

  clear(): void {
    this.moments = [];
    this.samples = 0;
    this.counts.clear();
  }

  /** The people of whom something is known, by their numbers. */
  people(): number[] {
    return [...this.counts.keys()].sort((a, b) => a - b);
  }

  size(): number {
    return this.samples;
  }

  first_s(): number | null {
    return this.moments[0]?.at_s ?? null;
  }

  add(frame: Frame): void {
    const people = new Map<number, Float32Array>();
    for (const person of shownPeople(frame.found)) {
      if (!isHidden(person)) people.set(numberOf(person), measured(person, frame.floor));
    }
    const at = this.find(frame.at_s);
    const isThere = this.moments[at]?.at_s === frame.at_s;
    if (isThere) this.count(this.moments[at], -1);
    const moment = { at_s: frame.at_s, people };
    this.moments.splice(at, isThere ? 1 : 0, moment);
    this.count(moment, 1);
    while (this.samples > MOST_SAMPLES && this.moments.length > 1) {
      const last = this.moments[this.moments.length - 1];
      const isEarlyFarther = frame.at_s - this.moments[0].at_s > last.at_s - frame.at_s;
      this.count(isEarlyFarther ? this.moments[0] : last, -1);
      if (isEarlyFarther) this.moments.shift();
      else this.moments.pop();
    }
  }

  /** What is known of somebody in a stretch of time. */
  series(person: number, from_s: number, to_s: number, measures: number[]): Series {
    const series: Series = { at_s: [], values: measures.map(() => []) };
    const push = (at_s: number, values: Float32Array | undefined): void => {
      series.at_s.push(at_s);
      measures.forEach((measure, i) => {
        const value = values ? values[measure] : NaN;
        series.values[i].push(Number.isNaN(value) ? null : value);
      });
    };
    for (let i = Math.max(this.find(from_s) - 1, 0); i < this.moments.length; ++i) {
      const { at_s, people } = this.moments[i];
      const before = series.at_s[series.at_s.length - 1];
      if (at_s - before > MOST_GAP_S) push((at_s + before) / 2, undefined);
      push(at_s, people.get(person));
      if (at_s > to_s) break;
    }
    return series;
  }

  /** The last values at or before a time, if the person was seen then. */
  at(person: number, at_s: number): Float32Array | null {
    const moment = this.moments[this.find(at_s + 1e-6) - 1];
    return (moment && at_s - moment.at_s <= MOST_GAP_S && moment.people.get(person)) || null;
  }

  /** The index of the first moment not before a time. */
  private find(at_s: number): number {
    let [low, high] = [0, this.moments.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.moments[middle].at_s < at_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  private count({ people }: Moment, by: number): void {
    this.samples += by * (1 + people.size);
    for (const id of people.keys()) {
      const count = (this.counts.get(id) ?? 0) + by;
      if (count > 0) this.counts.set(id, count);
      else this.counts.delete(id);
    }
  }
}
