// The page of a report: what was measured lies in it as a list of blocks (training/report/document.h).
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import './report.css';

type Point = [number | null, number | null];
type Range = [number, number];

interface Plot {
  kind: 'plot';
  caption: string;
  x: string;
  y: string;
  log_x: boolean;
  x_range: Range | null;
  y_range: Range | null;
  series: { name: string; points: Point[] }[];
}

interface Matrix {
  kind: 'matrix';
  caption: string;
  names: string[];
  shares: number[][];
}

interface Bars {
  kind: 'bars';
  caption: string;
  names: string[];
  series: [string, (number | null)[]][];
}

type Block =
  | { kind: 'heading'; level: number; text: string }
  | { kind: 'paragraph' | 'preformatted'; text: string }
  | { kind: 'table'; rows: string[][] }
  | { kind: 'picture'; png: string; caption: string }
  | Plot
  | Matrix
  | Bars;

function element<Tag extends keyof HTMLElementTagNameMap>(tag: Tag, text = '', ...children: Node[]) {
  const made = document.createElement(tag);
  made.textContent = text;
  made.append(...children);
  return made;
}

function wide(table: HTMLTableElement): HTMLElement {
  const box = element('div', '', table);
  box.className = 'wide';
  box.tabIndex = 0; // can be scrolled by keys
  return box;
}

/** The first row is the header. Columns of numbers are aligned at the right. */
function table(rows: string[][]): HTMLElement {
  const [header, ...body] = rows;
  const isNumber = (cell: string) => /^[+-]?\d/.test(cell);
  const numbers = header.map((_, c) => body.some((row) => row[c]) && body.every((row) => !row[c] || isNumber(row[c])));
  const line = (tag: 'th' | 'td') => (row: string[]) => {
    const made = element('tr');
    row.forEach((text, c) => made.append(Object.assign(element(tag, text), { className: numbers[c] ? 'number' : '' })));
    return made;
  };
  const head = header.some(Boolean) ? [element('thead', '', line('th')(header))] : [];
  return wide(element('table', '', ...head, element('tbody', '', ...body.map(line('td')))));
}

function matrix({ caption, names, shares }: Matrix): HTMLElement {
  const head = element('tr', '', element('th'), ...names.map((name) => element('th', name)));
  const lines = shares.map((row, r) => {
    const cells = row.map((share, c) => {
      const cell = element('td', share >= 0.005 ? (100 * share).toFixed(0) : '');
      cell.className = 'number';
      cell.style.setProperty('--share', Math.sqrt(share).toFixed(3)); // the root shows small shares
      cell.title = `${names[r]} as ${names[c]}: ${(100 * share).toFixed(1)} %`;
      return cell;
    });
    return element('tr', '', element('th', names[r]), ...cells);
  });
  const made = element('table', '', element('thead', '', head), element('tbody', '', ...lines));
  made.className = 'matrix';
  return element('figure', '', wide(made), element('figcaption', caption));
}

function bars({ caption, names, series }: Bars): HTMLElement {
  const bar = (text: string, i: number, share: number) => {
    const made = element('div', '', element('i'), element('span', text));
    made.style.setProperty('--bar', `var(--line-${i + 2})`);
    made.style.setProperty('--share', share.toFixed(3));
    return made;
  };
  const legend = element('tr', '', element('th'), element('th', '', ...series.map(([name], i) => bar(name, i, 0.03))));
  const lines = names.map((name, n) => {
    const shown = series.map(([, shares], i) => bar(shares[n] === null ? '–' : `${(100 * shares[n]).toFixed(0)} %`, i, shares[n] ?? 0));
    return element('tr', '', element('th', name), element('td', '', ...shown));
  });
  const made = element('table', '', element('thead', '', legend), element('tbody', '', ...lines));
  made.className = 'bars';
  return element('figure', '', wide(made), element('figcaption', caption));
}

