import { css, personColour } from './palette';
import { Body, FoundPoint, Frame, Person } from './protocol';

function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  content: (Node | string)[] = [],
  className = '',
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  made.append(...content);
  if (className) made.className = className;
  return made;
}

/** Median distance along the optical axis of the parts that were seen, metres. */
function distance(person: Person): number | null {
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

function confidenceBar(point: FoundPoint): HTMLElement {
  const bar = element('meter', [`${Math.round(100 * point.confidence)} %`]);
  bar.min = 0;
  bar.max = 1;
  bar.value = point.confidence;
  bar.title = `right with a probability of ${Math.round(100 * point.confidence)} %`;
  return bar;
}

/** The list of people, and the numbers of the one that is chosen. */
export class PeopleList {
  private person: Person | null = null;

  constructor(
    private readonly list: HTMLElement,
    private readonly nobody: HTMLElement,
    private readonly details: HTMLElement,
    private readonly choose: (index: number) => void,
  ) {}

  private selected = -1;

  select(index: number, frame: Frame | null, body: Body | null): void {
    this.selected = index;
    if (frame && body) this.show(frame, body);
  }

  show(frame: Frame, body: Body): void {
    const { people } = frame.found;
    this.nobody.hidden = people.length > 0;
    // Buttons stay as they are, so that the one with the focus keeps it from frame to frame.
    while (this.list.children.length > people.length) this.list.lastElementChild?.remove();
    while (this.list.children.length < people.length) this.list.append(this.makeItem(this.list.children.length));
    people.forEach((person, i) => this.fill(this.list.children[i] as HTMLElement, person, body));
    this.person = people.find((person) => person.index === this.selected) ?? null;
    this.showDetails();
  }

  private makeItem(index: number): HTMLElement {
    const button = element('button', [element('strong'), element('span', [], 'facts'), element('small')]);
    button.addEventListener('click', () => this.choose(this.selected === index ? -1 : index));
    return element('li', [button]);
  }

  private fill(item: HTMLElement, person: Person, body: Body): void {
    const button = item.firstElementChild as HTMLButtonElement;
    const [name, facts, missing] = button.children as unknown as HTMLElement[];
    button.setAttribute('aria-pressed', String(person.index === this.selected));
    button.style.borderLeftColor = css(personColour(person.index));
    const z = distance(person);
    const seen = Object.values(person.parts).filter((part) => part.state === 'observed').length;
    name.textContent = `Person ${person.index}`;
    facts.textContent = [
      `score ${person.score.toFixed(2)}`,
      z === null ? 'distance unknown' : `${z.toFixed(2)} m`,
      yawText(person),
      `${seen} of ${body.parts.length} parts`,
    ].join(' · ');
    const absent = body.parts.filter((part) => person.parts[part.name].state !== 'observed').map((part) => part.name);
    missing.textContent = absent.length === 0 ? '' : `not seen: ${absent.join(', ')}`;
  }

  private showDetails(): void {
    const { person, details } = this;
    details.hidden = !person;
    if (!person) return;
    const names = ['parts', ...Object.keys(person.joints)];
    const choice = details.querySelector('select') ?? this.makeDetails();
    if ([...choice.options].map((option) => option.value).join() !== names.join()) {
      choice.replaceChildren(...names.map((name) => element('option', [name])));
    }
    const title = details.querySelector('h2') as HTMLElement;
    title.textContent = `Person ${person.index}`;
    const points = person.joints[choice.value] ?? person.parts;
    const rows = Object.entries(points).map(([name, point]) => {
      const xyz = point.xyz_m?.map((metres) => metres.toFixed(2)).join(', ') ?? '';
      const row = element('tr', [element('th', [name]), element('td', [point.state]), element('td', [confidenceBar(point)]), element('td', [xyz])]);
      row.className = point.state;
      return row;
    });
    details.querySelector('tbody')?.replaceChildren(...rows);
  }

  private makeDetails(): HTMLSelectElement {
    const choice = element('select');
    choice.setAttribute('aria-label', 'Points to list');
    choice.addEventListener('change', () => this.showDetails());
    const head = element('tr', ['point', 'state', 'reliability', 'x, y, z in m'].map((text) => element('th', [text])));
    this.details.append(
      element('p', [element('h2'), choice], 'row'),
      element('table', [element('thead', [head]), element('tbody')]),
    );
    return choice;
  }
}
