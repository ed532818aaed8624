// Parallax maps in a browser: the package of integrations/three by itself, then the page that uses it.
//   node test/parallax.mjs [--parbake COMMAND] [--out FOLDER] [--costs] [MODELS WITH MAPS]
// Fails on: a message in the console, a function that gives other numbers than the format, a feature of three.js that
// the maps break, a switch that changes nothing. With the command, and models, also on pictures that are not those of
// the CPU renderer. With --costs it tells what maps cost, which takes a minute.
import * as esbuild from 'esbuild';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { drawn, findBrowser, launch, settled, watchedPage } from './browser.mjs';
import { readFilm } from './film.mjs';
import { MODELS, NUMBERS, NUMBERS_AT, modelOf } from './parallax_models.mjs';
import { parallaxModel } from './parallax_model.mjs';
import { below, serve, servePage } from './serve.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: {
  parbake: { type: 'string' }, out: { type: 'string' }, costs: { type: 'boolean', default: false },
} });
if (!findBrowser()) {
  console.log('skipped: no Chromium (apt-get install chromium, or set CHROMIUM)');
  process.exit(0);
}
const here = path.dirname(fileURLToPath(import.meta.url)), viewer = path.join(here, '..');
const out = values.out ?? fs.mkdtempSync(path.join(os.tmpdir(), 'parbake-parallax-'));
fs.mkdirSync(out, { recursive: true });
let failures = 0;
const verify = (isTrue, what) => {
  if (isTrue) return;
  failures++;
  console.error(`FAILED: ${what}`);
};
const browser = await launch();

async function ofPackage() {
  const { outputFiles: [script] } = await esbuild.build({
    entryPoints: [path.join(here, 'parallax_lab.js')], bundle: true, format: 'esm', write: false, absWorkingDir: viewer,
    alias: { three: path.join(viewer, 'node_modules/three') }, logLevel: 'warning',
  });
  const { url, stop } = await serve((name) => ({
    'index.html': '<!doctype html><link rel="icon" href="data:,"><script type="module" src="lab.js"></script>', 'lab.js': script.text,
  })[name] ?? modelOf(name));
  const { page, errors } = await watchedPage(browser, { width: 400, height: 300 });
  await page.goto(url);
  await page.waitForFunction(() => window.lab);
  const run = (...args) => page.evaluate((all) => window.lab.run(...all), args);

  const have = await run('numbers', NUMBERS_AT);
  NUMBERS.forEach((number, k) => verify(Math.abs(have[k] - number) < 2e-5, `function ${k} is ${have[k]}, not ${number}`));

  const { changed, back, materials } = await run('switching', 'ball');
  verify(changed > 0.05 && back === 0 && materials === 1, `the switch: ${changed} changed, ${back} on the way back, ${materials} materials`);
  const whole = await run('everything', 'ball');
  verify(whole.changed > 0.05 && whole.coverage, `with fog, environment and shadows: ${JSON.stringify(whole)}`);
  const ways = await run('ways', 'ball');
  for (const [way, differs] of Object.entries(ways)) verify(differs < 0.004, `${way}: ${differs} of the picture differs`);
  const orthographic = await run('orthographic', 'ball');
  verify(orthographic < 0.01, `orthographic: ${orthographic} of the picture differs`);
  const { isTaken, differs } = await run('anisotropic', 'ball');
  verify(isTaken && differs < 0.1, `anisotropic: ${differs} of the picture differs`);
  const shadows = await run('shadows', 'no offsets'), reaching = await run('shadows', 'ball');
  for (const [light, { cut, whole: all }] of Object.entries(shadows)) {
    verify(cut > 0.3 * all && cut < 0.97 * all, `shadow of ${light}: ${cut} of ${all}`);
    // With offsets the same is cut, and what is whole is smaller.
    const { cut: same, whole: smaller } = reaching[light];
    verify(Math.abs(same - cut) < 0.02 * cut && smaller < 0.9 * all, `shadow of ${light} with offsets: ${same} for ${cut}, ${smaller} for ${all}`);
  }
  const prepass = await run('prepass', 'ball');
  verify(prepass < 0.001, `after a depth pass ${prepass} of the picture differs`);
  const { covered, plain } = await run('borders', 'ball');
  verify(covered.clear === 0 && covered.between > plain.between && Math.abs(covered.white - plain.white) < 0.05, `borders: ${JSON.stringify({ covered, plain })}`);

  const leaves = (loaded) => !loaded.hasMaps && loaded.changed === 0 && loaded.warnings.length === 1 && loaded.shades > 20;
  for (const name of Object.keys(MODELS)) {
    const loaded = await run('loaded', name), told = `${name}: ${JSON.stringify(loaded)}`;
    if (['next version', 'too few numbers', 'no image'].includes(name)) verify(leaves(loaded), told);
    else if (name === 'faded') verify(loaded.hasMaps && loaded.changed < 0.001, told);
    else verify(loaded.hasMaps && loaded.changed > 0.02 && loaded.warnings.length === 0, told);
    if (name === 'own textures') verify(!loaded.images.includes(0) && !loaded.images.includes(1), told);
    if (name === 'clearcoat') verify(loaded.type === 'MeshPhysicalMaterial', told);
  }
  const textures = await run('fallback', 'own textures');
  verify(`${textures}` === '4,0,4,0', `textures with maps and without: ${textures}`);
  for (const name of ['no tangents', 'no normals', 'no normal map', 'no colour map', 'alpha test', 'clearcoat']) {
    const all = await run('everything', name);
    verify(all.changed > 0.02, `${name}, with fog, environment and shadows: ${JSON.stringify(all)}`);
    const after = await run('prepass', name);
    verify(after < 0.001, `${name}: after a depth pass ${after} of the picture differs`);
  }
  // three.js itself says that a picture is broken.
  const others = errors.filter((text) => !text.includes("Couldn't load texture"));
  verify(others.length === 0, `the package: console: ${others.join(' | ')}`);
  console.log(`the package: ${JSON.stringify({ ways, orthographic, shadows, prepass })}`);
  await page.close();
  await stop();
}

