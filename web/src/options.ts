import { OptionFacts } from './protocol';

type Value = number | boolean | string;

/** A field for every option of the detector. */
export class OptionFields {
  private readonly fields = new Map<string, { row: HTMLElement; input: HTMLInputElement; reset: HTMLButtonElement }>();

  constructor(
    private readonly place: HTMLElement,
    private readonly filter: HTMLInputElement,
    private readonly set: (option: string, value: Value) => void,
  ) {
    filter.addEventListener('input', () => this.applyFilter());
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
    const label = document.createElement('label');
    const name = document.createElement('span');
    name.textContent = option.name.slice(option.name.indexOf('.') + 1);
    label.append(name, input);
    const help = document.createElement('small');
    const range = option.type === 'number' || option.type === 'integer' ? ` ${option.low} to ${option.high}` : '';
    help.textContent = `${option.help}${range}${option.unit ? ` ${option.unit}` : ''}`;
    const row = document.createElement('div');
    row.className = 'option';
    row.dataset.name = option.name;
    row.append(label, reset, help);
    this.group(option.name).append(row);
    const field = { row, input, reset };
    this.fields.set(option.name, field);
    return field;
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
