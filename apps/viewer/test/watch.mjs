// A bake that is watched while it runs.
//   node test/watch.mjs --parbake COMMAND --high HIGH --low LOW [--out FOLDER]
// Fails on: a message in the console, a request to anywhere else, a page that shows nothing before the bake has ended,
// coordinates that do not move, a page that is of no use once the command has ended, a failure that is not told, a finding
// of axe-core that is serious.
import { spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { barriers, findBrowser, launch, watchedPage } from './browser.mjs';

const { values } = parseArgs({ options: {
  parbake: { type: 'string' }, high: { type: 'string' }, low: { type: 'string' }, out: { type: 'string' },
} });
if (!values.parbake || !values.high || !values.low) {
  console.error('usage: watch.mjs --parbake COMMAND --high HIGH --low LOW [--out FOLDER]');
  process.exit(2);
}
if (!findBrowser()) {
  console.log('skipped: no Chromium (apt-get install chromium, or set CHROMIUM)');
  process.exit(0);
}
const out = values.out ?? fs.mkdtempSync(path.join(os.tmpdir(), 'parbake-watch-'));
fs.mkdirSync(out, { recursive: true });
let failures = 0;
const verify = (isTrue, what) => {
  if (isTrue) return;
  failures++;
  console.error(`FAILED: ${what}`);
};
const sleep = (milliseconds) => new Promise((wait) => setTimeout(wait, milliseconds));

/** Starts a bake; gives the page's address, and a promise of how it ends: `{ code, said }`. */
function bake(more) {
  return new Promise((resolve, reject) => {
    const child = spawn(values.parbake, ['bake', values.high, ...more, '--watch', '--no-open'], { stdio: ['ignore', 'ignore', 'pipe'] });
    let said = '', isOver = false;
    const end = new Promise((over) => child.on('exit', (code) => { isOver = true; over({ code, said }); }));
    child.stderr.on('data', (data) => {
      said += data;
      const url = / at (http:\S+)/.exec(said)?.[1];
      if (url) resolve({ url, end, isOver: () => isOver });
    });
    child.on('error', reject);
    end.then(() => reject(new Error(`no page: ${said}`)));
  });
}

const text = (page, id) => page.$eval(`#${id}`, (e) => e.textContent);
/** The model's texture coordinates, as a number that changes with them. */
const layout = (page) => page.evaluate(() => {
  let sum = 0;
  window.parbake.stage.levels.models[0].root.traverse((object) => {
    const uv = object.geometry?.attributes.uv;
    if (uv) for (let i = 0; i < uv.count; i++) sum += uv.getX(i) * (i + 1) + uv.getY(i) * (i + 7);
  });
  return sum;
});
const canvas = async (page) => createHash('sha1').update(await page.evaluate(() => window.parbake.snapshot())).digest('hex');

async function accessible(page, what) {
  const found = await barriers(page);
  verify(found.length === 0, `${what}: ${found.join('; ')}`);
}

async function session(what, options, steps) {
  const began = performance.now(), { page, errors, outside } = await watchedPage(browser, options);
  try {
    await steps(page);
  } catch (error) {
    verify(false, `${what}: ${error.stack}`);
  }
  verify(errors.length === 0, `${what}: console: ${errors.join(' | ')}`);
  verify(outside.length === 0, `${what}: asked for ${outside.join(' ')}`);
  await page.close();
  console.log(`${what}: ${((performance.now() - began) / 1000).toFixed(1)} s`);
}

const browser = await launch();
await session('watched', { width: 800, height: 560 }, async (page) => {
  const file = path.join(out, 'watched.glb');
  const { url, end, isOver } = await bake([values.low, '-o', file, '--parallax', 'tangent', '--texture-size', '128', '--preset', 'fast', '--views', '200']);
  const stages = new Set(), layouts = new Set();
  let snapshots = 0, isShown = false;
  page.on('response', (response) => { if (response.url().endsWith('/run/snapshot') && response.ok()) snapshots++; });
  await page.goto(url);
  while (!isOver()) {
    isShown ||= await page.evaluate(() => Boolean(window.parbake));
    if (isShown && !layouts.size) {
      await page.screenshot({ path: path.join(out, 'running.png') });
      await accessible(page, 'running');
      await page.keyboard.press('6');
    }
    if (isShown) layouts.add(await layout(page));
    stages.add(await text(page, 'run-stage'));
    await Promise.race([end, sleep(1500)]);
  }
  const { code, said } = await end;
  verify(code === 0, `the bake ended with ${code}: ${said}`);
  verify(layouts.size > 1, 'texture coordinates were seen to move');
  verify(snapshots > 1, `${snapshots} snapshots`);
  verify([...stages].some((stage) => /vertices/.test(stage)) && stages.size > 3, `stages: ${[...stages].join(', ')}`);
  // The command is gone; the page is a viewer of what was written.
  await page.waitForFunction(() => /^Finished in /.test(document.getElementById('run-stage').textContent));
  await page.keyboard.press('3');
  await page.evaluate(() => window.parbake.settled());
  verify(/^\d+\.\d\d dB$/.test(await text(page, 'psnr')), 'PSNR of the finished model is told');
  const size = await page.$$eval('#figures tbody tr', (rows) => rows.find((row) => row.cells[0].textContent === 'File').cells[1].textContent);
  verify(/ [kM]B$/.test(size), `bytes of the file: ${size}`);
  verify(await page.$eval('#parallax-switch', (e) => !e.hidden), 'its maps can be switched');
  const before = await canvas(page);
  await page.keyboard.press('d');
  verify((await canvas(page)) !== before, 'without its maps it looks different');
  await accessible(page, 'finished');
  await page.screenshot({ path: path.join(out, 'finished.png') });
});

await session('failed', { width: 800, height: 560, scheme: 'dark' }, async (page) => {
  const flat = path.join(out, 'flat.obj');
  fs.writeFileSync(flat, 'v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n');
  const { url, end } = await bake([flat, '-o', path.join(out, 'never.glb')]);
  await page.goto(url);
  await page.waitForFunction(() => !document.getElementById('failure').hidden || !document.getElementById('banner').hidden);
  const told = (await text(page, 'failure-text')) || (await text(page, 'banner-text'));
  const { code, said } = await end;
  verify(code !== 0 && told.length > 20 && said.includes(told), `the page tells why: ${JSON.stringify(told)}; the command: ${said}`);
  await accessible(page, 'failed');
  await page.screenshot({ path: path.join(out, 'failed.png') });
});
await browser.close();
console.log(failures ? `${failures} failures` : `all passed; pictures are in ${out}`);
process.exit(failures ? 1 : 0);
