import { SourceDialog, sizeText } from './choice';
import { Cloud, Colouring } from './cloud';
import { Connection } from './connection';
import { Curves } from './curves';
import { DEPTH_COLOURS, Flat } from './flat';
import { EventList } from './happened';
import { FullScreen } from './full_screen';
import { History } from './history';
import { Marks } from './marks';
import { Measure } from './measure';
import { OptionFields } from './options';
import './over_time.css';
import { partColours } from './palette';
import { PeopleList } from './people';
import { Body, Command, Frame, Happened, Hello, TextMessage, ViewState, Xyz } from './protocol';
import { SavePeople } from './save_people';
import { SkeletonChoice, Skeletons } from './skeleton';
import { StagePictures } from './stages';
import { Timeline, loopFrom, loopTo } from './timeline';
import { TrackMemory, numberOf, shownPeople } from './track';

function get<T extends HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

const AWAY = 'vesalius does not answer; trying again';
const NOTICE_MS = 8000;
const MOST_NOTICES = 5;
const SEEK_PAUSE_MS = 60;  // while the slider moves
const THEMES = ['auto', 'light', 'dark'];

let body: Body | null = null;
let frame: Frame | null = null;
let state: ViewState | null = null;
let after = 0;  // number of the last frame that is of another source
let happened: Happened | null = null;
let liveSince_s: number | null = null;  // the time of day, in seconds since 1970, at which a camera's clock was 0
let selected = -1;
let seekTo: number | null = null;  // where the slider was moved to, until that is sent
let holdsSlider = false;

const colouring = get<HTMLSelectElement>('colouring');
const skeletonChoice = get<HTMLSelectElement>('skeleton');
const partColouring = get<HTMLSelectElement>('part-colours');
const seek = get<HTMLInputElement>('seek');

/** Shows a line for a while; the same line again counts, and older ones give way. */
function notice(text: string): void {
  const place = get('notices');
  const same = [...place.children].find((line) => (line as HTMLElement).dataset.text === text) as HTMLElement | undefined;
  const line = same ?? document.createElement('p');
  const count = Number(line.dataset.count ?? 0) + 1;
  line.dataset.text = text;
  line.dataset.count = String(count);
  line.textContent = count > 1 ? `${text} (${count} times)` : text;
  if (same) return;
  line.addEventListener('click', () => line.remove());
  place.append(line);
  while (place.children.length > MOST_NOTICES) place.firstElementChild?.remove();
  setTimeout(() => line.remove(), NOTICE_MS);
}

/** Tells those who listen to the page what has changed, and nothing else: frames come 30 times a second. */
function announce(text: string): void {
  if (get('announced').textContent !== text) get('announced').textContent = text;
}

const skeletons = new Skeletons();
const memory = new TrackMemory();
const marks = new Marks(skeletons);
const measure = new Measure();
let isMeasuring = false;

/** The 3-D view; none where the browser has no WebGL 2. */
function makeCloud(): Cloud | null {
  try {
    return new Cloud(get<HTMLCanvasElement>('cloud'), get('names'), skeletons, memory, marks, measure, takePoint);
  } catch {
    get('no-cloud').textContent = 'This browser has no WebGL 2, so there is no 3-D view: the flat picture shows the people.';
    get('no-cloud').hidden = false;
    document.body.classList.add('flat-only');
    return null;
  }
}

const cloud = makeCloud();
const flat = new Flat(get<HTMLCanvasElement>('picture'), get('readout'), skeletons, memory, marks, measure, takePoint);
const people = new PeopleList(get('list'), get('nobody'), get('details'), choose);
const stages = new StagePictures(get('stages'));
const options = new OptionFields(get('option-list'), get<HTMLInputElement>('filter'), (option, value) =>
  connection.send({ do: 'set', option, value }),
);
cloud?.setDepthColours(DEPTH_COLOURS);
const sources = new SourceDialog(
  (command) => connection.send(command),
  (name) => notice(`opening ${name} …`),
);
const fullScreen = new FullScreen((isOn) => get('full-screen').setAttribute('aria-pressed', String(isOn)));