/** Puts all lines on one axis, as uPlot wants it. */
function aligned(plot: Plot): uPlot.AlignedData {
  const tables = plot.series.map(({ points }) => {
    const known = points.filter(([x]) => x !== null) as [number, number | null][];
    known.sort((a, b) => a[0] - b[0] || (a[1] ?? 0) - (b[1] ?? 0));
    return [known.map(([x]) => x), known.map(([, y]) => y)] as uPlot.AlignedData;
  });
  return uPlot.join(tables);
}

const colour = (name: string) => () => getComputedStyle(document.documentElement).getPropertyValue(name);
const short = (value: number) => Number(value.toPrecision(4)).toString();
const plots: uPlot[] = [];

function plot(shown: Plot): HTMLElement {
  const data = aligned(shown);
  const box = element('div');
  const figure = element('figure', '', box, element('figcaption', shown.caption));
  const axis = (label: string) => ({ label, stroke: colour('--ink'), grid: { stroke: colour('--line'), width: 1 }, ticks: { stroke: colour('--line') } });
  const scale = (range: Range | null) => (range ? { range: () => range } : {});
  const value = (_: uPlot, v: number | null) => (v == null ? '–' : short(v));
  const made = new uPlot(
    {
      width: 800,
      height: 340,
      scales: { x: { time: false, distr: shown.log_x ? 3 : 1, ...scale(shown.x_range) }, y: scale(shown.y_range) },
      axes: [axis(shown.x), axis(shown.y)],
      series: [
        { label: shown.x, value },
        ...shown.series.map(({ name }, i) => ({
          label: name,
          value,
          stroke: colour(`--line-${(i % 6) + 1}`),
          width: 2,
          dash: [[], [8, 4], [2, 3], [10, 3, 2, 3]][i % 4],
          points: { show: true, size: 5 },
        })),
      ],
    },
    data,
    box,
  );
  made.root.querySelector('canvas')!.setAttribute('role', 'img');
  made.root.querySelector('canvas')!.setAttribute('aria-label', `${shown.caption}; the values follow`);
  plots.push(made);
  new ResizeObserver(([entry]) => made.setSize({ width: entry.contentRect.width, height: 340 })).observe(figure);
  const [xs, ...lines] = data;
  const cells = Array.from(xs, (x, i) => [x, ...lines.map((line) => line[i])].map((v) => (v == null ? '' : short(v))));
  const names = [shown.x, ...shown.series.map(({ name }) => name)];
  figure.append(element('details', '', element('summary', 'Values'), table([names, ...cells])));
  return figure;
}

function made(block: Block): HTMLElement {
  switch (block.kind) {
    case 'heading':
      return element(`h${block.level}` as 'h2', block.text);
    case 'paragraph':
      return element('p', block.text);
    case 'preformatted':
      return element('pre', block.text);
    case 'table':
      return table(block.rows);
    case 'matrix':
      return matrix(block);
    case 'bars':
      return bars(block);
    case 'plot':
      return plot(block);
    case 'picture': {
      const picture = Object.assign(element('img'), { alt: block.caption, src: `data:image/png;base64,${block.png}` });
      return element('figure', '', picture, element('figcaption', block.caption));
    }
  }
}

function contents(headings: HTMLElement[]): HTMLElement {
  const lines = headings.map((heading, i) => {
    heading.id = `section-${i}`;
    return element('li', '', Object.assign(element('a', heading.textContent!), { href: `#${heading.id}` }));
  });
  return Object.assign(element('nav', '', element('ul', '', ...lines)), { ariaLabel: 'Contents' });
}

const report: { title: string; blocks: Block[] } = JSON.parse(document.getElementById('report')!.textContent!);
document.title = report.title;
const blocks = report.blocks.map(made);
const headings = blocks.filter((block) => block.matches('h2'));
document.querySelector('main')!.replaceChildren(element('h1', report.title), contents(headings), ...blocks);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => plots.forEach((plot) => plot.redraw()));
