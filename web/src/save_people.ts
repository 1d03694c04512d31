// The dialog in which people are saved as files of other programs.
import { element } from './people';

interface Known {
  frames: number;
  forgotten: number;
  most_bytes: number;
  people: { id: number; frames: number; bodies: number }[];
}

/** What a format takes of people. */
const FORMATS: Record<string, { of_one: boolean; bodies: boolean }> = {
  csv: { of_one: false, bodies: false },
  bvh: { of_one: true, bodies: true },
  glb: { of_one: false, bodies: true },
};

function count(number: number, one: string, many: string): string {
  return `${number.toLocaleString('en')} ${number === 1 ? one : many}`;
}

/** A dialog that says what there is to save, and asks the program for the files. */
export class SavePeople {
  private readonly note: HTMLElement;
  private readonly format: HTMLSelectElement;
  private readonly person: HTMLSelectElement;
  private readonly button: HTMLButtonElement;
  private known: Known | null = null;

  /** `save` gives a file to the user. */
  constructor(
    private readonly dialog: HTMLDialogElement,
    private readonly save: (name: string, content: Blob) => void,
  ) {
    const part = <T extends Element>(id: string): T => dialog.querySelector(`#${id}`) as T;
    [this.note, this.format, this.person, this.button] = [part('saving-note'), part('saving-format'), part('saving-person'), part('saving-save')];
    this.format.addEventListener('change', () => this.offer());
    this.button.addEventListener('click', () => void this.saveFiles());
  }

  /** `selected` is the person who is chosen on the page. */
  async open(selected: number): Promise<void> {
    this.known = null;
    this.note.textContent = 'Asking what there is …';
    this.offer();
    this.dialog.showModal();
    try {
      this.known = (await (await this.ask('people.json')).json()) as Known;
    } catch (error) {
      this.note.textContent = error instanceof Error ? error.message : String(error);
      return;
    }
    this.offer();
    if (this.known.people.some(({ id }) => id === selected)) this.person.value = String(selected);
  }

  private told({ frames, forgotten, most_bytes, people }: Known): string {
    if (people.length === 0) return 'Nobody was found yet, so there is no one to save.';
    const kept = `${count(people.length, 'person', 'people')} in ${count(frames, 'frame', 'frames')}, each time of the source once.`;
    if (forgotten === 0) return kept;
    return `${kept} The first ${count(forgotten, 'frame is', 'frames are')} forgotten: at most ${most_bytes / 2 ** 20} MB of people are kept.`;
  }

  /** The people whom the format can have. */
  private people(): number[] {
    const { bodies } = FORMATS[this.format.value];
    return (this.known?.people ?? []).filter((person) => !bodies || person.bodies > 0).map(({ id }) => id);
  }

  private offer(): void {
    const ids = this.people();
    const { of_one } = FORMATS[this.format.value];
    const chosen = this.person.value;
    const all = Object.assign(element('option', [of_one ? 'all, a file each' : 'all']), { value: '' });
    const each = of_one ? ids.map((id) => Object.assign(element('option', [String(id)]), { value: String(id) })) : [];
    this.person.replaceChildren(all, ...each);
    if (each.some(({ value }) => value === chosen)) this.person.value = chosen;
    this.person.disabled = !of_one;
    this.button.disabled = ids.length === 0;
    if (this.known?.people.length && ids.length === 0) {
      this.note.textContent = 'Nobody has a fitted body yet: BVH and GLB need people who are followed for a moment.';
    } else if (this.known) {
      this.note.textContent = this.told(this.known);
    }
  }

  private async ask(path: string): Promise<Response> {
    const answer = await fetch(path + location.search);  // which carries the token
    if (!answer.ok) throw new Error((await answer.text()).trim());
    return answer;
  }

  private async saveFiles(): Promise<void> {
    const ending = this.format.value;
    const ids = this.person.value ? [Number(this.person.value)] : this.people();
    const names = FORMATS[ending].of_one ? ids.map((id) => `people-${id}.${ending}`) : [`people.${ending}`];
    this.button.disabled = true;
    try {
      for (const name of names) {
        this.note.textContent = `Making ${name} …`;
        this.save(name, await (await this.ask(name)).blob());
      }
      this.note.textContent = `Saved: ${names.join(', ')}`;
    } catch (error) {
      this.note.textContent = error instanceof Error ? error.message : String(error);
    }
    this.button.disabled = false;
  }
}