const seekTo_s = (to_s: number): void => connection.send({ do: 'seek', to_s });
const history = new History();
const timeline = new Timeline(seek, seekTo_s, placeText);
const events = new EventList(get('events'), get('happened'), seekTo_s);
const curves = new Curves(get('curves'), history, choose, seekTo_s, placeText);
const saving = new SavePeople(get<HTMLDialogElement>('saving'), save);

const connection = new Connection({
  async frame(shown) {
    if (shown.number <= after) return;
    const before = frame;
    frame = shown;
    memory.add(shown.found);
    history.add(shown);
    if (state) curves.show(state, shown.at_s);
    flat.show(shown);
    tellMeasured();
    if (body) {
      people.show(shown, body);
      if (!get('stages').hidden) stages.show(shown, body, currentPartColours());
    }
    // A hidden tab draws nothing and need not be sent anything either.
    await (cloud ? cloud.show(shown) : new Promise(requestAnimationFrame));
    before?.colour?.close();
  },
  text: receive,
  failed: notice,
  connected(is) {
    document.body.classList.toggle('away', !is);
    announce(is ? 'connected' : AWAY);
    if (!is) get('status').textContent = AWAY;
    else if (!get('stages').hidden) connection.send({ do: 'stages', on: true });
  },
});

function receive(message: TextMessage): void {
  switch (message.type) {
    case 'hello':
      begin(message);
      get('source').textContent = `${message.source} · ${message.model}`;
      get('record').title = `Record frames and people into an MCAP file in ${message.folder} (m)`;
      document.title = `${message.source} – vesalius`;
      break;
    case 'state':
      state = message;
      showState(message);
      showHappened();
      break;
    case 'happened':
      happened = message;
      showHappened();
      break;
    case 'options':
      options.show(message.options);
      break;
    case 'sources':
      sources.receive(message);
      break;
    case 'notice':
      notice(message.text);
      break;
  }
}

/** Begins anew: the program may be another, with another body. */
function begin(hello: Hello): void {
  body = hello.body;
  after = hello.after;
  frame = null;
  memory.clear();
  history.clear();
  liveSince_s = null;
  skeletons.setBody(hello.body, hello.bones);
  document.body.classList.toggle('single-frames', !hello.track);
  for (const name of ['bones', 'smoothed']) {
    const option = skeletonChoice.querySelector<HTMLOptionElement>(`[value=${name}]`);
    if (option) option.disabled = !hello.track;
  }
  if (!hello.track && skeletonChoice.selectedOptions[0]?.disabled) skeletonChoice.value = 'parts';
  options.showModel(hello.model);
  get('open').hidden = hello.choice === null;
  sources.begin(hello.choice ?? '');
  measure.points = [];
  cloud?.placeAnew();
  choose(-1);
  setSkeleton();
  showPartColours();
  showMeasured();
}

