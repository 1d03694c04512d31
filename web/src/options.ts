import { OptionFacts } from './protocol';

type Value = number | boolean | string;

interface First {
  name: string;
  title: string;
  help: string;
}

/** Those that people turn, in their words. They stand first, all others below them in their groups. */
const FIRST: First[] = [
  { name: 'refine.min-score', title: 'Threshold', help: 'How sure it must be that somebody is there: more shows fewer people.' },
  { name: 'track.hidden', title: 'Following', help: 'How long somebody who is out of sight is kept.' },
  { name: 'track.smooth-cutoff', title: 'Smoothing', help: 'How fast smoothed joints change: less is calmer, and later.' },
  { name: 'grid.step', title: 'Speed', help: 'Only every so many pixels are looked at: more is faster, and coarser; 0 chooses.' },
];

/** A field for every option of the detector. */
export class OptionFields {
  private readonly first = document.createElement('div');
  private readonly model = document.createElement('div');
  private readonly modelName = document.createElement('output');
  private readonly fields = new Map<string, { row: HTMLElement; input: HTMLInputElement; reset: HTMLButtonElement }>();

  constructor(
    private readonly place: HTMLElement,
    private readonly filter: HTMLInputElement,
    private readonly set: (option: string, value: Value) => void,
  ) {
    filter.addEventListener('input', () => this.applyFilter());
    this.first.id = 'options-first';
    const title = document.createElement('strong');
    title.textContent = 'Model';
    const help = document.createElement('small');
    help.textContent = 'What tells body parts apart. Another one is named when the program is started: --model.';
    this.model.className = 'option';
    this.model.append(title, this.modelName, help);
    this.first.append(this.model);
    place.append(this.first);
  }

  showModel(name: string): void {
    this.modelName.textContent = name;
  }

  show(options: OptionFacts[]): void {
    for (const option of options) {
      const field = this.fields.get(option.name) ?? this.make(option);
      const { input, row, reset } = field;
      if (option.type === 'boolean') {
        input.checked = option.value as boolean;
      } else if (document.activeElement !== input || input.value === '') {
        input.value = String(option.value);
      }
      const changed = option.value !== option.default;
      row.classList.toggle('changed', changed);
      reset.hidden = !changed;
    }
    this.applyFilter();
  }

  private make(option: OptionFacts): { row: HTMLElement; input: HTMLInputElement; reset: HTMLButtonElement } {
    const input = document.createElement('input');
    if (option.type === 'boolean') {
      input.type = 'checkbox';
    } else if (option.type === 'text') {
      input.type = 'text';
    } else {
      input.type = 'number';
      input.min = String(option.low);
      input.max = String(option.high);
      input.step = option.type === 'integer' ? '1' : 'any';
    }
    input.addEventListener('change', () => {
      if (!input.reportValidity()) return;
      if (option.type === 'boolean') this.set(option.name, input.checked);
      else if (option.type === 'text') this.set(option.name, input.value);
      else if (input.value !== '') this.set(option.name, Number(input.value));
    });
    const reset = document.createElement('button');
    reset.textContent = `back to ${option.default}`;
    reset.addEventListener('click', () => {
      input.value = String(option.default);
      this.set(option.name, option.default);
    });
    const place = FIRST.findIndex(({ name }) => name === option.name);
    const label = document.createElement('label');
    const name = document.createElement('span');
    name.textContent = FIRST[place]?.title ?? option.name.slice(option.name.indexOf('.') + 1);
    label.append(name, input);
    const help = document.createElement('small');
    const range = option.type === 'number' || option.type === 'integer' ? ` ${option.low} to ${option.high}` : '';
    help.textContent = `${FIRST[place]?.help ?? option.help}${range}${option.unit ? ` ${option.unit}` : ''}`;
    const row = document.createElement('div');
    row.className = 'option';
    row.dataset.name = option.name;
    row.append(label, reset, help);
    if (place >= 0) this.addFirst(row, place);
    else this.group(option.name).append(row);
    const field = { row, input, reset };
    this.fields.set(option.name, field);
    return field;
  }

  /** Puts a row in its place among the first, the model last; its name in the program stands below it. */
  private addFirst(row: HTMLElement, place: number): void {
    row.dataset.place = String(place);
    const rows = [...this.first.children] as HTMLElement[];
    const code = document.createElement('code');
    code.textContent = row.dataset.name ?? '';
    row.lastElementChild?.append(' ', code);
    this.first.insertBefore(row, rows.find((other) => Number(other.dataset.place ?? FIRST.length) > place) ?? null);
  }

  private group(name: string): HTMLElement {
    const title = name.includes('.') ? name.slice(0, name.indexOf('.')) : 'general';
    const id = `options-${title}`;
    const there = document.getElementById(id);
    if (there) return there;
    const group = document.createElement('details');
    group.id = id;
    const summary = document.createElement('summary');
    summary.textContent = title;
    group.append(summary);
    this.place.append(group);
    return group;
  }

  /** Shows the options whose name or help has the words that are sought, and opens their groups. */
  private applyFilter(): void {
    const sought = this.filter.value.trim().toLowerCase();
    for (const { row } of this.fields.values()) {
      const text = `${row.dataset.name} ${row.textContent}`.toLowerCase();
      row.hidden = sought !== '' && !text.includes(sought);
    }
    for (const group of this.place.querySelectorAll('details')) {
      const any = group.querySelector('.option:not([hidden])') !== null;
      group.hidden = !any;
      if (sought !== '') group.open = any;
    }
  }
}
