// Runs `vesalius view` for long, with many pages of which one is stalled, and tells what it costs:
//   node web/tests/soak.mjs SECONDS [PAGES] SOURCE [FLAG...]
// The pages are WebSockets without a browser. Exit code 1 where frames are lost, late, or memory grows.
import { readFileSync } from 'node:fs';
import WebSocket from 'ws';
import { View } from './program.mjs';

const MOST_DROPPED = 0.1;   // of all frames
const MOST_MS = 100;        // from arrival to page, median
const MOST_GROWTH = 0.02;   // of memory, from the end of the first tenth on
const SAMPLE_S = 2;

const [seconds, pages, source, ...flags] = /^\d+$/.test(process.argv[3])
  ? process.argv.slice(2)
  : [process.argv[2], '1', ...process.argv.slice(3)];

const view = await View.start(source, '--port', '0', ...flags);

/** Megabytes of the program that are in memory. */
function memory() {
  const status = readFileSync(`/proc/${view.child.pid}/status`, 'utf8');
  return Number(/VmRSS:\s+(\d+)/.exec(status)[1]) / 1000;
}

/** Processor time of the program so far, milliseconds. */
function processorMs() {
  const fields = readFileSync(`/proc/${view.child.pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return 10 * (Number(fields[11]) + Number(fields[12]));  // Linux counts hundredths of a second
}

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)];
}

const states = [];
const frames = new Array(Number(pages)).fill(0);
let isEnding = false;
let stalls = 0;

function openPage(i) {
  const socket = new WebSocket(view.address.replace('http', 'ws') + 'stream', { perMessageDeflate: false });
  const isStalled = i > 0 && i === frames.length - 1;
  if (isStalled) ++stalls;
  // The program hangs up on a page that answers no ping for five minutes; another comes and stalls as well.
  socket.on('close', () => isStalled && !isEnding && openPage(i));
  socket.on('error', () => {});
  socket.on('message', (message, isBinary) => {
    if (isStalled) return socket.pause();
    if (isBinary) {
      ++frames[i];
      socket.send('next');
    } else if (i === 0 && JSON.parse(message).type === 'state') {
      states.push({ ...JSON.parse(message), processorMs: processorMs() });
    }
  });
}

frames.forEach((_, i) => openPage(i));

const samples = [];
const timer = setInterval(() => samples.push(memory()), 1000 * SAMPLE_S);
await new Promise((resolve) => setTimeout(resolve, 1000 * Number(seconds)));
clearInterval(timer);
isEnding = true;
const code = await view.stop();

// The first twentieth is for starting.
const settled = states.filter((_, i) => i > states.length / 20);
const [first, last] = [settled[0], settled.at(-1)];
const detected = last.frames - first.frames;
const dropped = last.dropped - first.dropped;
const early = median(samples.slice(Math.floor(samples.length / 10), Math.ceil(samples.length / 5)));
const late = median(samples.slice(-Math.ceil(samples.length / 10)));
const figures = {
  frames_per_s: median(settled.map((state) => state.frames_per_s)),
  dropped_share: Number((dropped / (detected + dropped)).toFixed(4)),
  result_ms: median(settled.map((state) => state.result_ms)),
  page_ms: median(settled.map((state) => state.page_ms)),
  processor_ms_a_frame: Math.round((last.processorMs - first.processorMs) / detected),
  memory_mb: [early, late, Math.max(...samples)].map(Math.round),
  frames_of_pages: frames,
  stalled_pages: stalls,
};
console.log(JSON.stringify(figures));
const faults = [
  code !== 0 && `exit code ${code}: ${view.errors}`,
  figures.dropped_share > MOST_DROPPED && `${100 * figures.dropped_share} % of the frames dropped`,
  figures.page_ms > MOST_MS && `${figures.page_ms} ms to the page`,
  late > (1 + MOST_GROWTH) * early && `memory grew from ${early} to ${late} MB`,
  frames.some((count, i) => (i === 0 || i < frames.length - 1) && count < 0.8 * detected) && 'pages got too few frames',
].filter(Boolean);
for (const fault of faults) console.error(fault);
process.exit(faults.length === 0 ? 0 : 1);
