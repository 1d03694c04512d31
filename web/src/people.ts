import { css, personColour } from './palette';
import { Body, Found, FoundPoint, Frame, Person } from './protocol';
import { angleText, anglesOf, inWords } from './marks';
import { isHidden, numberOf, shownPeople } from './track';

/** Makes an element with what is in it. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  content: (Node | string)[] = [],
  className = '',
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  made.append(...content);
  if (className) made.className = className;
  return made;
}

/** Distance along the optical axis: the median of the parts that were seen, else that of the trunk. Metres. */
function distance(person: Person): number | null {
  if (isHidden(person)) return person.position_m?.[2] ?? null;
  const z = Object.values(person.parts).flatMap((p) => (p.state === 'observed' && p.xyz_m ? [p.xyz_m[2]] : []));
  if (z.length === 0) return null;
  z.sort((a, b) => a - b);
  return z[Math.floor(z.length / 2)];
}

function yawText(person: Person): string {
  if (!person.yaw) return 'yaw unknown';
  const degrees = Math.round(person.yaw.degrees);
  const facing = Math.abs(degrees) <= 60 ? 'front' : Math.abs(degrees) >= 120 ? 'back' : 'side';
  return `yaw ${degrees}° (${facing})`;
}

const WAITING = 'waiting for the floor';

/** How somebody holds the body, which takes a floor to tell. */
function stanceText(person: Person, found: Found): string {
  if (person.stance !== 'unknown') return person.stance ?? '';
  return found.floor ? '' : WAITING;
}

/** What is known of a person over time. */
function trackText(person: Person, found: Found): string {
  const now_s = found.track_time_s ?? 0;
  const words = [person.state === 'hidden' ? `hidden for ${(now_s - (person.seen_s ?? now_s)).toFixed(1)} s` : person.state];
  const stance = stanceText(person, found);
  if (stance) words.push(stance);
  if (person.velocity_m_s) words.push(`${Math.hypot(...person.velocity_m_s).toFixed(1)} m/s`);
  if (person.body) words.push(`${person.body.stature_m.toFixed(2)} m tall`);
  return words.join(' · ');
}

function confidenceBar(point: FoundPoint): HTMLElement {
  const bar = element('meter', [`${Math.round(100 * point.confidence)} %`]);
  bar.min = 0;
  bar.max = 1;
  bar.value = point.confidence;
  bar.title = `right with a probability of ${Math.round(100 * point.confidence)} %`;
  return bar;
}

/** Why a point of a person is not observed, such as "behind person 2"; empty where that is not told. */
function unseenText(point: FoundPoint, person: Person, found: Found): string {
  if (point.unseen !== 'behind_person') return (point.unseen ?? '').replaceAll('_', ' ');
  const other = found.people.find(({ index }) => index === point.behind);
  return !other || other.index === person.index ? 'behind the own body' : `behind person ${numberOf(other)}`;
}

function stateText(point: FoundPoint, person: Person, found: Found): string {
  return point.unseen ? `${point.state}, ${unseenText(point, person, found)}` : point.state;
}

/** The parts that are not observed, by why they are not. */
function absentText(person: Person, body: Body, found: Found): string {
  const byReason = new Map<string, string[]>();
  for (const { name } of body.parts) {
    const part = person.parts[name];
    if (part.state === 'observed') continue;
    const why = unseenText(part, person, found);
    byReason.set(why, [...(byReason.get(why) ?? []), name]);
  }
  const texts = [...byReason].map(([why, names]) => (why ? `${why}: ` : '') + names.join(', '));
  return texts.length === 0 ? '' : `not seen: ${texts.join('; ')}`;
}

const SMOOTHED = ', smoothed';

/** The list of people, and the numbers of the one that is chosen. */
export class PeopleList {
  private person: Person | null = null;
  private found: Found | null = null;

  constructor(
    private readonly list: HTMLElement,
    private readonly nobody: HTMLElement,
    private readonly details: HTMLElement,
    private readonly choose: (number: number) => void,
  ) {}

  private selected = -1;

  select(number: number, frame: Frame | null, body: Body | null): void {
    this.selected = number;
    if (frame && body) this.show(frame, body);
  }

