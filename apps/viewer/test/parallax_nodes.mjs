// Parallax maps by WebGPURenderer: the nodes of integrations/three, beside its shaders for WebGLRenderer.
//   node test/parallax_nodes.mjs [--out FOLDER] [--webgpu] [MODELS WITH MAPS]
// On WebGL, as WebGPURenderer does where there is no WebGPU; with --webgpu on WebGPU as well, if the browser has it. Fails
// on: a message in the console, a function that gives other numbers than the format, a picture that is not that of WebGLRenderer, a
// switch that changes nothing.
import * as esbuild from 'esbuild';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { findBrowser, launch, watchedPage } from './browser.mjs';
import { NUMBERS, NUMBERS_AT, modelOf } from './parallax_models.mjs';
import { serve } from './serve.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: { out: { type: 'string' }, webgpu: { type: 'boolean', default: false } } });
if (!findBrowser()) {
  console.log('skipped: no Chromium (apt-get install chromium, or set CHROMIUM)');
  process.exit(0);
}
const here = path.dirname(fileURLToPath(import.meta.url)), viewer = path.join(here, '..');
const out = values.out ?? fs.mkdtempSync(path.join(os.tmpdir(), 'parbake-nodes-'));
fs.mkdirSync(out, { recursive: true });
let failures = 0;
const verify = (isTrue, what) => {
  if (isTrue) return;
  failures++;
  console.error(`FAILED: ${what}`);
};
// Decibels: samples lie elsewhere, frames of instances and batches are those of triangles, and both renderers shade clearcoats
// differently, also without maps.
const LEAST = { samples: 42, hard: 45, instances: 37, batches: 37, clearcoat: 38 };
const files = new Map(positionals.map((file) => [path.basename(file), file]));
const three = path.join(viewer, 'node_modules/three');
const { outputFiles: [script] } = await esbuild.build({
  entryPoints: [path.join(here, 'parallax_nodes_lab.js')], bundle: true, format: 'esm', write: false, absWorkingDir: viewer,
  alias: { 'three/webgpu': `${three}/build/three.webgpu.js`, 'three/tsl': `${three}/build/three.tsl.js`, three }, logLevel: 'warning',
});
const { url, stop } = await serve((name) => ({
  'index.html': '<!doctype html><link rel="icon" href="data:,"><script type="module" src="lab.js"></script>', 'lab.js': script.text,
})[name] ?? (files.has(name) ? fs.readFileSync(files.get(name)) : modelOf(name)));
const browser = await launch(values.webgpu ? ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan'] : []);
const { page, errors } = await watchedPage(browser, { width: 400, height: 300 });
await page.goto(url);
await page.waitForFunction(() => window.lab);
const run = (...args) => page.evaluate((all) => window.lab.run(...all), args);

const { webgpu } = await run('kinds');
if (values.webgpu && !webgpu) console.log('on WebGPU: skipped, this browser has none');
const told = {};
for (const kind of values.webgpu && webgpu ? ['nodes', 'webgpu'] : ['nodes']) {
  const have = await run('numbers', NUMBERS_AT, kind);
  NUMBERS.forEach((number, k) => verify(Math.abs(have[k] - number) < 2e-5, `${kind}: function ${k} is ${have[k]}, not ${number}`));
  const cases = [
    ...['plain', 'orthographic', 'samples', 'hard', 'mirrored', 'bones', 'shadow'].map((scene) => ['ball', scene]),
    // Tangents of these are turned by one of three.js' renderers alone.
    ['alpha test', 'samples'], ['vertex alpha', 'samples'],
    ...['instances', 'batches'].map((scene) => ['no normal map, no offsets', scene]),
    ...['no offsets', 'no tangents', 'no normals', 'no normal map', 'no colour map', 'alpha test', 'clearcoat', 'no cutout', 'fades', 'own textures']
      .map((name) => [name, 'plain']),
    ...[...files.keys()].map((name) => [name, 'plain']),
  ];
  for (const [name, scene] of cases) {
    const alike = await run('alike', name, scene, kind), what = `${kind}, ${name}, ${scene}: ${JSON.stringify(alike)}`;
    verify(alike.on > (LEAST[scene] ?? LEAST[name] ?? 60), what);
    verify(alike.changed > 0.01 && alike.back === 0, what);
    told[`${kind} ${name} ${scene}`] = [alike.on, alike.off].map((x) => Math.round(10 * x) / 10);
  }
  for (const [scene, isOn] of [['plain', true], ['plain', false], ['shadow', true], ['samples', true]])
    for (const renderer of [kind, 'webgl'])
      fs.writeFileSync(path.join(out, `${renderer}_${scene}_${isOn ? 'on' : 'off'}.png`), Buffer.from((await run('picture', 'ball', scene, renderer, isOn)).split(',')[1], 'base64'));
  const textures = await run('fallback', 'own textures', kind);
  verify(`${textures}` === '4,0,4,0', `${kind}: textures with maps and without: ${textures}`);
}
verify(errors.length === 0, `console: ${errors.join(' | ')}`);
console.log(`decibels between nodes and shaders, with maps and without: ${JSON.stringify(told)}`);
await page.close();
await stop();
await browser.close();
console.log(failures ? `${failures} failures` : `all passed; pictures are in ${out}`);
process.exit(failures ? 1 : 0);
