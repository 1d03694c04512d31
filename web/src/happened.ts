// What happened, as a list.
import { css, personColour } from './palette';
import { element } from './people';
import { Happening } from './protocol';

/** So long before an event a look at it begins. */
const BEFORE_S = 1;

const BEGAN: Record<string, string> = { standing: 'stood up', sitting: 'sat down', lying: 'lay down', fallen: 'fell' };
const IS: Record<string, string> = { standing: 'stands', sitting: 'sits', lying: 'lies', fallen: 'lies, fallen' };

/** What happened, in words: who is seen for the first time has not stood up just now. */
export function wordsOf({ what, before }: Happening): string {
  if (what === 'sitting' && (before === 'lying' || before === 'fallen')) return 'sat up';
  return (before === 'unknown' ? IS : BEGAN)[what] ?? what;
}

/** Where to look to see something happen. */
export function placeBefore(event: Happening, first_s: number): number {
  return Math.max(first_s, event.at_s - BEFORE_S);
}

/** The list of what happened, the newest first. Where one can seek, each line goes to it. */
export class EventList {
  private shown = '';

  constructor(
    private readonly list: HTMLElement,
    private readonly section: HTMLElement,
    private readonly seek: (to_s: number) => void,
  ) {}

  /** `first_s` is where the source begins; null where one cannot seek. */
  show(events: Happening[], clock: (at_s: number) => string, first_s: number | null): void {
    const lines = events.map((event) => `${clock(event.at_s)}  person ${event.id}: ${wordsOf(event)}`);
    const all = `${first_s !== null}\n${lines.join('\n')}`;
    this.section.hidden = events.length === 0;
    if (all === this.shown) return;
    this.shown = all;
    const focused = document.activeElement?.closest('li')?.textContent;
    const items = events.map((event, i) => this.item(event, lines[i], first_s)).reverse();
    this.list.replaceChildren(...items);
    items.find((item) => item.textContent === focused)?.querySelector('button')?.focus();
  }

  private item(event: Happening, line: string, first_s: number | null): HTMLElement {
    const item = element('li', [line]);
    item.style.borderLeftColor = css(personColour(event.id));
    if (first_s === null) return item;
    const button = element('button', [line]);
    button.title = 'Go to a second before it';
    button.addEventListener('click', () => this.seek(placeBefore(event, first_s)));
    item.replaceChildren(button);
    return item;
  }
}
