#!/usr/bin/env node
// Compares Parbake's levels of detail with gltfpack's simplification to as many triangles, as three.js
// shows both beside the original: at the size on screen that a level was made for, and close up. Also
// how far two neighbouring levels are apart where one takes over from the other.

import { mkdir, readFile, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { VIEWER_OPTIONS, UsageError, chosen, lightsOf, main, whole } from './lib/common.mjs';
import { levelsReport } from './lib/levels_report.mjs';
import { makeGltfpacks, makeLevels } from './lib/make.mjs';
import { findModels } from './lib/models.mjs';
import { sweep } from './lib/sweep.mjs';
import { mean } from './lib/table.mjs';
import { pictureSize } from './lib/viewer.mjs';

const USAGE = `usage: node levels.mjs FOLDER [options] [-- options of parbake lod]

  FOLDER               each of its sub-folders holds one .glb or .gltf
  --parbake PATH       the program [parbake]
  --out FOLDER         where files, pictures and tables go [levels]
  --light LIGHT        room, sky or sun [room]
  --views N            viewpoints [6]
  --size N             side of the pictures close up in pixels [384]
  --backgrounds LIST   colours with commas [#000000,#808080]
  --models A,B         only these
  --reuse              keep what an earlier run made with the same options
  --seconds N          time limit of each run of parbake [1800]
  --chromium PATH      the browser [CHROMIUM, or where it usually is]`;

const PICTURES = 3;

/** PSNR over all backgrounds. */
const overall = (shown, who) => mean(Object.values(shown.psnr[who]).map((value) => value.mean));

/** One level beside gltfpack's and the original; `before` is the file of the level before. */
async function compareLevel(model, file, before, level, folder, settings, viewer) {
  const row = { level: level.level, screenSize: level.screen_size, psnr: {} };
  row.gltfpack = await makeGltfpacks(model, path.join(folder, `gltfpack${level.level}`), {
    triangles: level.triangles,
    reuse: settings.reuse,
  });
  const candidates = { ours: file };
  if (!row.gltfpack.refused) candidates.gltfpack = path.join(folder, `gltfpack${level.level}`, 'gltfpack.glb');
  const sizes = { own: pictureSize(level.screen_size), closeUp: settings.size };
  for (const [name, size] of Object.entries(sizes)) {
    const shown = await viewer.compare(model, candidates, { ...settings, size, pictures: PICTURES });
    row.psnr[name] = Object.fromEntries(Object.keys(candidates).map((who) => [who, overall(shown, who)]));
    row.original = shown.costs.original;
    row.ours = shown.costs.ours;
    if (candidates.gltfpack) Object.assign(row.gltfpack, shown.costs.gltfpack);
    for (const [background, sheet] of Object.entries(shown.sheets)) {
      const picture = `level${level.level}_${name}_${background.replace('#', '')}.png`;
      await writeFile(path.join(folder, picture), Buffer.from(sheet, 'base64'));
    }
  }
  if (level.switch_pixels) {
    const at = { ...settings, size: pictureSize(level.switch_pixels), pictures: 0 };
    row.switchPixels = level.switch_pixels;
    row.psnr.atSwitch = overall(await viewer.compare(model, { ours: file }, at), 'ours');
    if (before) row.psnr.againstBefore = overall(await viewer.compare(before, { ours: file }, at), 'ours');
  }
  return row;
}

async function compareModel({ name, file }, settings, viewer) {
  const folder = path.join(settings.out, name);
  await mkdir(folder, { recursive: true });
  const row = { model: name, levels: [] };
  try {
    row.made = await makeLevels(file, folder, settings);
    if (row.made.refused) return row;
    const document = JSON.parse(await readFile(path.join(folder, 'ours', 'lods.json'), 'utf8'));
    let before = null;
    for (const level of document.levels) {
      const own = path.join(folder, 'ours', level.file);
      row.levels.push(await compareLevel(file, own, before, level, folder, settings, viewer));
      before = own;
    }
  } catch (error) {
    row.failed = error.message;
  }
  return row;
}

async function compare() {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: { ...VIEWER_OPTIONS, views: { type: 'string', default: '6' } },
  });
  if (values.help) return void console.log(USAGE);
  const [folder, ...lodOptions] = positionals;
  if (!folder) throw new UsageError('a folder of models is missing');
  const lights = lightsOf(values.light);
  if (lights.length > 1) throw new UsageError('--light takes one light here');
  const settings = {
    parbake: values.parbake,
    out: path.resolve(values.out ?? 'levels'),
    light: lights[0],
    views: whole(values, 'views', 1, 1000),
    size: whole(values, 'size', 16, 4096),
    backgrounds: values.backgrounds.split(','),
    seconds: whole(values, 'seconds', 1, 1e6),
    reuse: values.reuse,
    lodOptions,
  };
  const models = chosen(await findModels(folder), values.models);
  if (models.length === 0) throw new Error(`${folder}: no sub-folder holds a .glb or .gltf`);
  const rows = await sweep(
    models,
    { out: settings.out, name: 'levels', jobs: 1, chromium: values.chromium },
    (model, viewer) => compareModel(model, settings, viewer),
    (done) => levelsReport(done, settings),
  );
  console.log(levelsReport(rows, settings).markdown);
}

await main(compare, USAGE);