/** A page of the package, and what it is called in the folder of pictures. */
async function ofExample(file, called) {
  const folder = path.join(viewer, '../../integrations/three');
  const { url, stop } = await serve((name) => {
    if (name === 'ball.glb') return parallaxModel();
    return name.startsWith('node_modules/three/') ? below(viewer, name) : below(folder, name);
  });
  const { page, errors, outside } = await watchedPage(browser, { width: 500, height: 400 });
  await page.goto(`${url}example/${file}?model=/ball.glb`);
  await page.waitForFunction(() => document.getElementById('told').textContent.includes('with parallax maps'));
  const shot = async (name) => {
    // Two frames later.
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    return Buffer.from(await page.screenshot({ path: path.join(out, `${name}.png`), clip: { x: 0, y: 60, width: 500, height: 340 } }));
  };
  const on = await shot(`${called}_on`);
  await page.click('#parallax');
  verify(!on.equals(await shot(`${called}_off`)), `${called}: its switch changes the picture`);
  verify(errors.length === 0 && outside.length === 0, `${called}: ${errors.join(' | ')} ${outside.join(' ')}`);
  await page.close();
  await stop();
}

const FRAMES = 4, SIZE = 256, HEIGHT = 20;

/** Decibels between the page and the CPU renderer, the least of a few views. */
async function againstCpu(page, file, isOn) {
  const film = path.join(out, 'film.png'), more = isOn ? [] : ['--no-parallax'];
  // The model is its own reference: its box is the frame.
  execFileSync(values.parbake, ['turntable', file, file, '-o', film, '--frames', FRAMES, '--resolution', SIZE, '--height', HEIGHT,
    '--background', 'black', '--no-captions', '-q', ...more]);
  const { width, frames } = readFilm(fs.readFileSync(film));
  let least = Infinity;
  for (let i = 0; i < FRAMES; i++) {
    const [turn, up] = [(2 * Math.PI * i) / FRAMES, (HEIGHT * Math.PI) / 180];
    const direction = [Math.cos(up) * Math.sin(turn), Math.sin(up), Math.cos(up) * Math.cos(turn)];
    const still = Buffer.from(await page.evaluate((wanted) => {
      let text = '';
      for (const byte of window.parbake.stage.still(wanted)) text += String.fromCharCode(byte);
      return btoa(text);
    }, { direction, size: SIZE, supersample: 2, light: 'headlight' }), 'base64');
    let sum = 0;
    for (let y = 0; y < SIZE; y++)
      for (let x = 0; x < SIZE; x++)
        for (let k = 0; k < 3; k++) sum += (still[4 * (y * SIZE + x) + k] - frames[i][3 * (y * width + x) + k]) ** 2;
    least = Math.min(least, -10 * Math.log10(sum / (3 * SIZE * SIZE * 255 ** 2)));
  }
  return least;
}

