// The viewer in a real browser. Run by `./dev web`, or: node --test web/tests/
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, readdirSync, statSync, symlinkSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { NO_3D, View, rooms, launch, makeClip, newFolder, open, request, root, run, shown, until } from './program.mjs';

const pictures = join(root, 'out/web');
mkdirSync(pictures, { recursive: true });

let browser;
before(async () => (browser = await launch()));
let made = null;
after(async () => {
  await browser?.close();
  made?.remove();
});

/** A rendered clip of two seconds in which people walk, as a folder of frames. */
function clip() {
  if (!made) {
    made = newFolder();
    makeClip(made.folder);
  }
  return join(made.folder, 'frames');
}

/** Runs `work` with a viewer and a page on it; the page must not have complained. */
async function withPage(work, words = [], options = {}, useBrowser = null, source = rooms) {
  const view = await View.start(source, '--paused', '--port', '0', ...words);
  const page = await open(useBrowser ?? browser, view.address, options);
  try {
    await until(page, () => window.vesalius?.frame());
    await work(page, view);
    assert.deepEqual(page.complaints, []);
  } finally {
    await page.context().close();
    assert.equal(await view.stop(), 0, view.errors);
  }
}

function detected(source = rooms, ...flags) {
  const lines = run('detect', source, '-q', '--json', '-', ...flags).trim().split('\n');
  return lines.map((line) => JSON.parse(line)).filter((line) => line.people);
}

/** Goes to the next frame and waits until it is shown. */
async function step(page, by = 1) {
  const { number } = await shown(page);
  await page.keyboard.press(by > 0 ? 'ArrowRight' : 'ArrowLeft');
  await until(page, (last) => window.vesalius.frame().number > last, number);
}

/** The label pictures of the shown frame beside those that `vesalius detect` saves. */
async function differingPixels(page, png, labels) {
  return page.evaluate(
    async ([base64, name]) => {
      const picture = new Image();
      picture.src = `data:image/png;base64,${base64}`;
      await picture.decode();
      const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
      context.drawImage(picture, 0, 0);
      const saved = context.getImageData(0, 0, picture.width, picture.height).data;
      const mine = window.vesalius.frame().labels[name];
      return mine.reduce((sum, label, i) => sum + (label !== saved[4 * i] ? 1 : 0), 0);
    },
    [readFileSync(png).toString('base64'), labels],
  );
}

/** A number for what a canvas shows. */
async function look(page, id) {
  return page.evaluate((canvasId) => {
    const canvas = document.getElementById(canvasId);
    const copy = new OffscreenCanvas(200, 120);
    const context = copy.getContext('2d');
    window.vesalius.draw();
    context.drawImage(canvas, 0, 0, 200, 120);
    const bytes = context.getImageData(0, 0, 200, 120).data;
    return bytes.reduce((hash, byte) => (Math.imul(hash, 31) + byte) | 0, 7);
  }, id);
}

test('shows the people that detect finds, to the pixel', async () => {
  const expected = detected();
  const { folder, remove } = newFolder();
  run('detect', rooms, '-q', '--out', folder, '--save', 'labels,mask');
  await withPage(async (page) => {
    await page.selectOption('#skeleton', 'parts');
    for (const [i, line] of expected.entries()) {
      if (i > 0) await page.keyboard.press('ArrowRight');
      await until(page, (name) => window.vesalius.frame().found.frame === name, line.frame);
      assert.deepEqual((await shown(page)).people, line.people, line.frame);
      assert.equal(await page.locator('#list > li').count(), line.people.length);
      assert.equal(await differingPixels(page, join(folder, 'mask', `${line.frame}.png`), 'people'), 0);
      assert.equal(await differingPixels(page, join(folder, 'labels', `${line.frame}.png`), 'parts'), 0);
    }
    const counts = await page.evaluate(() => window.vesalius.counts());
    const parts = expected.at(-1).people.flatMap((person) => Object.values(person.parts)).filter((part) => part.xyz_m);
    assert.equal(counts.balls, parts.length);
    assert.ok(counts.rods >= parts.length - expected.at(-1).people.length, 'limbs between them');
    assert.ok(counts.points > 100000, `${counts.points} points`);
    assert.ok(!(await page.locator('#show-trails').isVisible()), 'nobody is followed');
    await page.click('#tab-options');
    assert.equal(await page.locator('[data-name^="track."]').count(), 0);
  }, ['--no-track']);
  remove();
});

test('follows the people of a clip as detect does', async () => {
  const expected = detected(clip(), '--track');
  const seen = expected.find((line) => line.people.some((person) => person.state === 'tracked' && person.body));
  assert.ok(seen, 'the clip has somebody to follow');
  await withPage(
    async (page) => {
      const colours = new Map();
      for (const [i, line] of expected.entries()) {
        if (i > 0) await step(page);
        const { people } = await shown(page);
        assert.deepEqual(people, line.people, line.frame);
        const present = people.filter((person) => person.state !== 'lost');
        const items = await page.locator('#list > li > button').evaluateAll((buttons) =>
          buttons.map((button) => ({
            number: button.dataset.number,
            text: button.innerText,
            colour: button.style.borderLeftColor,
            dashed: getComputedStyle(button).borderTopStyle,
          })),
        );
        assert.equal(items.length, present.length);
        for (const [k, person] of present.entries()) {
          const item = items[k];
          assert.equal(item.number, String(person.id));
          assert.match(item.text, new RegExp(`Person ${person.id}\\n.*${person.state}`));
          const reasons = Object.values(person.parts).filter((part) => part.unseen && part.unseen !== 'behind_person');
          for (const { unseen } of person.state === 'hidden' ? [] : reasons) {
            assert.ok(item.text.includes(`${unseen.replaceAll('_', ' ')}: `), item.text);
          }
          if (person.body) assert.ok(item.text.includes(`${person.body.stature_m.toFixed(2)} m tall`), item.text);
          if (person.stance !== 'unknown') assert.ok(item.text.includes(person.stance), item.text);
          assert.equal(item.dashed, person.state === 'hidden' ? 'dashed' : 'solid');
          colours.set(person.id, (colours.get(person.id) ?? new Set()).add(item.colour));
        }
        assert.equal(await page.locator('.tag.hidden-person').count(), present.filter((p) => p.state === 'hidden').length);
      }
      for (const [id, used] of colours) assert.equal(used.size, 1, `person ${id} keeps the colour`);
      assert.equal(new Set([...colours.values()].flatMap((used) => [...used])).size, Math.min(colours.size, 7));
      const events = expected.flatMap((line) => line.events);
      await until(page, (count) => window.vesalius.happened().events.filter(({ before }) => before).length >= count, events.length);
      const told = await page.evaluate(() => window.vesalius.happened().events);
      for (const { id, time_s, stance } of events) {
        assert.ok(told.some((event) => event.id === id && event.what === stance && Math.abs(event.at_s - time_s) < 1e-3), stance);
      }
      assert.equal(await page.locator('#events > li').count(), told.length);
      await page.click('#tab-options');
      await page.fill('#filter', 'track.hidden');
      assert.equal(await page.locator('[data-name="track.hidden"] input').inputValue(), '3');
    },
    [],
    {},
    null,
    clip(),
  );
});

