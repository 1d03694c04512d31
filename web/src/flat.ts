import type { Colouring } from './cloud';
import { Over } from './flat_marks';
import { Marks } from './marks';
import { Measure } from './measure';
import { Rgb, css, depthColour, depthRange, personColour } from './palette';
import { BACKGROUND, Body, Frame, Person, Px, Xyz } from './protocol';
import { Skeletons, isSeen, project } from './skeleton';
import { TrackMemory, coloursByIndex, isHidden, numberOf, shownPeople } from './track';

const SHADES = 256;

/** Colours of all depths from near to far, for tables. */
export const DEPTH_COLOURS: Rgb[] = Array.from({ length: SHADES }, (_, i) => depthColour(i / (SHADES - 1)));

/** Pixels that are put together before they are drawn. */
export class Pixels {
  readonly image: ImageData;
  private readonly words: Uint32Array;

  constructor(width: number, height: number) {
    this.image = new ImageData(width, height);
    this.words = new Uint32Array(this.image.data.buffer);
  }

  /** `opacity` 0-255. Browsers are little-endian. */
  static word([r, g, b]: Rgb, opacity = 255): number {
    return ((opacity << 24) | (b << 16) | (g << 8) | r) >>> 0;
  }
  set(pixel: number, word: number): void {
    this.words[pixel] = word;
  }

  depth(depth: Uint16Array, [near, far]: [number, number]): this {
    const words = DEPTH_COLOURS.map((colour) => Pixels.word(colour));
    const scale = (SHADES - 1) / (far - near);
    for (let i = 0; i < depth.length; ++i) {
      const shade = Math.min(Math.max((depth[i] - near) * scale, 0), SHADES - 1) | 0;
      this.words[i] = depth[i] === 0 ? 0xff000000 : words[shade];
    }
    return this;
  }

  labels(labels: Uint8Array, colours: Rgb[], opacity = 255): this {
    const words = Uint32Array.from({ length: 256 }, (_, i) => (colours[i] ? Pixels.word(colours[i], opacity) : 0));
    words[BACKGROUND] = 0;
    for (let i = 0; i < labels.length; ++i) if (labels[i] !== BACKGROUND) this.words[i] = words[labels[i]];
    return this;
  }

  /** Marks where labels change, on the side of the smaller one. */
  borders(labels: Uint8Array, width: number, colour: (label: number) => number): this {
    for (let i = 0; i + width + 1 < labels.length; ++i) {
      const label = labels[i];
      if (label !== labels[i + 1] || label !== labels[i + width]) {
        const other = label !== labels[i + 1] ? labels[i + 1] : labels[i + width];
        this.words[i] = colour(Math.min(label, other));
      }
    }
    return this;
  }
}

/** Draws pixels over what is on a canvas. */
export function drawOver(context: CanvasRenderingContext2D, pixels: Pixels): void {
  const { image } = pixels;
  const layer = new OffscreenCanvas(image.width, image.height);
  layer.getContext('2d')?.putImageData(image, 0, 0);
  context.drawImage(layer, 0, 0);
}

/** The links between points of a skeleton. */
export function drawLinks(
  context: CanvasRenderingContext2D,
  links: [number, number][],
  place: (point: number) => [number, number] | null,
  colour: Rgb,
  isDashed: (a: number, b: number) => boolean,
  width = 2.5,
): void {
  for (const [a, b] of links) {
    const from = place(a);
    const to = place(b);
    if (!from || !to) continue;
    for (const [stroke, extra] of [['rgb(0 0 0 / 0.7)', 0.8 * width], [css(colour), 0]] as const) {
      context.strokeStyle = stroke;
      context.lineWidth = width + extra;
      context.setLineDash(isDashed(a, b) ? [4, 4] : []);
      context.beginPath();
      context.moveTo(...from);
      context.lineTo(...to);
      context.stroke();
    }
  }
  context.setLineDash([]);
}

/** The camera's picture with the people over it. */
export class Flat {
  private readonly context: CanvasRenderingContext2D;
  private frame: Frame | null = null;
  private body: Body | null = null;
  private partColours: Rgb[] = [];
  private colouring: Colouring = 'person';
  private showsBoxes = false;
  private showsTrails = true;
  private cross: Px | null = null;  // that arrow keys move, while the picture has the focus
  selected = -1;

