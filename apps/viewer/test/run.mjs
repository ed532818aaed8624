// The page in a real browser, as people use it.
//   node test/run.mjs --parbake COMMAND --high HIGH --low LOW [--levels A,B] [--out FOLDER]
// Loads models with and without a second one, goes through everything by mouse and keyboard, and fails on: a message
// in the console, a request to anywhere else, a picture that does not change when it should, a finding of axe-core that
// is serious, a broken file without a message. Pictures of all of it are left in FOLDER.
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { createHash } from 'node:crypto';
import { parseArgs } from 'node:util';
import { barriers, drawn, findBrowser, launch, settled, view, watchedPage } from './browser.mjs';

const { values } = parseArgs({ options: {
  parbake: { type: 'string' }, high: { type: 'string' }, low: { type: 'string' }, out: { type: 'string' },
} });
if (!values.parbake || !values.high || !values.low) {
  console.error('usage: run.mjs --parbake COMMAND --high HIGH --low LOW [--out FOLDER]');
  process.exit(2);
}
if (!findBrowser()) {
  console.log('skipped: no Chromium (apt-get install chromium, or set CHROMIUM)');
  process.exit(0);
}
const out = values.out ?? fs.mkdtempSync(path.join(os.tmpdir(), 'parbake-view-'));
fs.mkdirSync(out, { recursive: true });

let failures = 0;
const verify = (isTrue, what) => {
  if (!isTrue) {
    failures++;
    console.error(`FAILED: ${what}`);
  }
};
const browser = await launch();
const shot = (page, name) => page.screenshot({ path: path.join(out, `${name}.png`) });
/** What the canvas shows, as a number that changes with it; with a name it is left as a file, too. */
const picture = async (page, name) => {
  await drawn(page);
  const snapshot = await page.evaluate(() => window.parbake.snapshot());
  if (name) fs.writeFileSync(path.join(out, `${name}.png`), Buffer.from(snapshot.split(',')[1], 'base64'));
  return createHash('sha1').update(snapshot).digest('hex');
};

async function accessible(page, what) {
  const found = await barriers(page);
  verify(found.length === 0, `${what}: ${found.join('; ')}`);
}

/** Opens a session, runs `steps`, and wants a quiet console and no request elsewhere. */
async function session(what, models, more, options, steps) {
  const began = performance.now();
  const { url, stop } = await view(values.parbake, models, more);
  const { page, errors, outside } = await watchedPage(browser, options);
  try {
    await page.goto(url);
    const state = await settled(page);
    const first = performance.now() - began;
    if (state === 'shown') await drawn(page);
    await steps(page, { state, first });
  } catch (error) {
    verify(false, `${what}: ${error.stack}`);
  }
  verify(errors.length === 0, `${what}: console: ${errors.join(' | ')}`);
  verify(outside.length === 0, `${what}: asked for ${outside.join(' ')}`);
  await page.close();
  await stop();
  console.log(`${what}: ${((performance.now() - began) / 1000).toFixed(1)} s`);
}

// Small and coarse, since every picture is drawn by the processor.
const SMALL = { width: 800, height: 480, sharpness: 0.5 };
const choose = (page, name, value) => page.click(`input[name="${name}"][value="${value}"]`);