test('trails grow, and going back takes them back', async () => {
  await withPage(
    async (page) => {
      const sure = (found) => found.people.filter((person) => person.state === 'tracked');
      const { name } = await shown(page);
      for (let i = 0; i < 12; ++i) await step(page);
      const [person] = sure(await shown(page));
      assert.ok(person, 'somebody is tracked');
      const length = () => page.evaluate((id) => window.vesalius.trail(id).length, person.id);
      const early = await length();
      const drawn = (await page.evaluate(() => window.vesalius.counts())).trails;
      assert.ok(early > 0 && drawn >= early, `${early} pieces, ${drawn} rods`);
      await step(page);
      assert.equal(await length(), early + 1);
      await page.screenshot({ path: join(pictures, 'trails.png') });
      const looks = [await look(page, 'cloud'), await look(page, 'picture')];
      await page.keyboard.press('t');
      assert.ok(!(await page.isChecked('#show-trails')));
      assert.equal((await page.evaluate(() => window.vesalius.counts())).trails, 0);
      assert.notEqual(await look(page, 'cloud'), looks[0]);
      assert.notEqual(await look(page, 'picture'), looks[1]);
      await page.keyboard.press('t');
      await step(page, -1);
      assert.equal(await length(), early);
      assert.ok(sure(await shown(page)).some(({ id }) => id === person.id), 'the same id as before');
      await page.keyboard.press('Home');
      await until(page, (first) => window.vesalius.frame().found.frame === first, name);
      assert.equal(await length(), 0);
      assert.equal((await page.evaluate(() => window.vesalius.counts())).trails, 0);
    },
    [],
    {},
    null,
    clip(),
  );
});

const demo = join(root, 'data/demo');

test('what happened is listed and marked, and a click goes there', async () => {
  await withPage(
    async (page, view) => {
      for (let i = 0; i < 48; ++i) await step(page);  // no frame is dropped, and somebody falls
      const fell = () => window.vesalius.happened().events.find(({ what }) => what === 'fallen');
      await until(page, fell);
      const { at_s, id } = await page.evaluate(fell);
      const line = page.locator('#events button', { hasText: `person ${id}: fell` });
      await line.focus();
      await page.keyboard.press('Enter');
      await until(page, (to) => Math.abs(window.vesalius.state().at_s - to) < 0.07, Math.max(at_s - 1, 0));
      assert.ok((await line.innerText()).startsWith(`0:0${at_s.toFixed(2)}`), await line.innerText());
      assert.equal(await page.locator('#marks .event').count(), await page.locator('#events > li').count());
      // People are there from the first frame on that is sure of them.
      const { seen_s, known_s } = await page.evaluate(() => window.vesalius.happened());
      const [first, last] = await page.evaluate(() => window.vesalius.state().span_s);
      assert.ok(known_s[0][0] === first && known_s[0][1] > first + 2, JSON.stringify(known_s));
      assert.ok(seen_s[0][0] < first + 1, JSON.stringify(seen_s));
      const box = await page.locator('#marks').boundingBox();
      await page.mouse.click(box.x + 0.9 * box.width, box.y + 12);
      await until(page, (to) => Math.abs(window.vesalius.state().at_s - to) < 0.2, first + 0.9 * (last - first));
      const share = (await page.locator('#marks .event').evaluateAll((lines) => lines.map((one) => parseFloat(one.getAttribute('x1')))))[0];
      const event = (await page.evaluate(() => window.vesalius.happened().events))[0];
      await page.mouse.click(box.x + (share / 100) * box.width + 2, box.y + 4);
      await until(page, (to) => Math.abs(window.vesalius.state().at_s - to) < 0.07, Math.max(event.at_s - 1, first));
      await page.screenshot({ path: join(pictures, 'happened.png') });
      const late = await open(browser, view.address);
      await until(late, (count) => document.querySelectorAll('#events > li').length === count, await page.locator('#events > li').count());
      await late.context().close();
    },
    [],
    {},
    null,
    demo,
  );
});

