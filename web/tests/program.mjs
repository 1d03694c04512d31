// The program under test, and Chromium beside it.
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import http from 'node:http';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

export const root = join(dirname(fileURLToPath(import.meta.url)), '../..');
export const rooms = join(root, 'data/rooms');
const program = process.env.VESALIUS ?? join(root, 'build/dev/src/cli/vesalius');
const browserPath = process.env.CHROMIUM ?? '/usr/bin/chromium';

const FLAGS = [
  '--no-sandbox',
  '--disable-dev-shm-usage',  // small in containers
  '--no-first-run',
  '--disable-quic',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];
export const SOFTWARE_3D = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
export const NO_3D = ['--disable-gpu', '--disable-3d-apis'];

export function run(...words) {
  const result = spawnSync(program, words, { encoding: 'utf8', maxBuffer: 1 << 26 });
  if (result.status !== 0) throw new Error(`vesalius ${words.join(' ')}: ${result.stderr}`);
  return result.stdout;
}

/** Makes a clip of three rendered people who cross in `folder`/frames; it needs no bodies or motions from elsewhere. */
export function makeClip(folder) {
  const people = ['--people.none', '0', '--people.one', '0', '--people.two', '0', '--people.three', '1', '--people.four', '0'];
  const sensor = ['--sensor.width', '320', '--sensor.height', '240'];
  const words = ['--clip', '2', '--clip.crossing-share', '1', ...people, ...sensor, '--count', '1', '--seed', '3', '-q'];
  run('synth', '--out', join(folder, 'frames'), '--format', 'folder', ...words);
}

export function newFolder() {
  const folder = mkdtempSync(join(tmpdir(), 'vesalius_web_'));
  return { folder, remove: () => rmSync(folder, { recursive: true, force: true }) };
}

/** `vesalius view` until `stop`. */
export class View {
  static async start(...words) {
    const view = new View();
    view.child = spawn(program, ['view', '--no-browser', ...words], { stdio: ['ignore', 'pipe', 'pipe'] });
    view.errors = '';
    view.child.stderr.on('data', (text) => (view.errors += text));
    view.ended = new Promise((resolve) => view.child.on('exit', (code) => resolve(code)));
    view.address = await new Promise((resolve, reject) => {
      let text = '';
      view.child.stdout.on('data', (more) => {
        text += more;
        if (text.includes('\n')) resolve(text.slice(0, text.indexOf('\n')));
      });
      view.child.on('exit', () => reject(new Error(view.errors)));
    });
    view.port = Number(new URL(view.address).port);
    return view;
  }
  /** Ends it as Ctrl-C does and returns its exit code. */
  async stop() {
    this.child.kill('SIGINT');
    return this.ended;
  }
}

export async function launch(flags = SOFTWARE_3D) {
  return chromium.launch({ executablePath: browserPath, args: [...FLAGS, ...flags] });
}

/** Opens a page that must not complain. */
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 860 }, acceptDownloads: true, ...options });
  const page = await context.newPage();
  page.complaints = [];
  page.on('pageerror', (error) => page.complaints.push(error.message));
  page.on('console', (message) => {
    // Software rendering complains of its own slowness.
    if (['error', 'warning'].includes(message.type()) && !message.text().includes('GL Driver Message')) {
      page.complaints.push(message.text());
    }
  });
  await page.goto(address);
  return page;
}

/** Waits until `what` holds in the page. `what` is a function of the page. */
export async function until(page, what, argument = null) {
  await page.waitForFunction(what, argument, { timeout: 30000 });
}

/** The page's frame: its name, its number and its people. */
export async function shown(page) {
  return page.evaluate(() => {
    const frame = window.vesalius.frame();
    return frame && { name: frame.found.frame, number: frame.number, people: frame.found.people };
  });
}

/** A plain request with headers that browsers do not let scripts set. */
export async function request(port, path, headers = {}) {
  return new Promise((resolve, reject) => {
    const asked = http.request({ host: '127.0.0.1', port, path, headers }, (response) => {
      let text = '';
      response.on('data', (more) => (text += more));
      response.on('end', () => resolve({ status: response.statusCode, text, headers: response.headers }));
    });
    asked.on('upgrade', (response, socket) => {
      socket.destroy();
      resolve({ status: response.statusCode, text: '', headers: response.headers });
    });
    asked.on('error', reject);
    asked.end();
  });
}