  /** `choose` receives the place of a pixel that is clicked, null where it has none. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly readout: HTMLElement,
    private readonly skeletons: Skeletons,
    private readonly memory: TrackMemory,
    private readonly marks: Marks,
    private readonly measure: Measure,
    private readonly choose: (xyz: Xyz | null) => void,
  ) {
    this.context = canvas.getContext('2d') as CanvasRenderingContext2D;
    const at = (event: PointerEvent, act: (pixel: Px) => void): void => {
      const pixel = this.pixelAt(event);
      if (pixel) act(pixel);
    };
    canvas.addEventListener('pointermove', (event) => at(event, (pixel) => this.read(pixel)));
    canvas.addEventListener('pointerdown', (event) => at(event, (pixel) => this.read(pixel)));
    canvas.addEventListener('click', (event) => at(event as PointerEvent, (pixel) => this.choose(this.placeOf(pixel))));
    canvas.addEventListener('keydown', (event) => this.moveCross(event));
    canvas.addEventListener('blur', () => this.showCross(null));
  }

  setBody(body: Body, colours: Rgb[]): void {
    this.body = body;
    this.partColours = colours;
    this.draw();
  }
  setColouring(colouring: Colouring): void {
    this.colouring = colouring;
    this.draw();
  }
  setShown(boxes: boolean, trails: boolean): void {
    this.showsBoxes = boxes;
    this.showsTrails = trails;
    this.draw();
  }
  select(person: number): void {
    this.selected = person;
    this.draw();
  }
  show(frame: Frame): void {
    this.frame = frame;
    this.draw();
  }

  draw(): void {
    const { frame, body, context } = this;
    if (!frame || !body) return;
    const { width, height } = frame.found.camera;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
      this.canvas.style.aspectRatio = `${width} / ${height}`;
    }
    if (frame.colour && this.colouring !== 'depth') {
      context.drawImage(frame.colour, 0, 0);
    } else {
      context.putImageData(new Pixels(width, height).depth(frame.depth, depthRange(frame.depth)).image, 0, 0);
    }
    const people = coloursByIndex(frame.found);
    const over = new Pixels(width, height);
    if (this.colouring === 'person') over.labels(frame.labels.people, people, 120);
    if (this.colouring === 'part') over.labels(frame.labels.parts, this.partColours, 190);
    over.borders(frame.labels.people, width, (label) => Pixels.word(people[label] ?? [255, 255, 255]));
    drawOver(context, over);
    for (const person of shownPeople(frame.found)) {
      if (this.showsTrails) this.drawTrail(person, frame);
      this.drawPerson(person, frame);
    }
    const above = new Over(context, frame.found.camera, this.scale());
    for (const person of shownPeople(frame.found)) {
      if (this.selected < 0 || this.selected === numberOf(person)) above.marks(person, this.marks);
    }
    above.measured(this.measure.points);
    if (this.cross) above.cross(this.cross);
  }

  private drawPerson(person: Person, frame: Frame): void {
    const { context } = this;
    const tint = personColour(numberOf(person));
    const isSelected = numberOf(person) === this.selected;
    const { points, links } = this.skeletons.of(person);
    const places = points.map((point) => point && project(point.xyz, frame.found.camera));
    const dashed = (a: number, b: number): boolean => !points[a] || !points[b] || !isSeen(points[a], points[b]);
    context.globalAlpha = isHidden(person) ? 0.65 : 1;
    drawLinks(context, links, (p) => places[p] ?? null, tint, dashed, (isSelected ? 2.6 : 1.6) * this.scale());
    context.globalAlpha = 1;
    const isInPicture = person.box_px[2] > 0;
    if (isInPicture && (this.showsBoxes || isSelected)) {
      context.strokeStyle = css(tint);
      context.lineWidth = 1.4 * this.scale();
      context.strokeRect(...person.box_px);
    }
    const corner = isInPicture ? person.box_px : places.reduce((top, place) => (place && (!top || place[1] < top[1]) ? place : top), null);
    if (corner) this.tag(person, corner[0], corner[1]);
  }

  private drawTrail(person: Person, frame: Frame): void {
    const { context } = this;
    context.strokeStyle = css(personColour(numberOf(person)));
    context.lineCap = 'round';
    for (const piece of this.memory.trail(person)) {
      const from = project(piece.from, frame.found.camera);
      const to = project(piece.to, frame.found.camera);
      if (!from || !to) continue;
      context.globalAlpha = (piece.hidden ? 0.4 : 0.9) * (1 - piece.age);
      context.lineWidth = (1 + 3 * (1 - piece.age)) * this.scale();
      context.beginPath();
      context.moveTo(...from);
      context.lineTo(...to);
      context.stroke();
    }
    context.globalAlpha = 1;
    context.lineCap = 'butt';
  }

  /** How many pixels of the picture one on the screen is: what is drawn on it should be as large for every camera. */
  private scale(): number {
    return Math.max(1, this.canvas.width / (this.canvas.clientWidth || this.canvas.width));
  }