test('a stretch repeats until it is taken away', async () => {
  await withPage(
    async (page) => {
      const at = (to) => until(page, (wanted) => Math.abs(window.vesalius.state().at_s - wanted) < 0.05, to);
      const seek = async (to) => {
        await page.evaluate((value) => {
          const slider = document.getElementById('seek');
          slider.value = value;
          slider.dispatchEvent(new Event('input'));
        }, String(to));
        await at(to);
      };
      await seek(2);
      await page.keyboard.press('i');
      await until(page, () => window.vesalius.state().loop_s?.[0] === window.vesalius.state().at_s);
      await page.keyboard.press('ArrowRight');
      await at(2 + 1 / 15);
      await page.click('#loop-to');
      const loop = await (await page.waitForFunction(() => {
        const { loop_s, at_s } = window.vesalius.state();
        return loop_s?.[1] === at_s && loop_s;
      })).jsonValue();
      assert.ok(loop[0] > 1.9 && loop[1] < 2.2, JSON.stringify(loop));
      assert.equal(await page.locator('#marks .loop').count(), 1);
      assert.match(await page.locator('#marks svg').getAttribute('aria-label'), /repeats from 0:02\.00 to 0:02\.07/);
      await seek(1.9);  // paused, beyond it
      await page.click('#play');
      await page.evaluate(() => {
        window.places = [];
        setInterval(() => window.places.push(window.vesalius.state().at_s), 10);
      });
      await page.waitForTimeout(1500);
      const places = await page.evaluate(() => window.places);
      assert.ok(places.some((place) => place > 2.06) && places.every((place) => place < 2.1), JSON.stringify(places));
      await page.keyboard.press('l');
      await until(page, () => window.vesalius.state().loop_s === null);
      await until(page, () => window.vesalius.state().at_s > 2.3);
      assert.equal(await page.locator('#marks .loop').count(), 0);
    },
    [],
    {},
    null,
    demo,
  );
});

test('draws curves of the chosen person, and a click goes there', async () => {
  await withPage(
    async (page) => {
      for (let i = 0; i < 12; ++i) await step(page);
      await page.click('#tab-curves');
      assert.match(await page.locator('#curves').innerText(), /Choose a person/);
      const id = (await shown(page)).people[0].id;
      await page.locator('#curves select').first().selectOption(String(id));
      await until(page, () => document.querySelectorAll('#curves canvas').length === 4);
      // The numbers are those of the frame.
      const expected = await page.evaluate((number) => {
        const { found, floor } = window.vesalius.frame();
        const person = found.people.find((one) => one.id === number);
        const joints = person.smoothed.nite15;
        const [a, b, c] = ['r_hip', 'r_knee', 'r_foot'].map((name) => joints[name].xyz_m);
        const [u, v] = [a, c].map((end) => end.map((value, i) => value - b[i]));
        const dot = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        const [x, y, z] = joints.head.xyz_m;
        return {
          height: floor.offset_m - (x * floor.normal[0] + y * floor.normal[1] + z * floor.normal[2]),
          speed: Math.hypot(...person.velocity_m_s),
          knee: (Math.acos(dot / Math.hypot(...u) / Math.hypot(...v)) * 180) / Math.PI,
          score: 100 * person.score,
        };
      }, id);
      await page.locator('#curves select').nth(1).selectOption({ label: 'right knee' });
      const told = await page.locator('#curves figcaption').allInnerTexts();
      assert.equal(told[0], `Height of the head over the floor: ${expected.height.toFixed(2)} m`);
      assert.equal(told[1], `Speed: ${expected.speed.toFixed(2)} m/s`);
      assert.equal(told[2], `Angle of the right knee: ${expected.knee.toFixed(0)} °`);
      assert.ok(told[3].startsWith(`Confidence: person ${expected.score.toFixed(0)} %, joints, dashed `), told[3]);
      assert.ok(expected.height > 0.5 && expected.height < 2.2, `${expected.height} m`);
      await page.screenshot({ path: join(pictures, 'curves.png') });
      const [first, last] = await page.evaluate(() => window.vesalius.state().span_s);
      const box = await page.locator('#curves .u-over').first().boundingBox();
      await page.mouse.click(box.x + box.width / 4, box.y + box.height / 2);
      await until(page, (to) => Math.abs(window.vesalius.state().at_s - to) < 0.1, first + (last - first) / 4);
      // Whoever is not seen has a gap, and what was not looked at too.
      const gaps = await page.evaluate((number) => {
        const { history } = window.vesalius;
        const frame = window.vesalius.frame();
        const without = { ...frame, at_s: 1000, found: { ...frame.found, people: [] } };
        const hidden = { ...frame, at_s: 1001, found: { ...frame.found, people: frame.found.people.map((one) => ({ ...one, state: 'hidden' })) } };
        for (const one of [{ ...frame, at_s: 999 }, without, hidden, { ...frame, at_s: 1002 }, { ...frame, at_s: 1010 }]) history.add(one);
        return history.series(number, 999, 1010, [1]).values[0].slice(-6).map((value) => value !== null);
      }, id);
      assert.deepEqual(gaps, [true, false, false, true, false, true]);
      // Memory has an end.
      const most = await page.evaluate(() => {
        const frame = window.vesalius.frame();
        for (let i = 0; i < 120000; ++i) window.vesalius.history.add({ ...frame, at_s: 2000 + i, found: { ...frame.found, people: frame.found.people.slice(0, 1) } });
        return window.vesalius.history.size();
      });
      assert.ok(most > 100000 && most <= 108000, `${most} samples`);
    },
    [],
    {},
    null,
    clip(),
  );
});

test('saves people as files of other programs', async () => {
  const { folder, remove } = newFolder();
  await withPage(
    async (page, view) => {
      for (let i = 0; i < 8; ++i) await step(page);
      await step(page, -1);  // a time counts once
      const people = join(folder, 'people.jsonl');
      run('detect', clip(), '--track', '--frames', '9', '--json', people, '-q');  // as it is written, with its -0.0
      run('export', people, '-q', '--to', join(folder, 'expected.csv'));
      run('export', people, '-q', '--to', join(folder, 'expected.glb'));
      const ids = (await (await fetch(`${view.address}people.json`)).json()).people.filter(({ bodies }) => bodies > 0).map(({ id }) => id);
      for (const id of ids) run('export', people, '-q', '--to', join(folder, `expected-${id}.bvh`), '--person', String(id));
      await page.keyboard.press('p');
      await page.locator('#saving-note', { hasText: 'in 9 frames' }).waitFor();
      const saved = async (format, person, count) => {
        await page.selectOption('#saving-format', format);
        if (person !== null) await page.selectOption('#saving-person', person);
        const downloads = [];
        const take = (download) => downloads.push(download);
        page.on('download', take);
        await page.click('#saving-save');
        while (downloads.length < count) await page.waitForTimeout(30);
        page.off('download', take);
        return Object.fromEntries(await Promise.all(downloads.map(async (one) => [one.suggestedFilename(), readFileSync(await one.path())])));
      };
      const table = await saved('csv', null, 1);
      assert.equal(table['people.csv'].toString(), readFileSync(join(folder, 'expected.csv'), 'utf8'));
      assert.ok((await saved('glb', null, 1))['people.glb'].equals(readFileSync(join(folder, 'expected.glb'))));
      const all = await saved('bvh', '', ids.length);
      assert.deepEqual(Object.keys(all).sort(), ids.map((id) => `people-${id}.bvh`).sort());
      for (const id of ids) assert.ok(all[`people-${id}.bvh`].equals(readFileSync(join(folder, `expected-${id}.bvh`))));
      assert.deepEqual(Object.keys(await saved('bvh', String(ids[0]), 1)), [`people-${ids[0]}.bvh`]);
      await page.screenshot({ path: join(pictures, 'saving.png') });
      await page.keyboard.press('Escape');
      assert.ok(!(await page.locator('#saving').isVisible()));
    },
    [],
    {},
    null,
    clip(),
  );
  remove();
});

