// People over time.
import { Rgb, personColour } from './palette';
import { Found, Person, Xyz } from './protocol';

const TRAIL_S = 5;
const MOST_GAP_S = 0.5;  // between two points that are joined

/** The number by which a person is called: the id, or the index in the frame where people are not followed. */
export function numberOf(person: Person): number {
  return person.id ?? person.index;
}

export function isHidden(person: Person): boolean {
  return person.state === 'hidden';
}

/** The people to be shown: those who were given up in this frame are not. */
export function shownPeople(found: Found): Person[] {
  return found.people.filter((person) => person.state !== 'lost');
}

/** Colours by the index in the frame, as label pictures have it. */
export function coloursByIndex(found: Found): Rgb[] {
  const colours: Rgb[] = [];
  for (const person of found.people) colours[person.index] = personColour(numberOf(person));
  return colours;
}

interface TrailPoint {
  at_s: number;
  xyz: Xyz;
  hidden: boolean;
}

/** A piece of a trail; `age` is 0 now and 1 where the trail ends. */
export interface TrailPiece {
  from: Xyz;
  to: Xyz;
  age: number;
  hidden: boolean;
}

/** Where people's trunks were in the last seconds. A step back in time forgets what came later. */
export class TrackMemory {
  private readonly trails = new Map<number, TrailPoint[]>();

  clear(): void {
    this.trails.clear();
  }

  add(found: Found): void {
    const now = found.track_time_s;
    if (now === undefined) return;
    for (const [id, points] of this.trails) {
      const kept = points.filter((point) => point.at_s < now && point.at_s >= now - TRAIL_S);
      if (kept.length > 0) this.trails.set(id, kept);
      else this.trails.delete(id);
    }
    for (const person of shownPeople(found)) {
      if (person.id === undefined || !person.position_m || person.state === 'new') continue;
      const points = this.trails.get(person.id) ?? [];
      points.push({ at_s: now, xyz: person.position_m, hidden: isHidden(person) });
      this.trails.set(person.id, points);
    }
  }

  trail(person: Person): TrailPiece[] {
    const points = this.trails.get(numberOf(person)) ?? [];
    const pieces: TrailPiece[] = [];
    for (let i = 1; i < points.length; ++i) {
      const [a, b] = [points[i - 1], points[i]];
      if (b.at_s - a.at_s > MOST_GAP_S) continue;
      pieces.push({ from: a.xyz, to: b.xyz, age: (points[points.length - 1].at_s - a.at_s) / TRAIL_S, hidden: a.hidden || b.hidden });
    }
    return pieces;
  }
}