  private tag(person: Person, u: number, v: number): void {
    const { context } = this;
    const number = numberOf(person);
    const text = isHidden(person) ? `${number} hidden` : String(number);
    const size = 12 * this.scale();
    context.font = `bold ${size}px system-ui, sans-serif`;
    const width = context.measureText(text).width + 0.6 * size;
    const top = Math.max(v - 1.25 * size, 0);
    context.fillStyle = css(personColour(number));
    context.fillRect(u, top, width, 1.25 * size);
    context.fillStyle = '#000';
    context.fillText(text, u + 0.3 * size, top + size);
  }

  /** The pixel under the pointer; the canvas shows the picture as large as fits into it. */
  private pixelAt(event: PointerEvent): Px | null {
    if (!this.frame) return null;
    const area = this.canvas.getBoundingClientRect();
    const { width, height } = this.frame.found.camera;
    const scale = Math.min(area.width / width, area.height / height);
    const u = Math.floor((event.clientX - area.left - (area.width - scale * width) / 2) / scale);
    const v = Math.floor((event.clientY - area.top - (area.height - scale * height) / 2) / scale);
    return u < 0 || v < 0 || u >= width || v >= height ? null : [u, v];
  }

  /** The place that a pixel shows; null where the camera has no reading. */
  private placeOf([u, v]: Px): Xyz | null {
    if (!this.frame) return null;
    const { width, fx, fy, cx, cy } = this.frame.found.camera;
    const z = this.frame.depth[v * width + u] * 1e-3;
    return z === 0 ? null : [((u - cx) / fx) * z, ((v - cy) / fy) * z, z];
  }

  private showCross(cross: Px | null): void {
    this.cross = cross;
    if (cross) this.read(cross);
    this.draw();
  }

  private moveCross(event: KeyboardEvent): void {
    if (!this.frame) return;
    const { width, height } = this.frame.found.camera;
    const [u, v] = this.cross ?? [Math.floor(width / 2), Math.floor(height / 2)];
    const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!by && event.key !== 'Enter') return;
    event.preventDefault();
    event.stopPropagation();
    if (!by) return this.choose(this.placeOf([u, v]));
    const far = event.shiftKey ? 1 : 8;
    const within = (value: number, most: number): number => Math.min(Math.max(value, 0), most - 1);
    this.showCross([within(u + far * by[0], width), within(v + far * by[1], height)]);
  }

  /** Tells what a pixel shows. */
  private read([u, v]: Px): void {
    const { frame, body } = this;
    if (!frame || !body) return;
    const { width } = frame.found.camera;
    const pixel = v * width + u;
    const mm = frame.depth[pixel];
    const person = frame.found.people.find(({ index }) => index === frame.labels.people[pixel]);
    const part = frame.labels.parts[pixel];
    const words = [`(${u}, ${v})`, mm === 0 ? 'no reading' : `${(mm / 1000).toFixed(2)} m`];
    if (person) words.push(`person ${numberOf(person)}`);
    if (part !== BACKGROUND) words.push(body.parts[part].name);
    this.readout.textContent = words.join(' · ');
  }
}