test('says so where there is nobody to save, or no body', async () => {
  await withPage(async (page, view) => {
    // The format is chosen before the program has answered.
    await page.route('**/people.json*', async (route) => {
      await until(page, () => document.getElementById('saving-format').value === 'glb');
      await route.continue();
    });
    await page.keyboard.press('p');
    await page.selectOption('#saving-format', 'glb');
    await page.locator('#saving-note', { hasText: 'Nobody has a fitted body yet' }).waitFor();
    assert.ok(await page.locator('#saving-save').isDisabled());
    assert.match((await request(view.port, '/people.glb')).text, /nobody has a fitted body/);
    await page.keyboard.press('Escape');
    assert.ok(await page.locator('#happened').isHidden());
  }, ['--no-track']);
  await withPage(
    async (page, view) => {
      await page.keyboard.press('p');
      await page.locator('#saving-note', { hasText: 'Nobody was found yet' }).waitFor();
      assert.ok(await page.locator('#saving-save').isDisabled());
      assert.equal((await request(view.port, '/people.csv')).status, 404);
      await page.keyboard.press('Escape');
      await page.click('#tab-curves');
      assert.match(await page.locator('#curves').innerText(), /Nobody was seen yet/);
    },
    ['--refine.min-score', '1'],
  );
});

test('draws bodies and skeletons of each kind', async () => {
  await withPage(
    async (page) => {
      for (let i = 0; i < 12; ++i) await step(page);
      const bodies = (await shown(page)).people.filter((person) => person.body).length;
      assert.ok(bodies > 0);
      const looks = new Set();
      for (const kind of ['bones', 'smoothed', 'joints', 'parts', 'none']) {
        assert.equal(await page.locator('#skeleton').inputValue(), kind);
        looks.add(`${await look(page, 'cloud')} ${await look(page, 'picture')}`);
        await page.locator('#picture').hover();
        await page.keyboard.press('j');
      }
      assert.equal(looks.size, 5, 'every one looks different');
      const without = await look(page, 'cloud');
      assert.equal((await page.evaluate(() => window.vesalius.counts())).flesh, 0);
      await page.keyboard.press('b');
      assert.ok(await page.isChecked('#show-bodies'));
      assert.notEqual(await look(page, 'cloud'), without);
      const { flesh } = await page.evaluate(() => window.vesalius.counts());
      assert.equal(flesh % bodies, 0);
      assert.ok(flesh / bodies > 19 * 100, `${flesh} triangles`);
      await page.screenshot({ path: join(pictures, 'bodies.png') });
      await page.locator('#list button').first().click();
      const choice = page.locator('#details select');
      assert.ok((await choice.innerText()).includes('nite15, smoothed'));
      await choice.selectOption('nite15, smoothed');
      assert.equal(await page.locator('#details tbody tr').count(), 15);
    },
    [],
    {},
    null,
    clip(),
  );
});

test('colours by picture, depth, people and parts', async () => {
  await withPage(async (page) => {
    const looks = new Map();
    for (const colouring of ['picture', 'depth', 'person', 'part']) {
      await page.selectOption('#colouring', colouring);
      for (const canvas of ['cloud', 'picture']) looks.set(`${canvas} ${colouring}`, await look(page, canvas));
      await page.screenshot({ path: join(pictures, `${colouring}.png`) });
    }
    await page.selectOption('#part-colours', 'body');
    looks.set('parts of the body model', await look(page, 'cloud'));
    await page.selectOption('#skeleton', 'none');
    looks.set('no skeletons', await look(page, 'cloud'));
    await page.check('#show-boxes');
    looks.set('boxes', await look(page, 'cloud'));
    await page.uncheck('#show-floor');
    looks.set('no floor', await look(page, 'cloud'));
    await page.click('#view-camera');
    looks.set('camera', await look(page, 'cloud'));
    await page.screenshot({ path: join(pictures, 'camera.png') });
    assert.equal(new Set(looks.values()).size, looks.size, 'every one looks different');
  });
});

test('plays, pauses, steps and seeks', async () => {
  const names = detected().map((line) => line.frame);
  await withPage(async (page) => {
    const reaches = (name) => until(page, (wanted) => window.vesalius.frame().found.frame === wanted, name);
    await page.click('#forward');
    await reaches(names[1]);
    await page.click('#back');
    await reaches(names[0]);
    await page.keyboard.press('End');
    await reaches(names.at(-1));
    await page.keyboard.press('Home');
    await reaches(names[0]);
    const [first, last] = await page.evaluate(() => window.vesalius.state().span_s);
    await page.evaluate((to) => {
      const seek = document.getElementById('seek');
      seek.value = to;
      seek.dispatchEvent(new Event('input'));
    }, String(first + (3 / (names.length - 1)) * (last - first)));
    await reaches(names[3]);
    await page.selectOption('#speed', '0.1');
    await until(page, () => window.vesalius.state().speed === 0.1);
    await page.focus('#seek');
    await page.keyboard.press(' ');
    await until(page, () => window.vesalius.state().playing);
    await until(page, (name) => window.vesalius.frame().found.frame !== name, names[3]);
    await page.click('#play');
    await until(page, () => !window.vesalius.state().playing);
  });
});

