// Curves of what is measured of somebody over time.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { History, Measure } from './history';
import { ANGLES, inWords } from './marks';
import { element } from './people';
import { ViewState } from './protocol';

const PAUSE_MS = 200;  // between drawings: frames come faster
const HEIGHT_PX = 118;
const FIRST_ANGLE = String(ANGLES.findIndex(([name]) => name === 'l_knee'));

interface Line {
  measure: number;
  name: string;
}

/** One plot; `most` is where its scale ends at least. */
interface Plot {
  title: string;
  unit: string;
  decimals: number;
  most: number;
  lines: Line[];
}

const PLOTS: Plot[] = [
  { title: 'Height of the head over the floor', unit: 'm', decimals: 2, most: 2, lines: [{ measure: Measure.height, name: '' }] },
  { title: 'Speed', unit: 'm/s', decimals: 2, most: 1, lines: [{ measure: Measure.speed, name: '' }] },
  { title: 'Angle', unit: '°', decimals: 0, most: 180, lines: [{ measure: Measure.angle, name: '' }] },
  {
    title: 'Confidence',
    unit: '%',
    decimals: 0,
    most: 100,
    lines: [
      { measure: Measure.score, name: 'person' },
      { measure: Measure.confidence, name: 'joints, dashed' },
    ],
  },
];

const colour = (name: string) => (): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function choice(label: string, options: [value: string, text: string][], chosen: string): [HTMLElement, HTMLSelectElement] {
  const select = element('select', options.map(([value, text]) => Object.assign(element('option', [text]), { value })));
  select.value = chosen;
  return [element('label', [label, select]), select];
}

/** The panel of curves. It draws while it is shown, and no faster than eyes need it. */
export class Curves {
  private readonly person: HTMLSelectElement;
  private readonly angle: HTMLSelectElement;
  private readonly stretch: HTMLSelectElement;
  private readonly note = element('p');
  private readonly figures = element('div');
  private plots: { plot: uPlot; caption: HTMLElement; facts: Plot }[] = [];
  private state: ViewState | null = null;
  private at_s = 0;
  private selected = -1;
  private window: [number, number] = [0, 1];  // what is drawn, from the origin on
  private origin_s = 0;
  private timer = 0;

  constructor(
    private readonly panel: HTMLElement,
    private readonly history: History,
    private readonly choose: (number: number) => void,
    private readonly seek: (to_s: number) => void,
    private readonly clock: (at_s: number) => string,
  ) {
    const [person, people] = choice('Person', [], '');
    const [angle, angles] = choice('Angle', ANGLES.map(([name], i) => [String(i), inWords(name)]), FIRST_ANGLE);
    const times: [string, string][] = [['10', '10 s'], ['60', '1 min'], ['600', '10 min'], ['all', 'all']];
    const [stretch, stretches] = choice('Time', times, '60');
    [this.person, this.angle, this.stretch] = [people, angles, stretches];
    people.addEventListener('change', () => this.choose(Number(people.value)));
    for (const one of [angles, stretches]) one.addEventListener('change', () => this.draw());
    this.panel.append(element('p', [person, angle, stretch], 'row'), this.note, this.figures);
  }

  select(number: number): void {
    this.selected = number;
    this.draw();
  }

  /** `at_s` is the time of the frame that is shown. */
  show(state: ViewState, at_s: number): void {
    this.state = state;
    this.at_s = at_s;
    this.timer ||= window.setTimeout(() => this.draw(), PAUSE_MS);
  }

  /** Draws at once: after the panel was opened, and in the colours of another theme. */
  draw(): void {
    window.clearTimeout(this.timer);
    this.timer = 0;
    if (this.panel.hidden || !this.state) return;
    this.fillPeople();
    const number = this.selected;
    this.note.hidden = number >= 0;
    this.figures.hidden = number < 0;
    this.note.textContent = this.history.people().length > 0 ? 'Choose a person to see curves.' : 'Nobody was seen yet.';
    if (number < 0) return;
    if (this.plots.length === 0) this.plots = PLOTS.map((facts) => this.makePlot(facts));
    const [from_s, to_s] = this.stretchShown(this.state);
    this.origin_s = this.state.span_s?.[0] ?? this.at_s;
    this.window = [from_s - this.origin_s, to_s - this.origin_s];
    const values = this.history.at(number, this.at_s);
    for (const { plot, caption, facts } of this.plots) {
      const measures = facts.lines.map(({ measure }) => this.measureOf(measure));
      const series = this.history.series(number, from_s, to_s, measures);
      plot.setData([series.at_s.map((at_s) => at_s - this.origin_s), ...series.values]);
      const title = facts.lines[0].measure === Measure.angle ? `Angle of the ${inWords(ANGLES[Number(this.angle.value)][0])}` : facts.title;
      const numbers = facts.lines.map(({ name }, i) => {
        const value = values?.[measures[i]] ?? NaN;
        return `${name}${name ? ' ' : ''}${Number.isNaN(value) ? '–' : `${value.toFixed(facts.decimals)} ${facts.unit}`}`;
      });
      caption.textContent = `${title}: ${numbers.join(', ')}`;
      plot.root.querySelector('canvas')?.setAttribute('aria-label', `${caption.textContent} at ${this.clock(this.at_s)}`);
    }
  }

