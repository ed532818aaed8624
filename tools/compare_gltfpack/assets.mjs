#!/usr/bin/env node
// Makes docs/assets.md: for every model of the data folder, whether Parbake loads it, bakes it or
// refuses it and why, how long the bake takes, and the PSNR of the bake in three.js.

import { mkdir, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { assetsPage } from './lib/assets_page.mjs';
import { VIEWER_OPTIONS, UsageError, chosen, lightsOf, main, whole } from './lib/common.mjs';
import { bakeOurs } from './lib/make.mjs';
import { countTriangles, findModels } from './lib/models.mjs';
import { inParallel } from './lib/run.mjs';
import { Viewer } from './lib/viewer.mjs';

const USAGE = `usage: node assets.mjs DATA [options] [-- options of parbake bake]

  DATA                 a folder with the sets below
  --sets LIST          its sub-folders, with commas [pbr,feature,extreme]
  --page FILE          the page to write [assets.md in --out]
  --parbake PATH       the program [parbake]
  --out FOLDER         where files and pictures go [assets]
  --triangles N        triangles of the low-polys, at most half of the model's own [1000]
  --texture-size N     side of the textures [512]
  --light LIGHT        room, sky or sun [room]
  --views N            viewpoints [12]
  --size N             side of a picture in pixels [384]
  --backgrounds LIST   colours with commas [#000000,#808080]
  --models A,B         only these, as SET/NAME
  --jobs N             models at the same time [1]
  --reuse              keep what an earlier run made with the same options
  --seconds N          time limit of each run of parbake [1800]
  --chromium PATH      the browser [CHROMIUM, or where it usually is]`;

const EXTENSIONS = ['.glb', '.gltf', '.obj'];

async function findAll(data, sets) {
  const found = [];
  for (const set of sets) {
    const models = await findModels(path.join(data, set), { deep: true, extensions: EXTENSIONS });
    found.push(...models.map(({ name, file }) => ({ set, name: path.posix.join(set, name), file })));
  }
  return found;
}

/** One model: `{ set, model, made, psnr, original, shown, failed }`. */
async function tryModel({ set, name, file }, settings, viewer) {
  const row = { set, model: name.slice(set.length + 1) };
  const folder = path.join(settings.out, name);
  try {
    // What an OBJ has is known only to its readers; `simplify` stops at the most that it finds.
    const own = file.toLowerCase().endsWith('.obj') ? Infinity : await countTriangles(file);
    const triangles = Math.max(4, Math.min(settings.triangles, Math.floor(own / 2)));
    row.made = await bakeOurs(file, folder, { ...settings, triangles });
    if (row.made.refused) return row;
    const shown = await viewer.compare(file, { baked: path.join(folder, 'ours.glb') }, settings);
    row.psnr = shown.psnr.baked;
    row.original = shown.costs.original;
    row.shown = shown.costs.baked;
    for (const [background, sheet] of Object.entries(shown.sheets)) {
      await writeFile(path.join(folder, `${background.replace('#', '')}.png`), Buffer.from(sheet, 'base64'));
    }
  } catch (error) {
    row.failed = error.message;
  }
  return row;
}

async function assets() {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: {
      ...VIEWER_OPTIONS,
      sets: { type: 'string', default: 'pbr,feature,extreme' },
      page: { type: 'string' },
      triangles: { type: 'string', default: '1000' },
      'texture-size': { type: 'string', default: '512' },
    },
  });
  if (values.help) return void console.log(USAGE);
  const [data, ...bakeOptions] = positionals;
  if (!data) throw new UsageError('the folder of data is missing');
  const [light, ...more] = lightsOf(values.light);
  if (more.length > 0) throw new UsageError('--light: one light');
  const settings = {
    parbake: values.parbake,
    out: path.resolve(values.out ?? 'assets'),
    triangles: whole(values, 'triangles', 4, 1e8),
    textureSize: whole(values, 'texture-size', 16, 8192),
    light,
    views: whole(values, 'views', 1, 1000),
    size: whole(values, 'size', 16, 4096),
    backgrounds: values.backgrounds.split(','),
    pictures: 3,
    seconds: whole(values, 'seconds', 1, 1e6),
    reuse: values.reuse,
    bakeOptions,
  };
  const page = values.page ?? path.join(settings.out, 'assets.md');
  const models = chosen(await findAll(path.resolve(data), values.sets.split(',')), values.models);
  if (models.length === 0) throw new Error(`${data}: there is no model`);
  await mkdir(settings.out, { recursive: true });
  const viewer = await Viewer.start(values.chromium);
  const rows = new Array(models.length);
  try {
    await inParallel(models, whole(values, 'jobs', 1, 64), async (model, index) => {
      rows[index] = await tryModel(model, settings, viewer);
      const done = rows.filter(Boolean);
      console.error(`${model.name}: ${done.length} of ${models.length}`);
      await writeFile(page, assetsPage(done, settings, path.resolve(data)));
      await writeFile(path.join(settings.out, 'assets.json'), JSON.stringify(done, null, 2));
    });
  } finally {
    await viewer.close();
  }
}

await main(assets, USAGE);