test('an option gives another result at once, and the file has it', async () => {
  await withPage(async (page, view) => {
    const before = (await shown(page)).people.length;
    assert.ok(before > 0);
    await page.click('#tab-options');
    await page.fill('#filter', 'min-score');
    const field = page.locator('[data-name="refine.min-score"] input');
    await field.fill('1');
    await field.press('Enter');
    await until(page, () => window.vesalius.frame().found.people.length === 0);
    const saved = page.waitForEvent('download');
    await page.click('#save-options');
    const file = await (await saved).path();
    assert.match(readFileSync(file, 'utf8'), /\nrefine\.min-score = 1\.0\n/);
    assert.match(run('detect', rooms, '--options', file), /: nobody/);
    await page.screenshot({ path: join(pictures, 'options.png') });
    await field.fill('-5');
    await field.press('Enter');
    assert.match((await request(view.port, '/options.toml')).text, /\nrefine\.min-score = 1\.0\n/, 'out of range');
    await page.click('#reset-options');
    await until(page, (count) => window.vesalius.frame().found.people.length === count, before);
  });
});

test('shows the stages', async () => {
  await withPage(async (page) => {
    await page.click('#tab-stages');
    await until(page, () => window.vesalius.frame().stages);
    assert.equal(await page.locator('#stages canvas').count(), 8);
    const looks = await page.evaluate(() =>
      [...document.querySelectorAll('#stages canvas')].map((canvas) => {
        const bytes = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
        return bytes.reduce((hash, byte) => (Math.imul(hash, 31) + byte) | 0, 7);
      }),
    );
    assert.equal(new Set(looks).size, 8, 'eight different pictures');
    await page.locator('#stages figure button').nth(3).click();
    await page.screenshot({ path: join(pictures, 'stages.png') });
  });
});

test('saves snapshots and recordings', async () => {
  const { folder, remove } = newFolder();
  await withPage(
    async (page) => {
      const downloads = [];
      page.on('download', (download) => downloads.push(download));
      await page.keyboard.press('s');
      while (downloads.length < 2) await page.waitForTimeout(50);
      const files = Object.fromEntries(
        await Promise.all(downloads.map(async (d) => [d.suggestedFilename().split('.').pop(), await d.path()])),
      );
      assert.deepEqual(readFileSync(files.png).subarray(1, 4).toString(), 'PNG');
      const { people } = JSON.parse(JSON.stringify(await shown(page))); // a page writes -0 as 0
      assert.deepEqual(JSON.parse(readFileSync(files.json, 'utf8')).people, people);
      await page.click('#record');
      await until(page, () => window.vesalius.state().recording);
      for (let i = 0; i < 3; ++i) {
        const { number } = await shown(page);
        await page.keyboard.press('ArrowRight');
        await until(page, (last) => window.vesalius.frame().number > last, number);
      }
      await until(page, () => window.vesalius.state().recorded === 3);
      await page.click('#record');
      await until(page, () => !window.vesalius.state().recording);
      const [file] = readdirSync(folder);
      const where = await page.locator('#saved', { hasText: 'recorded 3 frames' }).innerText();
      assert.ok(where.endsWith(join(folder, file)), where);
      const [, number, unit] = where.match(/, ([\d.]+) (kB|MB):/);
      const bytes = Number(number) * { kB: 1e3, MB: 1e6 }[unit];
      assert.ok(Math.abs(bytes / statSync(join(folder, file)).size - 1) < 0.01, where);
      assert.match(run('detect', join(folder, file)), /person|people/);
    },
    ['--folder', folder],
  );
  remove();
});

/** A folder with a clip, a recording that is none, and links that lead out. */
function sourcesToOpen() {
  const { folder, remove } = newFolder();
  mkdirSync(join(folder, 'below'));
  run('convert', clip(), join(folder, 'below/clip'), '--to', 'folder', '-q');
  writeFileSync(join(folder, 'bad.mcap'), 'nothing that was recorded');
  symlinkSync(rooms, join(folder, 'out'));
  return { folder, remove };
}

test('opens another source by keys, and goes on where one cannot be opened', async () => {
  const { folder, remove } = sourcesToOpen();
  await withPage(
    async (page, view) => {
      const before = (await shown(page)).people.map(({ id }) => id);
      assert.ok(before.length > 0);
      await page.keyboard.press('m');
      await until(page, () => window.vesalius.state().recording);
      await step(page);
      await until(page, () => window.vesalius.state().recorded === 1);
      const here = (await shown(page)).name;

      const buttons = page.locator('#choice-sources button');
      const entries = async () => (await buttons.allInnerTexts()).filter((text) => !text.startsWith('vesalius-'));
      await page.keyboard.press('o');
      await buttons.first().waitFor();
      assert.deepEqual(await entries(), ['bad.mcap recording, 25 bytes', 'below/ folder'], 'not the link that leads out');
      await page.locator('#choice-cameras li', { hasText: 'None' }).waitFor();
      await page.screenshot({ path: join(pictures, 'choice.png') });
      await page.keyboard.press('Enter');
      await page.locator('#notices', { hasText: 'bad.mcap: ' }).waitFor();
      assert.equal((await shown(page)).name, here);
      assert.equal(await page.evaluate(() => window.vesalius.state().recording !== ''), true, 'the recording goes on');

      for (const wish of ['/etc', '../', 'out', 'below/../../x']) {
        await page.evaluate((source) => window.vesalius.send({ do: 'open', source }), wish);
        await page.locator('#notices', { hasText: `${wish}: ` }).waitFor();
        assert.equal((await shown(page)).name, here);
      }

      await page.keyboard.press('o');
      await page.locator('#choice-sources button', { hasText: 'below/' }).focus();
      await page.keyboard.press('Enter');
      await page.locator('#choice-sources button', { hasText: 'clip' }).first().waitFor();
      assert.deepEqual(await entries(), ['↑ the folder above', 'clip frames', 'look inside']);
      await page.keyboard.press('Tab');
      await page.keyboard.press('Enter');
      await page.locator('#source', { hasText: join(folder, 'below/clip') }).waitFor();
      await until(page, (name) => window.vesalius.frame() && window.vesalius.frame().found.frame !== name, here);
      const { people } = await shown(page);
      assert.ok(people.length > 0 && people.every(({ id }) => id > Math.max(...before)), 'nobody has an id of before');
      const where = await page.locator('#saved', { hasText: 'recorded 1 frame,' }).innerText();
      assert.match(run('detect', where.slice(where.indexOf(folder))), /person|people/);
      await step(page);
      const other = await open(browser, view.address);
      await other.locator('#source', { hasText: 'below/clip' }).waitFor();
      await other.context().close();
    },
    ['--folder', folder],
    {},
    null,
    rooms,
  );
  remove();
});

