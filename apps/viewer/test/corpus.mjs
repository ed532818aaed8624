// Broken and hostile files: each must leave a picture or a message within `--limit` seconds, and a page that still
// answers.
//   node test/corpus.mjs --parbake COMMAND [--every N] [--limit SECONDS] FOLDER
import fs from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { findBrowser, launch, settled, view, watchedPage } from './browser.mjs';

const { values, positionals: [folder] } = parseArgs({ allowPositionals: true, options: {
  parbake: { type: 'string' }, every: { type: 'string', default: '1' }, limit: { type: 'string', default: '8' },
} });
if (!findBrowser()) {
  console.log('skipped: no Chromium (apt-get install chromium, or set CHROMIUM)');
  process.exit(0);
}
const files = fs.readdirSync(folder, { recursive: true }).map((name) => path.join(folder, String(name)))
  .filter((file) => /\.(glb|gltf|obj)$/i.test(file)).sort().filter((_, index) => index % Number(values.every) === 0);
const browser = await launch();
const told = { shown: 0, refused: 0 };
let failures = 0, slowest = [0, ''];
for (const file of files) {
  const { url, stop, began } = await view(values.parbake, [file], ['--confine']);
  const { page, outside } = await watchedPage(browser, { width: 480, height: 320 });
  try {
    await page.goto(url);
    const state = await settled(page, 1000 * Number(values.limit));
    told[state]++;
    if (state === 'refused') {
      const text = await page.$eval('#failure-text', (e) => e.textContent);
      if (text.length < 20) throw new Error(`no more than ${JSON.stringify(text)}`);
    }
    if (outside.length) throw new Error(`asked for ${outside.join(' ')}`);
    const seconds = (performance.now() - began) / 1000;
    if (seconds > slowest[0]) slowest = [seconds, file];
  } catch (error) {
    failures++;
    console.error(`FAILED: ${file}: ${error.message}`);
  }
  await page.close();
  await stop();
}
await browser.close();
console.log(`${files.length} files: ${told.shown} shown, ${told.refused} refused with a message, ${failures} failed; slowest ${slowest[0].toFixed(1)} s (${slowest[1]})`);
process.exit(failures ? 1 : 0);
