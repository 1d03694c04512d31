// Makes a picture of the viewer's page, of which docs/images/view.webp is packed (docs/view.md):
//   node web/tests/picture.mjs FILE.png SOURCE FRAMES
// It goes FRAMES frames on before, so that there are trails.
import { View, launch, open, shown, until } from './program.mjs';

const [file, source, frames] = process.argv.slice(2);
const view = await View.start(source, '--paused', '--port', '0');
const browser = await launch();
const page = await open(browser, view.address, { viewport: { width: 1280, height: 800 } });
await until(page, () => window.vesalius?.frame());
for (let i = 0; i < Number(frames); ++i) {
  const { number } = await shown(page);
  await page.keyboard.press('ArrowRight');
  await until(page, (last) => window.vesalius.frame().number > last, number);
}
await page.screenshot({ path: file });
await browser.close();
await view.stop();