test('shows names, axes and angles, of everybody or of one', async () => {
  await withPage(
    async (page) => {
      for (let i = 0; i < 12; ++i) await step(page);
      const texts = () => page.locator('.mark').allInnerTexts();
      const rods = async () => (await page.evaluate(() => window.vesalius.counts())).rods;
      const looks = new Set([`${await look(page, 'cloud')} ${await look(page, 'picture')}`]);
      assert.deepEqual(await texts(), []);
      const people = (await shown(page)).people.filter((person) => person.state !== 'lost');
      const without = await rods();
      await page.keyboard.press('x');
      const bodies = people.filter((person) => person.body).length;
      assert.equal(await rods(), without + 3 * 19 * bodies, 'three axes of each bone');
      looks.add(`${await look(page, 'cloud')} ${await look(page, 'picture')}`);
      await page.keyboard.press('x');
      await page.keyboard.press('n');
      const joints = people.flatMap((person) => Object.values(person.joints.nite15)).filter(({ xyz_m }) => xyz_m);
      assert.equal((await texts()).length, joints.length);
      assert.ok((await texts()).includes('left elbow'));
      looks.add(`${await look(page, 'picture')}`);
      await page.keyboard.press('n');
      await page.keyboard.press('a');
      looks.add(`${await look(page, 'picture')}`);
      assert.equal(looks.size, 4);
      const [person] = people;
      await page.locator('#list button').first().click();
      const { l_shoulder, l_elbow, l_hand } = person.joints.nite15;
      const limb = (to) => to.xyz_m.map((value, i) => value - l_elbow.xyz_m[i]);
      const [upper, fore] = [limb(l_shoulder), limb(l_hand)];
      const dot = upper.reduce((sum, value, i) => sum + value * fore[i], 0);
      const degrees = Math.round((180 / Math.PI) * Math.acos(dot / Math.hypot(...upper) / Math.hypot(...fore)));
      const told = await page.locator('.angles').innerText();
      assert.ok(new RegExp(`left elbow (≈ )?${degrees}°`).test(told), `${degrees}: ${told}`);
      assert.ok((await texts()).some((text) => text.endsWith(`${degrees}°`)));
      assert.ok((await texts()).length <= 8, 'those of the one who is chosen');
      await page.screenshot({ path: join(pictures, 'angles.png') });
    },
    [],
    {},
    null,
    clip(),
  );
});

test('says that it waits for the floor', async () => {
  await withPage(async (page) => {
    assert.equal(await page.evaluate(() => window.vesalius.frame().found.floor), null);
    assert.match(await page.locator('#list button').first().innerText(), /waiting for the floor/);
  });
});

test('measures between two points of the picture and of the view', async () => {
  await withPage(async (page) => {
    const { camera, depth } = await page.evaluate(() => {
      const { found, depth: all } = window.vesalius.frame();
      return { camera: found.camera, depth: Array.from(all) };
    });
    const area = await page.locator('#picture').boundingBox();
    const scale = Math.min(area.width / camera.width, area.height / camera.height);
    const pixels = [[0.3, 0.5], [0.7, 0.8]].map(([across, down]) => {
      const first = Math.round(down * camera.height) * camera.width + Math.round(across * camera.width);
      const around = [-1, 0, 1].flatMap((v) => [-1, 0, 1].map((u) => v * camera.width + u));
      const pixel = depth.findIndex((_, i) => i >= first && around.every((by) => depth[i + by] > 0));
      return [pixel % camera.width, Math.floor(pixel / camera.width)];
    });
    const pixelOf = ([x, y, z]) => [Math.round((x / z) * camera.fx + camera.cx), Math.round((y / z) * camera.fy + camera.cy)];
    const isReading = (place) => {
      const [u, v] = pixelOf(place);
      return Math.abs(depth[v * camera.width + u] / 1000 - place[2]) < 1e-6;
    };
    const click = ([u, v]) =>
      page.mouse.click(
        area.x + (area.width - scale * camera.width) / 2 + (u + 0.5) * scale,
        area.y + (area.height - scale * camera.height) / 2 + (v + 0.5) * scale,
      );
    await click(pixels[0]);
    assert.equal(await page.evaluate(() => window.vesalius.measured().length), 0, 'not while nobody measures');
    await page.keyboard.press('d');
    for (const pixel of pixels) await click(pixel);
    const measured = await page.evaluate(() => window.vesalius.measured());
    for (const [i, place] of measured.entries()) {
      const off = pixelOf(place).map((at, axis) => Math.abs(at - pixels[i][axis]));
      assert.ok(Math.max(...off) <= 1 && isReading(place), `${place} at ${pixelOf(place)}, clicked at ${pixels[i]}`);
    }
    const told = await page.locator('#measured').innerText();
    const by = measured[1].map((value, i) => value - measured[0][i]);
    const signed = (metres) => `${metres < 0 ? '−' : '+'}${Math.abs(metres).toFixed(3)}`;
    const expected = `${Math.hypot(...by).toFixed(3)} m: across ${signed(by[0])}, up ${signed(-by[1])}, depth ${signed(by[2])} m`;
    assert.ok(told.startsWith(expected), `${told}, expected ${expected}`);
    await page.screenshot({ path: join(pictures, 'measured.png') });
    await page.keyboard.press('Escape');
    assert.equal(await page.evaluate(() => window.vesalius.measured().length), 0);

    // The camera's view shows a pixel where the picture has it: in the middle the one that is on its axis.
    await page.keyboard.press('v');
    await page.focus('#cloud');
    await page.keyboard.press('Enter');
    const [middle] = await page.evaluate(() => window.vesalius.measured());
    assert.ok(Math.hypot(middle[0] / middle[2], middle[1] / middle[2]) < 0.03, `${middle}`);
    assert.ok(isReading(middle), 'a reading of the camera');
    await page.focus('#picture');
    for (const key of ['ArrowRight', 'ArrowDown', 'Enter']) await page.keyboard.press(key);
    assert.match(await page.locator('#measured').innerText(), /^\d\.\d{3} m: /);
    assert.match(await page.locator('#readout').innerText(), /^\(\d+, \d+\)/);
    await page.keyboard.press('Escape');
    await page.keyboard.press('Escape');
    assert.equal(await page.getAttribute('#measure', 'aria-pressed'), 'false');
    assert.equal(await page.locator('#measured').innerText(), '');
  });
});

