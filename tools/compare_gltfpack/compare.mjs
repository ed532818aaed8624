#!/usr/bin/env node
// Compares Parbake's bakes with gltfpack's simplification on every model of a folder, as three.js
// shows both beside the original. README.md says what is measured and how.

import { mkdir, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { VIEWER_OPTIONS, UsageError, chosen, lightsOf, main, whole } from './lib/common.mjs';
import { LIGHT_NAMES } from './lib/light_names.mjs';
import { bakeOurs, makeGltfpacks } from './lib/make.mjs';
import { countTriangles, findModels } from './lib/models.mjs';
import { report } from './lib/report.mjs';
import { sweep } from './lib/sweep.mjs';

const USAGE = `usage: node compare.mjs FOLDER [options] [-- options of parbake bake]

  FOLDER               each of its sub-folders holds one .glb or .gltf
  --parbake PATH       the program [parbake]
  --out FOLDER         where files, pictures and tables go [compared]
  --triangles N        triangles of the low-polys, at most half of the model's own [1000]
  --texture-size N     side of our textures [512]
  --light LIGHTS       room, sky, sun, or several with commas [room]
  --relight            all three lights, and how much each loses against room
  --views N            viewpoints [12]
  --size N             side of a picture in pixels [384]
  --backgrounds LIST   colours with commas [#000000,#808080]
  --pictures N         viewpoints of the pictures that are kept [3]
  --models A,B         only these
  --jobs N             models at the same time [1]
  --reuse              keep what an earlier run made with the same options
  --seconds N          time limit of each run of parbake [1800]
  --chromium PATH      the browser [CHROMIUM, or where it usually is]`;

/** Everything about one model. Failures are part of the row. */
async function compareModel({ name, file }, settings, viewer) {
  const folder = path.join(settings.out, name);
  await mkdir(folder, { recursive: true });
  const row = { model: name, psnr: {} };
  try {
    row.originalTriangles = await countTriangles(file);
    const triangles = Math.max(4, Math.min(settings.triangles, Math.floor(row.originalTriangles / 2)));
    row.ours = await bakeOurs(file, folder, { ...settings, triangles });
    row.gltfpack = await makeGltfpacks(file, folder, { triangles: row.ours.triangles ?? triangles, reuse: settings.reuse });
    const candidates = {};
    for (const who of ['ours', 'gltfpack']) {
      if (!row[who].refused) candidates[who] = path.join(folder, `${who}.glb`);
    }
    if (Object.keys(candidates).length === 0) return row;
    for (const light of settings.lights) {
      const shown = await viewer.compare(file, candidates, { ...settings, light });
      row.psnr[light] = shown.psnr;
      row.original = shown.costs.original;
      for (const who of Object.keys(candidates)) Object.assign(row[who], shown.costs[who]);
      for (const [background, sheet] of Object.entries(shown.sheets)) {
        const picture = `${light}_${background.replace('#', '')}.png`;
        await writeFile(path.join(folder, picture), Buffer.from(sheet, 'base64'));
      }
    }
  } catch (error) {
    row.failed = error.message;
  }
  return row;
}

async function compare() {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: {
      ...VIEWER_OPTIONS,
      triangles: { type: 'string', default: '1000' },
      'texture-size': { type: 'string', default: '512' },
      pictures: { type: 'string', default: '3' },
      relight: { type: 'boolean', default: false },
    },
  });
  if (values.help) return void console.log(USAGE);
  const [folder, ...bakeOptions] = positionals;
  if (!folder) throw new UsageError('a folder of models is missing');
  const settings = {
    parbake: values.parbake,
    out: path.resolve(values.out ?? 'compared'),
    triangles: whole(values, 'triangles', 4, 1e8),
    textureSize: whole(values, 'texture-size', 16, 8192),
    lights: values.relight ? LIGHT_NAMES : lightsOf(values.light),
    views: whole(values, 'views', 1, 1000),
    size: whole(values, 'size', 16, 4096),
    backgrounds: values.backgrounds.split(','),
    pictures: whole(values, 'pictures', 0, 1000),
    seconds: whole(values, 'seconds', 1, 1e6),
    reuse: values.reuse,
    bakeOptions,
  };
  const models = chosen(await findModels(folder), values.models);
  if (models.length === 0) throw new Error(`${folder}: no sub-folder holds a .glb or .gltf`);
  const rows = await sweep(
    models,
    { out: settings.out, name: 'compared', jobs: whole(values, 'jobs', 1, 64), chromium: values.chromium },
    (model, viewer) => compareModel(model, settings, viewer),
    (done) => report(done, settings),
  );
  console.log(report(rows, settings).markdown);
}

await main(compare, USAGE);