function clock(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${(seconds - 60 * minutes).toFixed(2).padStart(5, '0')}`;
}

/** A place in a recording from its beginning, or when a camera was there. */
function placeText(at_s: number): string {
  if (state?.live) liveSince_s ??= Date.now() / 1000 - state.at_s;
  if (liveSince_s === null) return clock(at_s - (state?.span_s?.[0] ?? 0));
  return new Date(1000 * (liveSince_s + at_s)).toTimeString().slice(0, 8);
}

function showHappened(): void {
  if (!state) return;
  timeline.show(state, happened);
  events.show(happened?.events ?? [], placeText, state.span_s?.[0] ?? null);
}

function showState(now: ViewState): void {
  const ms = (value: number | null): string => (value === null ? '–' : `${Math.round(value)} ms`);
  const doing = !now.playing ? (now.at_end ? 'at the end' : 'paused') : now.live ? 'live' : 'playing';
  announce(now.recording ? `${doing}, recording` : doing);
  const words = [
    doing,
    `${now.frames_per_s.toFixed(0)} frames/s`,
    `people after ${ms(now.result_ms)}`,
    `shown after ${ms(now.page_ms)}`,
    `${now.dropped} dropped`,
  ];
  if (now.recording) words.push(`recording ${now.recording}: ${now.recorded} frames`);
  get('status').textContent = words.join(' · ');
  const { saved } = now;
  const where = saved && !now.recording ? `recorded ${saved.frames} frame${saved.frames === 1 ? '' : 's'}, ${sizeText(saved.bytes)}: ${saved.path}` : '';
  if (get('saved').textContent !== where) get('saved').textContent = where;
  get('play').textContent = now.playing ? 'Pause' : 'Play';
  get('record').setAttribute('aria-pressed', String(now.recording !== ''));
  get('record').textContent = now.recording ? 'Stop recording' : 'Record';
  for (const id of ['back', 'seek', 'repeat', 'loop-from', 'loop-to']) get<HTMLInputElement>(id).disabled = !now.span_s;
  for (const id of ['loop-from', 'loop-to']) get(id).setAttribute('aria-pressed', String(now.loop_s !== null));
  get<HTMLButtonElement>('loop-none').disabled = !now.loop_s;
  get('transport').classList.toggle('live', now.live);
  get<HTMLInputElement>('repeat').checked = now.repeat;
  get<HTMLSelectElement>('speed').value = String(now.speed);
  if (now.span_s) {
    const [first, last] = now.span_s;
    seek.min = String(first);
    seek.max = String(Math.max(last, first + 1e-3));
    if (seekTo === null && !holdsSlider) seek.value = String(now.at_s);
    seek.setAttribute('aria-valuetext', `${clock(now.at_s - first)} of ${clock(last - first)}`);
    get('time').textContent = `${clock(now.at_s - first)} / ${clock(last - first)} · ${frame?.found.frame ?? ''}`;
  } else {
    get('time').textContent = now.live ? '' : clock(now.at_s);
  }
}

function currentPartColours(): ReturnType<typeof partColours> {
  return body ? partColours(body, partColouring.value === 'sides') : [];
}

function showPartColours(): void {
  if (!body) return;
  cloud?.setBody(body, currentPartColours());
  flat.setBody(body, currentPartColours());
  if (frame && !get('stages').hidden) stages.show(frame, body, currentPartColours());
}

function choose(number: number): void {
  selected = number;
  cloud?.select(number);
  flat.select(number);
  people.select(number, frame, body);
  curves.select(number);
}

function setSkeleton(): void {
  skeletons.choice = skeletonChoice.value as SkeletonChoice;
  showParts();
}

function setColouring(): void {
  cloud?.setColouring(colouring.value as Colouring);
  flat.setColouring(colouring.value as Colouring);
}

function showTab(name: string): void {
  for (const tab of document.querySelectorAll<HTMLElement>('[role=tab]')) {
    const is = tab.id === `tab-${name}`;
    tab.setAttribute('aria-selected', String(is));
    tab.tabIndex = is ? 0 : -1;
    get(tab.getAttribute('aria-controls') ?? '').hidden = !is;
  }
  get('side').classList.toggle('wide', name === 'stages');
  curves.draw();
  connection.send({ do: 'stages', on: name === 'stages' });
}

function isChecked(id: string): boolean {
  return get<HTMLInputElement>(id).checked;
}

function showParts(): void {
  const [boxes, trails] = [isChecked('show-boxes'), isChecked('show-trails')];
  Object.assign(marks, { names: isChecked('show-names'), axes: isChecked('show-axes'), angles: isChecked('show-angles') });
  cloud?.setShown({ boxes, trails, bodies: isChecked('show-bodies'), floor: isChecked('show-floor') });
  flat.setShown(boxes, trails);
}

/** Up is another direction as soon as the floor is known. */
function tellMeasured(): void {
  const text = measure.text(frame?.found ?? null, isMeasuring);
  if (get('measured').textContent !== text) get('measured').textContent = text;
}

function showMeasured(): void {
  document.body.classList.toggle('measuring', isMeasuring);
  get('measure').setAttribute('aria-pressed', String(isMeasuring));
  tellMeasured();
  cloud?.showMarks();
  flat.draw();
}

function setMeasuring(is: boolean): void {
  isMeasuring = is;
  measure.points = [];
  showMeasured();
}

/** Takes a point that was clicked. */
function takePoint(xyz: Xyz | null): void {
  if (!isMeasuring) return;
  if (!xyz) return notice('The camera has no reading there.');
  measure.add(xyz);
  showMeasured();
}

/** Clears what is measured, then ends measuring, then leaves the full screen. */
function escape(): void {
  if (measure.points.length > 0) setMeasuring(true);
  else if (isMeasuring) setMeasuring(false);
  else fullScreen.leave();
}

const systemIsDark = matchMedia('(prefers-color-scheme: dark)');
let theme = localStorage.getItem('theme') ?? 'auto';

function showTheme(): void {
  const isDark = theme === 'dark' || (theme === 'auto' && systemIsDark.matches);
  document.documentElement.dataset.theme = isDark ? 'dark' : 'light';
  get('theme').textContent = `Theme: ${theme}`;
  curves.draw();
  cloud?.setBackground(getComputedStyle(document.body).getPropertyValue('--space').trim());
}

function save(name: string, content: Blob): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** Saves both pictures side by side, and the people as the line that `vesalius detect --json` writes. */
function snapshot(): void {
  if (!frame) return;
  const name = `vesalius-${frame.found.frame.replace(/[^\w.-]/g, '_')}`;
  const picture = get<HTMLCanvasElement>('picture');
  const space = get<HTMLCanvasElement>('cloud');
  cloud?.drawNow();
  const height = Math.max(picture.height, cloud ? space.height : 0);
  const wide = cloud ? Math.round((space.width * height) / space.height) : 0;
  const flatWide = Math.round((picture.width * height) / picture.height);
  const both = document.createElement('canvas');
  both.width = wide + flatWide;
  both.height = height;
  const context = both.getContext('2d');
  if (cloud) context?.drawImage(space, 0, 0, wide, height);
  context?.drawImage(picture, wide, 0, flatWide, height);
  both.toBlob((png) => png && save(`${name}.png`, png), 'image/png');
  save(`${name}.json`, new Blob([JSON.stringify(frame.found)], { type: 'application/json' }));
}

function playOrPause(): void {
  connection.send({ do: state?.playing ? 'pause' : 'play' });
}

function loop(between_s: [number, number] | null): void {
  if (state?.span_s) connection.send({ do: 'loop', between_s });
}

const savePeople = (): void => void saving.open(selected);
const repeatFrom = (): void => loop(state && loopFrom(state));
const repeatTo = (): void => loop(state && loopTo(state));
const repeatNone = (): void => loop(null);

function chooseNext(choice: HTMLSelectElement): void {
  const free = [...choice.options].filter((option) => !option.disabled);
  choice.value = free[(free.indexOf(choice.selectedOptions[0]) + 1) % free.length].value;
}

const KEYS: Record<string, () => void> = {
  ' ': playOrPause,
  ArrowLeft: () => connection.send({ do: 'step', by: -1 }),
  ArrowRight: () => connection.send({ do: 'step', by: 1 }),
  Home: () => state?.span_s && connection.send({ do: 'seek', to_s: state.span_s[0] }),
  End: () => state?.span_s && connection.send({ do: 'seek', to_s: state.span_s[1] }),
  c: () => {
    chooseNext(colouring);
    setColouring();
  },
  j: () => {
    chooseNext(skeletonChoice);
    setSkeleton();
  },
  i: repeatFrom,
  e: repeatTo,
  l: repeatNone,
  p: savePeople,
  t: () => get('show-trails').click(),
  b: () => get('show-bodies').click(),
  r: () => cloud?.resetView(),
  v: () => cloud?.viewOfCamera(),
  n: () => get('show-names').click(),
  x: () => get('show-axes').click(),
  a: () => get('show-angles').click(),
  d: () => setMeasuring(!isMeasuring),
  f: () => fullScreen.toggle(),
  o: () => get('open').hidden || sources.show(),
  Escape: escape,
  s: snapshot,
  m: () => connection.send({ do: 'record', on: !state?.recording }),
  '?': () => get<HTMLDialogElement>('help').showModal(),
};

/** Whether the element with the focus, or a dialog, uses this key itself. A dialog loses the focus where its button is switched off. */
function isTakenBy(target: HTMLElement, key: string): boolean {
  const isArrow = /^(Arrow|Home|End)/.test(key);
  if (document.querySelector('dialog[open]')) return true;
  if (target.closest('select, input:not([type=checkbox], [type=range])')) return true;
  if (target.closest('input[type=range], [role=tablist]')) return isArrow;
  return target.closest('button, a, summary, input') !== null && key === ' ';
}

function onKey(event: KeyboardEvent): void {
  if (event.ctrlKey || event.altKey || event.metaKey || isTakenBy(event.target as HTMLElement, event.key)) return;
  // A held key steps through frames, and does nothing else more than once.
  if (event.repeat && !event.key.startsWith('Arrow')) return;
  if (/^[0-9]$/.test(event.key)) {
    const number = Number(event.key);
    const isThere = frame && shownPeople(frame.found).some((person) => numberOf(person) === number);
    choose(isThere && number !== selected ? number : -1);
    return;
  }
  const action = KEYS[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}

function listen(): void {
  document.addEventListener('keydown', onKey);
  colouring.addEventListener('change', setColouring);
  partColouring.addEventListener('change', showPartColours);
  skeletonChoice.addEventListener('change', setSkeleton);
  const shown = ['boxes', 'trails', 'bodies', 'floor', 'names', 'axes', 'angles'];
  for (const name of shown) get(`show-${name}`).addEventListener('change', showParts);
  get('view-reset').addEventListener('click', () => cloud?.resetView());
  get('view-camera').addEventListener('click', () => cloud?.viewOfCamera());
  get('play').addEventListener('click', playOrPause);
  get('back').addEventListener('click', () => connection.send({ do: 'step', by: -1 }));
  get('forward').addEventListener('click', () => connection.send({ do: 'step', by: 1 }));
  get('repeat').addEventListener('change', () => connection.send({ do: 'repeat', on: isChecked('repeat') }));
  get('speed').addEventListener('change', () =>
    connection.send({ do: 'speed', times: Number(get<HTMLSelectElement>('speed').value) }),
  );
  seek.addEventListener('input', () => {
    const waits = seekTo !== null;
    seekTo = Number(seek.value);
    if (waits) return;
    setTimeout(() => {
      connection.send({ do: 'seek', to_s: seekTo ?? 0 });
      seekTo = null;
    }, SEEK_PAUSE_MS);
  });
  seek.addEventListener('pointerdown', () => (holdsSlider = true));
  for (const end of ['pointerup', 'pointercancel']) document.addEventListener(end, () => (holdsSlider = false));
  get('record').addEventListener('click', () => connection.send({ do: 'record', on: !state?.recording }));
  get('snapshot').addEventListener('click', snapshot);
  get('open').addEventListener('click', () => sources.show());
  get('measure').addEventListener('click', () => setMeasuring(!isMeasuring));
  get('full-screen').addEventListener('click', () => fullScreen.toggle());
  get('save-people').addEventListener('click', savePeople);
  get('loop-from').addEventListener('click', repeatFrom);
  get('loop-to').addEventListener('click', repeatTo);
  get('loop-none').addEventListener('click', repeatNone);
  get('keys').addEventListener('click', KEYS['?']);
  get('theme').addEventListener('click', () => {
    theme = THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length];
    localStorage.setItem('theme', theme);
    showTheme();
  });
  systemIsDark.addEventListener('change', showTheme);
  get('reset-options').addEventListener('click', () => connection.send({ do: 'reset' }));
  get<HTMLAnchorElement>('save-options').href = `options.toml${location.search}`;
  const tabs = [...document.querySelectorAll<HTMLElement>('[role=tab]')];
  tabs.forEach((tab, i) => {
    tab.addEventListener('click', () => showTab(tab.id.slice('tab-'.length)));
    tab.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!by) return;
      const next = tabs[(i + by + tabs.length) % tabs.length];
      next.focus();
      next.click();
    });
  });
}

listen();
setColouring();
setSkeleton();
showTheme();

// For tests, and for scripts in the console: what is shown now.
Object.assign(window, {
  vesalius: {
    frame: () => frame,
    state: () => state,
    trail: (id: number) => frame?.found.people.filter((person) => numberOf(person) === id).flatMap((person) => memory.trail(person)) ?? [],
    counts: () => cloud?.counts() ?? null,
    draw: () => cloud?.drawNow(),
    send: (command: Command) => connection.send(command),
    measured: () => measure.points,
    happened: () => happened,
    history,
  },
});
