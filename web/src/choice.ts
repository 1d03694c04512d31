// The dialog in which another recording, folder of frames or camera is chosen.
import { Command, SourceEntry, SourceList } from './protocol';

function button(text: string, note: string, act: () => void): HTMLButtonElement {
  const made = document.createElement('button');
  made.type = 'button';
  made.append(text);
  if (note) {
    const small = document.createElement('small');
    small.textContent = note;
    made.append(' ', small);
  }
  made.addEventListener('click', act);
  return made;
}

export function sizeText(bytes: number): string {
  const units = ['bytes', 'kB', 'MB', 'GB', 'TB'];
  let size = bytes;
  let unit = 0;
  for (; size >= 1000 && unit + 1 < units.length; ++unit) size /= 1000;
  return `${unit === 0 ? size : size.toPrecision(3)} ${units[unit]}`;
}

/** Lists what may be opened, one folder at a time, as the program tells it. */
export class SourceDialog {
  private readonly dialog = document.createElement('dialog');
  private readonly place = document.createElement('p');
  private readonly sources = document.createElement('ul');
  private readonly cameras = document.createElement('ul');
  private root = '';
  private folder = '';
  private isNew = false;  // whether the folder's list has not come yet

  constructor(
    private readonly send: (command: Command) => void,
    private readonly opening: (name: string) => void,
  ) {
    this.dialog.id = 'choice';
    this.dialog.setAttribute('aria-labelledby', 'choice-title');
    const title = document.createElement('h2');
    title.id = 'choice-title';
    title.textContent = 'Open a recording, frames or a camera';
    const cameraTitle = document.createElement('h3');
    cameraTitle.textContent = 'Cameras that are plugged in';
    this.sources.id = 'choice-sources';
    this.cameras.id = 'choice-cameras';
    this.place.id = 'choice-place';
    const close = button('Close', '', () => this.dialog.close());
    this.dialog.append(title, this.place, this.sources, cameraTitle, this.cameras, close);
    document.body.append(this.dialog);
  }

  /** Takes the folder below which sources may be opened. */
  begin(root: string): void {
    if (root !== this.root) this.folder = '';
    this.root = root;
  }

  show(): void {
    if (this.dialog.open) return;
    this.cameras.replaceChildren(this.line('looking for cameras …'));
    this.go(this.folder);
    if (this.folder !== '') this.send({ do: 'list', folder: '' });  // which tells the cameras
    this.dialog.showModal();
  }

  /** Takes a list; those of folders that other pages look at do not count. */
  receive(list: SourceList): void {
    if (list.folder === '' && list.cameras) this.showCameras(list.cameras);
    if (list.folder !== this.folder) return;
    const items = list.error ? [this.line(list.error)] : (list.entries ?? []).map((entry) => this.item(entry));
    if (!list.error && items.length === 0) items.push(this.line('Nothing that can be opened lies here.'));
    if (list.left_out) items.push(this.line(`${list.left_out} more are not listed.`));
    if (this.folder !== '') items.unshift(this.row(button('↑ the folder above', '', () => this.go(this.above()))));
    this.sources.replaceChildren(...items);
    // Whoever goes from folder to folder by keys goes on in the new list.
    if (this.isNew && this.dialog.open) this.sources.querySelector('button')?.focus();
    this.isNew = false;
  }

  private go(folder: string): void {
    this.folder = folder;
    this.isNew = true;
    this.place.textContent = folder === '' ? this.root : `${this.root}/${folder}`;
    this.send({ do: 'list', folder });
  }

  private above(): string {
    return this.folder.slice(0, Math.max(this.folder.lastIndexOf('/'), 0));
  }

  private open(source: string): void {
    this.dialog.close();
    this.opening(source);
    this.send({ do: 'open', source });
  }

  private item(entry: SourceEntry): HTMLElement {
    const path = this.folder === '' ? entry.name : `${this.folder}/${entry.name}`;
    const note = entry.bytes === undefined ? 'frames' : `recording, ${sizeText(entry.bytes)}`;
    const buttons = entry.opens ? [button(entry.name, note, () => this.open(path))] : [];
    if (entry.folder) {
      const into = button(entry.opens ? 'look inside' : `${entry.name}/`, entry.opens ? '' : 'folder', () => this.go(path));
      if (entry.opens) into.setAttribute('aria-label', `look inside ${entry.name}`);
      buttons.push(into);
    }
    return this.row(...buttons);
  }

  private showCameras(cameras: { source: string; name: string }[]): void {
    const items = cameras.map(({ source, name }) => this.row(button(name, source, () => this.open(source))));
    this.cameras.replaceChildren(...(items.length > 0 ? items : [this.line('None; “vesalius cameras” says which drivers there are.')]));
  }

  private row(...buttons: HTMLElement[]): HTMLElement {
    const item = document.createElement('li');
    item.append(...buttons);
    return item;
  }

  private line(text: string): HTMLElement {
    const item = document.createElement('li');
    item.textContent = text;
    return item;
  }
}
