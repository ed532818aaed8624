// The view in a report: node test/report.mjs REPORT.html [--out FOLDER]
// Fails on: a model that does not come, a message in the console, a request to anywhere, a control that changes nothing (in light colours and on a phone), a
// key or a drag that does not turn the model, more than 3 MB of page besides pictures and textures.
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { findBrowser, launch, watchedPage } from './browser.mjs';

const { values, positionals: [report] } = parseArgs({ allowPositionals: true, options: { out: { type: 'string' } } });
if (!findBrowser()) {
  console.log('skipped: no Chromium (apt-get install chromium, or set CHROMIUM)');
  process.exit(0);
}
const out = values.out ?? fs.mkdtempSync(path.join(os.tmpdir(), 'parbake-report-'));
fs.mkdirSync(out, { recursive: true });
let failures = 0;
const verify = (isTrue, what) => {
  if (isTrue) return;
  failures++;
  console.error(`FAILED: ${what}`);
};

const text = fs.readFileSync(report, 'utf8');
const bare = text.replace(/data:image\/[a-z]+;base64,[A-Za-z0-9+/=]+/g, '').replace(/id="view-model">[^<]*</, '><');
verify(bare.length < 3e6, `the page has ${bare.length} bytes besides pictures and the model`);

const browser = await launch();
for (const [name, options] of Object.entries({ desktop: { scheme: 'light' }, dark: { scheme: 'dark' }, phone: { width: 390, height: 800, isPhone: true } })) {
  const { page, errors, outside } = await watchedPage(browser, { width: 1200, height: 800, ...options });
  await page.goto(`file://${path.resolve(report)}`);
  await page.$eval('#view-canvas', (canvas) => canvas.scrollIntoView({ block: 'center' }));
  await page.waitForFunction(() => document.getElementById('view-canvas').dataset.shown || document.getElementById('view-told').textContent, { timeout: 60_000 });
  const told = await page.$eval('#view-told', (element) => element.textContent);
  verify(told === '', `${name}: ${told}`);
  const canvas = await page.$('#view-canvas');
  const shot = async (what) => {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    return Buffer.from(await canvas.screenshot({ path: path.join(out, `${name}_${what}.png`) }));
  };
  let before = await shot('first');
  const changes = async (what, action) => {
    await action();
    const after = await shot(what);
    verify(!after.equals(before), `${name}: ${what} changes nothing`);
    before = after;
  };
  // The colour scheme does not change what controls do.
  if (options.scheme !== 'dark') {
    await changes('wireframe', () => page.click('#view-wireframe'));
    if (await page.$eval('#view-parallax', (input) => !input.closest('label').hidden)) await changes('plain', () => page.click('#view-parallax'));
    await changes('keys', async () => {
      await page.focus('#view-canvas');
      await page.keyboard.press('ArrowRight');
      await page.keyboard.press('+');
    });
    await changes('whole', () => page.click('#view-whole'));
    if (!options.isPhone) await changes('drag', async () => {
      const { x, y, width, height } = await canvas.boundingBox();
      await page.mouse.move(x + width / 2, y + height / 2);
      await page.mouse.down();
      await page.mouse.move(x + width / 2 + 60, y + height / 2, { steps: 3 });
      await page.mouse.up();
    });
  }
  const isWide = await page.evaluate(() => document.documentElement.scrollWidth > window.innerWidth);
  verify(!isWide, `${name}: the page is wider than the screen`);
  const files = outside.filter((url) => !url.startsWith('file:'));
  verify(errors.length === 0 && files.length === 0, `${name}: ${errors.join(' | ')} ${files.join(' ')}`);
  await page.close();
}
await browser.close();
if (failures) {
  console.error(`${failures} failures`);
  process.exit(1);
}
console.log(`the report: ${(bare.length / 1e6).toFixed(2)} MB besides pictures and the model; all passed; pictures are in ${out}`);