test('fills the screen', async () => {
  await withPage(async (page) => {
    const size = () => page.locator('#view').boundingBox();
    const before = await size();
    await page.keyboard.press('f');
    await until(page, () => document.fullscreenElement !== null);
    assert.ok(!(await page.locator('#side').isVisible()));
    const large = await size();
    assert.ok(large.width > before.width && large.height > before.height);
    assert.ok(await page.locator('#play').isVisible());
    await page.click('#full-screen');
    await until(page, () => document.fullscreenElement === null);
    assert.ok(await page.locator('#side').isVisible());
    assert.deepEqual(await size(), before);
  });
});

test('the options that people turn come first', async () => {
  await withPage(async (page) => {
    await page.click('#tab-options');
    const titles = await page.locator('#options-first label > span, #options-first strong').allInnerTexts();
    assert.deepEqual(titles, ['Threshold', 'Following', 'Smoothing', 'Speed', 'Model']);
    const codes = await page.locator('#options-first code').allInnerTexts();
    assert.deepEqual(codes, ['refine.min-score', 'track.hidden', 'track.smooth-cutoff', 'grid.step']);
    assert.equal(await page.locator('#options-first output').innerText(), 'default.model');
    assert.ok(await page.locator('#options-first + details').isVisible(), 'all others below');
    assert.equal(await page.locator('#option-list > details[open]').count(), 0);
    await page.locator('#options-first input').nth(3).fill('4');
    await page.keyboard.press('Enter');
    await until(page, () => document.querySelector('[data-name="grid.step"]').classList.contains('changed'));
  });
});

test('has no fault that axe finds', async () => {
  const axe = readFileSync(join(root, 'web/node_modules/axe-core/axe.min.js'), 'utf8');
  const audit = async (page, what) => {
    await page.evaluate(axe);
    const { violations, passes } = await page.evaluate(() => window.axe.run(document));
    const found = violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target.join(' ')).join(', ')}`);
    assert.deepEqual(found, [], what);
    assert.ok(passes.length > 10, 'it looked');
  };
  const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
  for (const [colorScheme, screen] of [['light', {}], ['dark', {}], ['light', phone]]) {
    await withPage(
      async (page) => {
        for (let i = 0; i < 6; ++i) await step(page);
        for (const key of ['n', 'a', 'd']) await page.keyboard.press(key);
        await audit(page, `${colorScheme}, people`);
        await page.locator('#list button').first().click();
        await audit(page, `${colorScheme}, one person`);
        for (const tab of ['stages', 'options']) {
          await page.click(`#tab-${tab}`);
          if (tab === 'stages') await until(page, () => window.vesalius.frame().stages);
          await audit(page, `${colorScheme}, ${tab}`);
        }
        await page.keyboard.press('o');
        await page.locator('#choice-sources li').first().waitFor();
        await audit(page, `${colorScheme}, sources`);
        await page.keyboard.press('Escape');
        await page.keyboard.press('?');
        await audit(page, `${colorScheme}, keys`);
        await page.keyboard.press('Escape');
        await page.keyboard.press('f');
        await audit(page, `${colorScheme}, full screen`);
      },
      [],
      { colorScheme, ...screen },
      null,
      clip(),
    );
  }
});

test('pages do not take the stages from each other', async () => {
  await withPage(async (page, view) => {
    await page.click('#tab-stages');
    await until(page, () => window.vesalius.frame().stages);
    const other = await open(browser, view.address);
    await until(other, () => window.vesalius?.frame());
    await other.click('#tab-options');
    await other.click('#tab-people');
    const { number } = await shown(page);
    await other.keyboard.press('Home');
    await page.focus('#play');
    await page.keyboard.press('ArrowRight');
    await until(page, (last) => window.vesalius.frame().number > last && window.vesalius.frame().stages, number);
    await until(other, () => window.vesalius.frame().stages === undefined);
    await other.context().close();
  });
});

test('survives a restarted program', async () => {
  const first = await View.start(rooms, '--paused', '--port', '0');
  const page = await open(browser, first.address);
  await until(page, () => window.vesalius?.frame());
  await page.keyboard.press('ArrowRight');
  await until(page, () => window.vesalius.frame().number > 1);
  assert.equal(await first.stop(), 0);
  await page.locator('#status', { hasText: 'does not answer' }).waitFor();
  const second = await View.start(rooms, '--paused', '--port', String(first.port));
  await until(page, () => !document.body.classList.contains('away') && window.vesalius.frame()?.number === 1);
  await page.context().close();
  assert.equal(await second.stop(), 0);
});