/** Milliseconds of a frame, the median of several. */
const frameTime = (page, light) => page.evaluate((chosen) => {
  const { stage } = window.parbake, times = [], pixel = new Uint8Array(4), gl = stage.renderer.getContext();
  stage.choose({ light: chosen, channel: 'lit', turn: 0 });
  const target = stage.target(0, 512, 512), camera = stage.view.at(1);
  for (let i = 0; i < 13; i++) {
    const began = performance.now();
    stage.picture(0, target, camera, { wireframe: false, background: [0, 0, 0] });
    stage.composer.draw({ first: target.texture, layout: 0, isColor: true, exposure: 1, background: [0, 0, 0] });
    // Waits for the picture.
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    if (i > 2) times.push(performance.now() - began);
  }
  return times.sort((a, b) => a - b)[5];
}, light);

async function ofPage(name, bytes, file) {
  const { url, stop } = await servePage(path.join(viewer, 'dist'), [[name, bytes]]);
  const { page, errors } = await watchedPage(browser, { width: 800, height: 480 });
  await page.goto(url);
  verify((await settled(page)) === 'shown', `${name} is shown`);
  const picture = async () => {
    await drawn(page);
    return page.evaluate(() => window.parbake.snapshot());
  };
  const isOn = () => page.$eval('#parallax', (e) => e.checked);
  verify(await page.$eval('#parallax-switch', (e) => !e.hidden), `${name}: the switch is there`);
  const on = await picture();
  verify(await isOn(), `${name}: maps are shown at first`);
  await page.screenshot({ path: path.join(out, `${name}_on.png`) });
  await page.focus('#canvas');
  await page.keyboard.press('d');
  const off = await picture();
  verify(!(await isOn()) && off !== on, `${name}: D shows the plain material`);
  await page.screenshot({ path: path.join(out, `${name}_off.png`) });
  await page.click('#parallax');
  verify((await isOn()) && (await picture()) === on, `${name}: the switch shows the maps again`);
  for (const channel of ['base', 'normal', 'roughness', 'metallic', 'occlusion', 'emission', 'opacity', 'checker', 'lit']) {
    await page.click(`input[name="channel"][value="${channel}"]`);
    await picture();
  }
  if (values.costs) await tellCosts(name, page);
  if (file && values.parbake) {
    for (const parallax of [true, false]) {
      await page.evaluate((value) => window.parbake.store.set({ parallax: value }), parallax);
      const decibels = await againstCpu(page, file, parallax);
      console.log(`${name}, maps ${parallax ? 'on' : 'off'}: at least ${decibels.toFixed(1)} dB beside the CPU renderer`);
      verify(decibels > 40, `${name}, maps ${parallax ? 'on' : 'off'}: ${decibels.toFixed(1)} dB beside the CPU renderer`);
    }
  }
  verify(errors.length === 0, `${name}: console: ${errors.join(' | ')}`);
  await page.close();
  await stop();
}

async function tellCosts(name, page) {
  const told = [];
  for (const light of ['studio', 'room', 'headlight']) {
    const times = {};
    for (const parallax of [false, true, false, true]) {
      await page.evaluate((value) => window.parbake.store.set({ parallax: value }), parallax);
      times[parallax] = Math.min(times[parallax] ?? Infinity, await frameTime(page, light));
    }
    told.push(`${light} ${times.false.toFixed(1)} to ${times.true.toFixed(1)} ms (${(times.true / times.false).toFixed(2)} times)`);
  }
  console.log(`${name}: a frame of 512², plain to maps: ${told.join(', ')}`);
}

await ofPackage();
await ofExample('index.html', 'example');
await ofExample('webgpu.html', 'example_nodes');
const ball = path.join(out, 'ball.glb');
fs.writeFileSync(ball, parallaxModel());
await ofPage('ball', fs.readFileSync(ball), null);
// With colour and normals alone, as the CPU renderer films it under a headlight.
const plain = path.join(out, 'plain_ball.glb');
fs.writeFileSync(plain, parallaxModel({ rings: 24, sectors: 36, change: ({ materials: [material] }) => {
  for (const key of ['occlusionTexture', 'emissiveTexture', 'emissiveFactor']) delete material[key];
  material.pbrMetallicRoughness = { baseColorTexture: { index: 0 }, metallicFactor: 0, roughnessFactor: 1 };
} }));
await ofPage('plain_ball', fs.readFileSync(plain), plain);
for (const file of positionals) await ofPage(path.basename(file, '.glb'), fs.readFileSync(file), file);
await browser.close();
console.log(failures ? `${failures} failures` : `all passed; pictures are in ${out}`);
process.exit(failures ? 1 : 0);