  private measureOf(measure: number): number {
    return measure === Measure.angle ? measure + Number(this.angle.value) : measure;
  }

  private fillPeople(): void {
    const known = this.history.people();
    if (this.selected >= 0 && !known.includes(this.selected)) known.push(this.selected);
    const values = ['-1', ...known.map(String)];
    if (values.join() !== [...this.person.options].map((option) => option.value).join()) {
      this.person.replaceChildren(
        ...values.map((value) => Object.assign(element('option', [value === '-1' ? 'nobody' : value]), { value })),
      );
    }
    this.person.value = String(this.selected);
  }

  /** The stretch of time that is drawn: about now where one can seek, otherwise up to now. */
  private stretchShown({ span_s }: ViewState): [number, number] {
    const seconds = this.stretch.value === 'all' ? Infinity : Number(this.stretch.value);
    if (!span_s) {
      const first = Math.max(this.history.first_s() ?? this.at_s, this.at_s - seconds);
      return [Math.min(first, this.at_s - 1), this.at_s];
    }
    const [first, last] = [span_s[0], Math.max(span_s[1], span_s[0] + 1e-3)];
    if (last - first <= seconds) return [first, last];
    const from = Math.min(Math.max(this.at_s - seconds / 2, first), last - seconds);
    return [from, from + seconds];
  }

  /** Times on an axis: from the beginning of a recording, or seconds before now. */
  private timeTexts(seconds: number[]): string[] {
    if (!this.state?.span_s) return seconds.map((one) => `${Number(one.toFixed(1))} s`);
    const decimals = seconds.every(Number.isInteger) ? 0 : 1;
    return seconds.map((one) => {
      const rest = (one % 60).toFixed(decimals);
      return `${Math.floor(one / 60)}:${rest.padStart(decimals === 0 ? 2 : 4, '0')}`;
    });
  }

  private makePlot(facts: Plot): { plot: uPlot; caption: HTMLElement; facts: Plot } {
    const place = element('div');
    const caption = element('figcaption');
    const figure = element('figure', [caption, place], 'curve');
    this.figures.append(figure);
    const axis = { stroke: colour('--dim'), grid: { stroke: colour('--line'), width: 1 }, ticks: { stroke: colour('--line') }, font: '12px system-ui' };
    const top = (_: uPlot, __: number, most: number): [number, number] => [0, Math.max(most ?? 0, facts.most)];
    const plot = new uPlot(
      {
        width: 300,
        height: HEIGHT_PX,
        legend: { show: false },
        cursor: { y: false, drag: { x: false, y: false }, sync: { key: 'curves' } },
        scales: { x: { time: false, range: () => this.window }, y: { range: top } },
        axes: [
          { ...axis, size: 24, space: 60, values: (_, seconds) => this.timeTexts(seconds) },
          { ...axis, size: 40, space: 24, label: facts.unit, labelSize: 16, labelFont: '12px system-ui' },
        ],
        series: [
          {},
          ...facts.lines.map((_, i) => ({
            stroke: colour(i === 0 ? '--accent' : '--ink'),
            width: 1.6,
            dash: i === 0 ? [] : [5, 4],
            points: { show: false },
          })),
        ],
        hooks: { draw: [(drawn) => this.drawNow(drawn)] },
      },
      [[], ...facts.lines.map(() => [])],
      place,
    );
    plot.root.querySelector('canvas')?.setAttribute('role', 'img');
    plot.over.addEventListener('click', (event) => {
      if (this.state?.span_s) this.seek(this.origin_s + plot.posToVal(event.offsetX, 'x'));
    });
    new ResizeObserver(([entry]) => {
      if (entry.contentRect.width > 0) plot.setSize({ width: entry.contentRect.width, height: HEIGHT_PX });
    }).observe(figure);
    return { plot, caption, facts };
  }

  /** A line at the time that is shown. */
  private drawNow(plot: uPlot): void {
    const { ctx, bbox } = plot;
    const x = plot.valToPos(this.at_s - this.origin_s, 'x', true);
    if (!(x >= bbox.left - 1 && x <= bbox.left + bbox.width + 1)) return;
    ctx.save();
    ctx.strokeStyle = colour('--ink')();
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.setLineDash([]);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }
}
