// What stands above the slider: where people are, what happened, and the stretch that repeats.
import { placeBefore, wordsOf } from './happened';
import { css, personColour } from './palette';
import { Happened, Happening, ViewState } from './protocol';

const SVG = 'http://www.w3.org/2000/svg';
const NEAR_PX = 5;  // so near to an event a click means it
const LEAST = 0.3;  // per cent of the width: what is shorter is drawn so long

function shape(name: string, attributes: Record<string, string | number>, title = ''): SVGElement {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  if (title) made.append(Object.assign(document.createElementNS(SVG, 'title'), { textContent: title }));
  return made;
}

/** The stretch that repeats after its beginning was set here: up to its end, or that of the source. */
export function loopFrom({ span_s, loop_s, at_s }: ViewState): [number, number] | null {
  if (!span_s) return null;
  return [at_s, loop_s && loop_s[1] > at_s ? loop_s[1] : span_s[1]];
}

/** The same after its end was set here. */
export function loopTo({ span_s, loop_s, at_s }: ViewState): [number, number] | null {
  if (!span_s) return null;
  return [loop_s && loop_s[0] < at_s ? loop_s[0] : span_s[0], at_s];
}

export class Timeline {
  private readonly marks = document.createElement('div');
  private readonly picture = shape('svg', { role: 'img' });
  private span: [number, number] = [0, 1];
  private events: Happening[] = [];
  private drawn = '';

  constructor(
    slider: HTMLInputElement,
    private readonly seek: (to_s: number) => void,
    private readonly clock: (at_s: number) => string,
  ) {
    const both = document.createElement('div');
    both.id = 'timeline';
    slider.replaceWith(both);
    both.append(this.marks, slider);
    this.marks.id = 'marks';
    this.marks.append(this.picture);
    this.marks.addEventListener('click', (click) => this.follow(click));
  }

  show(state: ViewState, happened: Happened | null): void {
    this.marks.hidden = !state.span_s;
    if (!state.span_s) return;
    const { span_s, loop_s } = state;
    const key = JSON.stringify([span_s, loop_s, happened]);
    if (key === this.drawn) return;
    this.drawn = key;
    this.span = span_s;
    this.events = happened?.events ?? [];
    const seen = happened?.seen_s ?? [];
    const loop = loop_s ? [this.stretch(loop_s, 'loop', `repeats from ${this.clock(loop_s[0])} to ${this.clock(loop_s[1])}`)] : [];
    this.picture.replaceChildren(
      ...(happened?.known_s ?? []).map((known) => this.stretch(known, 'known', 'looked at')),
      ...seen.map((one) => this.stretch(one, 'seen', `somebody in view from ${this.clock(one[0])} to ${this.clock(one[1])}`)),
      ...loop,
      ...this.events.map((event) => this.tick(event)),
    );
    const words = [`somebody in view in ${seen.length} stretches`, `${this.events.length} events`];
    if (loop_s) words.push(`repeats from ${this.clock(loop_s[0])} to ${this.clock(loop_s[1])}`);
    this.picture.setAttribute('aria-label', words.join(', '));
  }

  private share(at_s: number): number {
    const [first, last] = this.span;
    return last > first ? (100 * (at_s - first)) / (last - first) : 0;
  }

  private stretch([from, to]: [number, number], kind: string, title: string): SVGElement {
    const width = Math.max(this.share(to) - this.share(from), LEAST);
    return shape('rect', { class: kind, x: `${this.share(from)}%`, width: `${width}%` }, title);
  }

  private tick(event: Happening): SVGElement {
    const x = `${this.share(event.at_s)}%`;
    const title = `${this.clock(event.at_s)} person ${event.id}: ${wordsOf(event)}`;
    const line = shape('line', { class: 'event', x1: x, x2: x, y1: 0, y2: 9 }, title);
    line.style.stroke = css(personColour(event.id));
    return line;
  }

  private follow(click: MouseEvent): void {
    const box = this.marks.getBoundingClientRect();
    const px = (event: Happening): number => Math.abs((this.share(event.at_s) / 100) * box.width - (click.clientX - box.left));
    const [nearest] = [...this.events].sort((a, b) => px(a) - px(b));
    if (nearest && px(nearest) <= NEAR_PX) return this.seek(placeBefore(nearest, this.span[0]));
    const [first, last] = this.span;
    this.seek(first + ((click.clientX - box.left) / box.width) * (last - first));
  }
}
