// The page of a report in a real browser. Run by `./dev web`, or: node --test web/tests/
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { gunzipSync } from 'node:zlib';
import { launch, newFolder, root, run } from './program.mjs';

const pictures = join(root, 'out/web');
mkdirSync(pictures, { recursive: true });
const made = newFolder();
let browser;
before(async () => (browser = await launch()));
after(async () => {
  await browser?.close();
  made.remove();
});

/** Opens a page without a network and runs `work` on it in light and dark; the page must not have complained. */
async function withPage(file, name, work) {
  for (const colorScheme of ['light', 'dark']) {
    const context = await browser.newContext({ colorScheme, offline: true, viewport: { width: 1100, height: 1400 } });
    const page = await context.newPage();
    const complaints = [];
    page.on('pageerror', (error) => complaints.push(String(error)));
    page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
    page.on('request', (request) => /^(file|data|blob):/.test(request.url()) || complaints.push(request.url()));
    await page.goto(pathToFileURL(file).href);
    await page.screenshot({ path: join(pictures, `report_${name}_${colorScheme}.png`), fullPage: true });
    const [ground, ink] = await page.evaluate(() => {
      const { backgroundColor, color } = getComputedStyle(document.body);
      return [backgroundColor, color].map((text) => text.match(/\d+/g).reduce((sum, part) => sum + Number(part), 0));
    });
    assert.ok(colorScheme === 'light' ? ground > ink + 300 : ink > ground + 300, `${colorScheme}: ${ground} under ${ink}`);
    await work(page);
    assert.deepEqual(complaints, []);
    await context.close();
  }
}

const texts = (page, selector) => page.locator(selector).allTextContents();

/** Whether the canvas has a pixel other than the first one. */
const isDrawn = (canvas) => {
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  return data.some((byte, i) => byte !== data[i % 4]);
};

test('every kind of block is shown, and text stays text', async () => {
  const line = { name: 'a <b>', points: [[1, 0.5], [10, null], [100, 0.25]] };
  const blocks = [
    { kind: 'heading', level: 2, text: 'Curves & tables' },
    { kind: 'paragraph', text: '<script>alert(1)</script>' },
    { kind: 'preformatted', text: 'one\n  two' },
    { kind: 'table', rows: [['part', 'share'], ['hand', '81.20 %'], ['foot', '']] },
    { kind: 'plot', caption: 'Curve', x: 'frames', y: 'share', log_x: true, x_range: null, y_range: [0, 1],
      series: [line, { name: 'b', points: [[1000, 1], [1, 0]] }] },
    { kind: 'bars', caption: 'By part', names: ['hand', 'foot'], series: [['of 4', [0.5, 0.25]], ['of 8', [1, null]]] },
    { kind: 'matrix', caption: 'Confusion', names: ['hand', 'foot'], shares: [[0.9, 0.1], [0, 1]] },
  ];
  const report = JSON.stringify({ title: 'a & b', blocks }).replaceAll('<', '\\u003c');
  const page = gunzipSync(readFileSync(join(root, 'training/report/bundle/report.html.gz'))).toString();
  const file = join(made.folder, 'blocks.html');
  writeFileSync(file, page.replace('>null</script>', () => `>${report}</script>`));
  await withPage(file, 'blocks', async (page) => {
    assert.equal(await page.title(), 'a & b');
    assert.deepEqual(await texts(page, 'nav a'), ['Curves & tables']);
    assert.deepEqual(await texts(page, 'main > p'), ['<script>alert(1)</script>']);
    assert.deepEqual(await texts(page, 'pre'), ['one\n  two']);
    assert.deepEqual(await texts(page, 'main > .wide .number'), ['share', '81.20 %', '']);
    assert.deepEqual(await texts(page, '.matrix td'), ['90', '10', '', '100']);
    assert.deepEqual(await texts(page, '.bars th span'), ['of 4', 'of 8']);
    assert.deepEqual(await texts(page, '.bars td span'), ['50 %', '100 %', '25 %', '–']);
    const lengths = await page.locator('.bars td i').evaluateAll((all) => all.map((bar) => bar.getBoundingClientRect().width));
    assert.ok(Math.abs(lengths[0] - lengths[1] / 2) < 1 && Math.abs(lengths[2] - lengths[1] / 4) < 1 && lengths[3] <= 1);
    assert.equal(await page.locator('figure canvas').evaluate(isDrawn), true);
    assert.deepEqual(await texts(page, '.u-series th'), ['frames', 'a <b>', 'b']);
    assert.deepEqual(await texts(page, 'details td'), ['1', '0.5', '0', '10', '', '', '100', '0.25', '', '1000', '', '1']);
  });
});

test('an evaluation is one page that opens without a network', async () => {
  const [model, sample] = [join(root, 'data/models/capsule.forest'), join(root, 'data/sample')];
  run('evaluate', sample, '-m', model, '--refine.min-score', '1', '--report', made.folder, '-q');
  await withPage(join(made.folder, 'report.html'), 'evaluation', async (page) => {
    assert.deepEqual(await texts(page, 'h2'), ['All sets', 'sample']);
    assert.ok((await page.locator('figure canvas').count()) >= 2);
    for (const canvas of await page.locator('figure canvas').all()) assert.equal(await canvas.evaluate(isDrawn), true);
    assert.ok((await page.locator('figure img').evaluateAll((all) => all.map((img) => img.naturalWidth))).every((w) => w > 0));
    assert.match((await texts(page, 'figcaption')).join(), /people missed/);
  });
});