await session('compared', [values.low], ['--compare', values.high], SMALL, async (page) => {
  verify(/^\d+\.\d\d dB$/.test(await page.$eval('#psnr', (e) => e.textContent)), 'PSNR of the view is told');
  const rows = await page.$$eval('#figures tbody tr', (all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  verify(rows.length >= 8 && rows.every((row) => row.length >= 2 && row[1] !== ''), `figures: ${JSON.stringify(rows)}`);
  await shot(page, 'split');
  await accessible(page, 'light');

  const seen = new Map();
  const differs = async (what) => {
    const now = await picture(page, what.replace(/\W+/g, '_'));
    verify(!seen.has(now), `${what} shows the same as ${seen.get(now)}`);
    seen.set(now, what);
  };
  await differs('split view');
  for (const mode of ['model', 'high', 'side', 'difference', 'uv']) {
    await choose(page, 'mode', mode);
    await differs(`mode ${mode}`);
  }
  verify(await page.$eval('#reading', (e) => e.hidden), 'no PSNR over the UV layout');
  const textures = await page.$$eval('#texture option', (all) => all.map((o) => o.value));
  await page.select('#texture', textures.at(-1));
  await differs('last texture');
  await choose(page, 'mode', 'model');
  for (const channel of ['base', 'normal', 'checker', 'opacity']) {
    await choose(page, 'channel', channel);
    await differs(`channel ${channel}`);
  }
  // Many models have nothing in these: they only must not fail.
  for (const channel of ['roughness', 'metallic', 'occlusion', 'emission']) {
    await choose(page, 'channel', channel);
    await picture(page, `channel_${channel}`);
  }
  await choose(page, 'channel', 'lit');
  for (const light of ['room', 'sky', 'sun', 'headlight']) {
    await page.select('#light', light);
    await differs(`light ${light}`);
  }
  await page.select('#light', 'room');
  for (const [key, value] of [['tone', 'neutral'], ['tone', 'aces'], ['background', 'black'], ['background', 'white']]) {
    await page.select(`#${key}`, value);
    await differs(`${key} ${value}`);
  }
  await page.click('#wireframe');
  await differs('wireframe');
  await page.click('#wireframe');

  // All of this by keyboard.
  await page.focus('#canvas');
  for (const key of ['ArrowLeft', 'ArrowUp', '+', '-', 'f']) await page.keyboard.press(key);
  await differs('turned by keys');
  await page.keyboard.press('3');
  verify(await page.$eval('input[value="split"]', (e) => e.checked), '3 is the split view');
  await page.focus('#splitter');
  for (let i = 0; i < 5; i++) await page.keyboard.press('ArrowLeft');
  verify((await page.$eval('#splitter', (e) => e.getAttribute('aria-valuenow'))) === '40', 'the border moves by keys');
  await page.focus('#canvas');
  for (const key of ['c', 'l', 'w', 'r']) await page.keyboard.press(key);
  await new Promise((wait) => setTimeout(wait, 700));
  await page.keyboard.press('r');
  await differs('turned by the turntable');
  const reached = new Set();
  await page.focus('#theme');
  for (let i = 0; i < 40; i++) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.name));
  }
  for (const id of ['help-open', 'panel-toggle', 'canvas', 'splitter', 'channel', 'wireframe', 'light', 'turn', 'exposure', 'tone', 'background', 'size', 'fit', 'turntable'])
    verify(reached.has(id), `Tab reaches ${id}: ${[...reached].join(' ')}`);
  await page.focus('#canvas');
  await page.keyboard.press('?');
  verify(await page.$eval('#help', (e) => e.open), '? opens the help');
  await accessible(page, 'help');
  await shot(page, 'help');
  await page.keyboard.press('Escape');
  await page.keyboard.press('t');
  verify((await page.evaluate(() => document.documentElement.dataset.theme)) === 'dark', 'T is dark');
  await drawn(page);
  await shot(page, 'dark');
  await accessible(page, 'dark');
  await page.mouse.move(200, 200);
  await page.mouse.down();
  await page.mouse.move(260, 220, { steps: 4 });
  await page.mouse.up();
  await page.mouse.wheel({ deltaY: -200 });
  await differs('turned by mouse');
});

await session('by itself, dark', [values.high], [], { scheme: 'dark' }, async (page, { first }) => {
  const size = fs.statSync(values.high).size / 1e6;
  console.log(`first picture of ${size.toFixed(1)} MB: ${(first / 1000).toFixed(2)} s from the command`);
  verify(await page.$eval('#modes', (e) => e.querySelectorAll('input').length === 2), 'no modes that need two models');
  await accessible(page, 'by itself');
  await shot(page, 'single_dark');
});

await session('levels', [values.high, values.low], [], SMALL, async (page) => {
  const label = () => page.$eval('#label-first', (e) => e.textContent);
  verify(/level 0/.test(await label()), 'large models show the finest level');
  await page.$eval('#size', (e) => { e.value = 60; e.dispatchEvent(new Event('input')); });
  await drawn(page);
  verify(/level 1/.test(await label()), `small ones a coarser one: ${await label()}`);
  const pixels = Number((await page.$eval('#size-value', (e) => e.textContent)).replace(/\D/g, ''));
  verify(pixels > 10 && pixels < 40, `size on the screen: ${pixels}`);
  verify(await page.$eval('#loupe', (e) => !e.hidden), 'what is small is enlarged');
  await choose(page, 'level', '0');
  await drawn(page);
  verify(/level 0/.test(await label()), 'a chosen level stays');
  await shot(page, 'levels');
});