test('works with the keyboard alone', async () => {
  await withPage(async (page) => {
    const visited = new Set();
    for (let i = 0; i < 40; ++i) {
      await page.keyboard.press('Tab');
      visited.add(await page.evaluate(() => document.activeElement?.id || document.activeElement?.textContent));
    }
    for (const id of ['record', 'save-people', 'snapshot', 'theme', 'cloud', 'colouring', 'show-boxes', 'tab-people', 'play', 'speed', 'loop-from']) {
      assert.ok(visited.has(id), `${id} is reached by tab`);
    }
    await page.focus('#cloud');
    const before = await look(page, 'cloud');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('+');
    await page.keyboard.press('Shift+ArrowUp');
    assert.notEqual(await look(page, 'cloud'), before, 'the view turned');
    await page.locator('#list button').first().focus();
    await page.keyboard.press('Enter');
    assert.ok(await page.locator('#details table').isVisible());
    assert.equal(await page.locator('#details tbody tr').count(), 25);
    await page.screenshot({ path: join(pictures, 'details.png') });
    await page.selectOption('#details select', { index: 1 });
    assert.ok((await page.locator('#details tbody tr').count()) > 10, 'joints of a set');
    await page.focus('#tab-people');
    await page.keyboard.press('ArrowRight');
    assert.ok(await page.locator('#curves').isVisible());
    await page.keyboard.press('ArrowRight');
    assert.ok(await page.locator('#stages').isVisible());
    await page.focus('#show-floor');
    await page.keyboard.press(String((await shown(page)).people[0].id));
    assert.ok(!(await page.locator('#details').isVisible()), 'chosen once more, no longer');
    await page.keyboard.press('?');
    assert.ok(await page.locator('#help').isVisible());
    await page.keyboard.press('Escape');
    assert.ok(!(await page.locator('#help').isVisible()));
  });
});

test('fits a phone, light and dark', async () => {
  for (const colorScheme of ['light', 'dark']) {
    await withPage(
      async (page) => {
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.ok(wide <= 390, `${wide} pixels wide`);
        const top = async (id) => (await page.locator(`#${id}`).boundingBox()).y;
        assert.ok((await top('flat')) < 10 && (await top('flat')) < (await top('space')), 'the picture comes first');
        assert.ok(await page.locator('#play').isVisible());
        assert.ok((await top('play')) < 844, 'the controls are in reach');
        await page.screenshot({ path: join(pictures, `phone-${colorScheme}.png`), fullPage: true });
      },
      [],
      { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme },
    );
  }
});

test('shows the flat picture where there is no WebGL 2', async () => {
  const old = await launch(NO_3D);
  await withPage(
    async (page) => {
      assert.match(await page.locator('#no-cloud').innerText(), /no WebGL 2/);
      assert.equal(await page.locator('#list > li').count(), (await shown(page)).people.length);
      await page.keyboard.press('ArrowRight');
      await until(page, () => window.vesalius.frame().number > 1);
      await page.screenshot({ path: join(pictures, 'flat.png') });
    },
    [],
    {},
    old,
  );
  await old.close();
});

test('refuses foreign hosts, pages and tokens', async () => {
  const renamed = await launch(['--host-resolver-rules=MAP evil.example 127.0.0.1']);
  const view = await View.start(rooms, '--paused', '--port', '0');
  // A page whose name was made to mean this machine.
  const page = await (await renamed.newContext()).newPage();
  const response = await page.goto(`http://evil.example:${view.port}/`);
  assert.equal(response.status(), 403);
  assert.match(await page.locator('body').innerText(), /not called evil\.example/);
  // A page of another server.
  const foreign = http.createServer((_, answer) => answer.end('<!doctype html><title>foreign</title>'));
  await new Promise((resolve) => foreign.listen(0, '127.0.0.1', resolve));
  await page.goto(`http://127.0.0.1:${foreign.address().port}/`);
  const outcome = await page.evaluate(async (port) => {
    const socket = new WebSocket(`ws://127.0.0.1:${port}/stream`);
    const stream = await new Promise((resolve) => {
      socket.onopen = () => resolve('open');
      socket.onerror = () => resolve('refused');
    });
    const read = await fetch(`http://127.0.0.1:${port}/options.toml`).then(() => 'read', () => 'refused');
    return { stream, read };
  }, view.port);
  assert.deepEqual(outcome, { stream: 'refused', read: 'refused' });
  foreign.close();
  await renamed.close();
  assert.equal(await view.stop(), 0);

  const shared = await View.start(rooms, '--paused', '--port', '0', '--host', '0.0.0.0');
  const token = new URL(shared.address).searchParams.get('token');
  assert.match(token, /^[0-9a-f]{32}$/);
  assert.equal((await request(shared.port, '/')).status, 403);
  assert.equal((await request(shared.port, `/?token=${token.replace(/./, 'g')}`)).status, 403);
  assert.equal((await request(shared.port, '/stream', { Connection: 'Upgrade', Upgrade: 'websocket' })).status, 403);
  const allowed = await open(browser, `http://127.0.0.1:${shared.port}/?token=${token}`);
  await until(allowed, () => window.vesalius?.frame());
  await allowed.keyboard.press('p');
  await allowed.locator('#saving-note', { hasText: /person|people in/ }).waitFor();
  assert.equal((await request(shared.port, '/people.csv')).status, 403);
  const link = await allowed.locator('#save-options').getAttribute('href');
  assert.equal((await request(shared.port, `/${link}`)).status, 200);
  await allowed.context().close();
  assert.equal(await shared.stop(), 0);
});

test('says in a line why it cannot start', async () => {
  const view = await View.start(rooms, '--paused', '--port', '0');
  const refusal = (...words) => View.start(...words).then(() => 'started', (error) => error.message);
  assert.match(await refusal(rooms, '--port', String(view.port)), /^vesalius: 127\.0\.0\.1:\d+: another program has this port.*\n$/);
  assert.match(await refusal(rooms, '--port', '0', '--host', '192.0.2.1'), /^vesalius: 192\.0\.2\.1:0: .*\n$/);
  assert.match(await refusal(rooms, '--port', '0', '--folder', '/no/such'), /^vesalius: \/no\/such: no such folder.*\n$/);
  assert.match(await refusal('/no/such'), /^vesalius: \/no\/such: .*\n$/);
  assert.equal(await view.stop(), 0);
});