  show(frame: Frame, body: Body): void {
    this.found = frame.found;
    const people = shownPeople(frame.found);
    this.nobody.hidden = people.length > 0;
    // Buttons stay as they are, so that the one with the focus keeps it from frame to frame.
    while (this.list.children.length > people.length) this.list.lastElementChild?.remove();
    while (this.list.children.length < people.length) this.list.append(this.makeItem());
    people.forEach((person, i) => this.fill(this.list.children[i] as HTMLElement, person, body, frame.found));
    this.person = people.find((person) => numberOf(person) === this.selected) ?? null;
    this.showDetails();
  }

  private makeItem(): HTMLElement {
    const lines = [element('strong'), element('span', [], 'over-time'), element('span', [], 'facts'), element('small')];
    const button = element('button', lines);
    button.addEventListener('click', () => {
      const number = Number(button.dataset.number);
      this.choose(this.selected === number ? -1 : number);
    });
    return element('li', [button]);
  }

  private fill(item: HTMLElement, person: Person, body: Body, found: Found): void {
    const button = item.firstElementChild as HTMLButtonElement;
    const [name, overTime, facts, missing] = button.children as unknown as HTMLElement[];
    const number = numberOf(person);
    button.dataset.number = String(number);
    button.setAttribute('aria-pressed', String(number === this.selected));
    button.classList.toggle('hidden-person', isHidden(person));
    button.style.borderLeftColor = css(personColour(number));
    const z = distance(person);
    const seen = Object.values(person.parts).filter((part) => part.state === 'observed').length;
    name.textContent = `Person ${number}`;
    overTime.textContent = person.state ? trackText(person, found) : '';
    facts.textContent = [
      `score ${person.score.toFixed(2)}`,
      z === null ? 'distance unknown' : `${z.toFixed(2)} m`,
      yawText(person),
      `${seen} of ${body.parts.length} parts`,
    ].join(' · ');
    missing.textContent = isHidden(person) ? '' : absentText(person, body, found);
  }

  private showDetails(): void {
    const { person, found, details } = this;
    details.hidden = !person;
    if (!person || !found) return;
    const smoothed = Object.keys(person.smoothed ?? {}).map((name) => name + SMOOTHED);
    const names = ['parts', ...Object.keys(person.joints), ...smoothed];
    const choice = details.querySelector('select') ?? this.makeDetails();
    if ([...choice.options].map((option) => option.value).join() !== names.join()) {
      choice.replaceChildren(...names.map((name) => element('option', [name])));
    }
    const title = details.querySelector('h2') as HTMLElement;
    title.textContent = `Person ${numberOf(person)}`;
    const angles = details.querySelector('.angles') as HTMLElement;
    const texts = anglesOf(person, choice.value.endsWith(SMOOTHED)).map((angle) => `${inWords(angle.name)} ${angleText(angle)}`);
    angles.textContent = texts.length > 0 ? `Angles: ${texts.join(', ')}` : '';
    const points = this.points(person, choice.value);
    const rows = Object.entries(points).map(([name, point]) => {
      const xyz = point.xyz_m?.map((metres) => metres.toFixed(2)).join(', ') ?? '';
      const row = element('tr', [element('th', [name]), element('td', [stateText(point, person, found)]), element('td', [confidenceBar(point)]), element('td', [xyz])]);
      row.className = point.state;
      return row;
    });
    details.querySelector('tbody')?.replaceChildren(...rows);
  }

  private points(person: Person, name: string): Record<string, FoundPoint> {
    if (name.endsWith(SMOOTHED)) return person.smoothed?.[name.slice(0, -SMOOTHED.length)] ?? person.parts;
    return person.joints[name] ?? person.parts;
  }

  private makeDetails(): HTMLSelectElement {
    const choice = element('select');
    choice.setAttribute('aria-label', 'Points to list');
    choice.addEventListener('change', () => this.showDetails());
    const head = element('tr', ['point', 'state', 'reliability', 'x, y, z in m'].map((text) => element('th', [text])));
    this.details.append(
      element('p', [element('h2'), choice], 'row'),
      element('p', [], 'angles'),
      element('table', [element('thead', [head]), element('tbody')]),
    );
    return choice;
  }
}