await session('phone', [values.low], ['--compare', values.high], { width: 390, height: 844, isPhone: true, motion: 'reduce' }, async (page) => {
  await shot(page, 'phone');
  const before = await picture(page);
  const [finger, other] = [await page.touchscreen.touchStart(150, 500), await page.touchscreen.touchStart(240, 600)];
  await finger.move(120, 450);
  await other.move(290, 690);
  await finger.end();
  await other.end();
  verify((await picture(page)) !== before, 'two fingers zoom');
  await page.tap('#panel-toggle');
  await drawn(page);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
  verify(!wide, 'nothing is wider than the phone');
  await shot(page, 'phone_panel');
  await accessible(page, 'phone');
});

// Decoders of textures and meshes run in workers, which the page's policy must let be.
const packed = path.join(out, 'packed.glb');
execFileSync(values.parbake, ['simplify', values.low, '-t', '1000000', '-o', packed, '-q', '--texture-format', 'ktx2', '--mesh-compression', 'meshopt']);
await session('KTX2 and meshopt', [packed], ['--compare', values.low], SMALL, async (page) => {
  const decibels = parseFloat(await page.$eval('#psnr', (e) => e.textContent));
  verify(decibels > 32, `compressed, the model looks the same: ${decibels} dB`);
  await shot(page, 'packed');
});

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'parbake-broken-'));
const broken = path.join(folder, 'broken.glb');
fs.writeFileSync(broken, fs.readFileSync(values.low).subarray(0, 700));
await session('broken', [broken], [], {}, async (page, { state }) => {
  verify(state === 'refused', 'a broken file is refused');
  verify((await page.$eval('#failure-text', (e) => e.textContent)).includes('broken.glb'), 'with its name');
  await accessible(page, 'broken');
  await shot(page, 'broken');
});
await session('desktop', [values.low], ['--compare', values.high], {}, async (page) => {
  await shot(page, 'desktop');
  await page.keyboard.press('6');
  await drawn(page);
  await shot(page, 'desktop_uv');
  await page.keyboard.press('5');
  await page.keyboard.press('t');
  await drawn(page);
  await shot(page, 'desktop_dark');
});
await session('compared with a broken one', [values.low], ['--compare', broken], {}, async (page, { state }) => {
  verify(state === 'shown' && !(await page.$eval('#banner', (e) => e.hidden)), 'the other model is still shown');
  await shot(page, 'half_broken');
});

// Parts of files that only three.js looks at: each would hang it.
const hostile = {
  'a scene that lies below itself': (json) => {
    json.nodes.push({ children: [json.nodes.length] });
    json.scenes.push({ nodes: [json.nodes.length - 1] });
  },
  'a level that is its own node': (json) => { json.nodes[0].extensions = { MSFT_lod: { ids: [0] } }; },
  'an animation without end': (json) => {
    json.accessors.push({ componentType: 5126, count: 2 ** 31, type: 'SCALAR' });
    const input = json.accessors.length - 1;
    json.animations = [{ samplers: [{ input, output: input }], channels: [{ sampler: 0, target: { node: 0, path: 'scale' } }] }];
  },
};
for (const [what, change] of Object.entries(hostile)) {
  const file = path.join(folder, 'hostile.glb'), bytes = fs.readFileSync(values.low), length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + length));
  change(json);
  let text = Buffer.from(JSON.stringify(json));
  text = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const head = Buffer.from(bytes.subarray(0, 20));
  head.writeUInt32LE(text.length, 12);
  head.writeUInt32LE(bytes.length - length + text.length, 8);
  fs.writeFileSync(file, Buffer.concat([head, text, bytes.subarray(20 + length)]));
  await session(what, [file], [], SMALL, async (page, { state }) => {
    verify(state === 'refused', `${what} is refused`);
    console.log(`  ${await page.$eval('#failure-text', (e) => e.textContent)}`);
  });
}
fs.rmSync(folder, { recursive: true });

await browser.close();
console.log(failures ? `${failures} failures` : `all passed; pictures are in ${out}`);
process.exit(failures ? 1 : 0);
