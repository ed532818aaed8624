// Makes the two files that are compared: Parbake's bake and gltfpack's simplification.

import { existsSync } from 'node:fs';
import { mkdir, readFile, rm, stat, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { SIMPLIFY, simplifyWithGltfpack } from './gltfpack.mjs';
import { countTriangles } from './models.mjs';
import { reason, run, warnings } from './run.mjs';

/**
 * What `make` returns, from the file beside `output` if that was made by the same `recipe` before
 * and `reuse` allows it. A failure is a result too: `make` may return `{ refused }`.
 */
async function made(output, recipe, reuse, make) {
  const stamp = `${output}.json`;
  if (reuse && existsSync(stamp)) {
    const old = JSON.parse(await readFile(stamp, 'utf8'));
    if (JSON.stringify(old.recipe) === JSON.stringify(recipe) && (old.result.refused || existsSync(output))) {
      return old.result;
    }
  }
  await Promise.all([output, stamp].map((file) => rm(file, { force: true })));
  const result = await make();
  if (!result.refused) result.bytes = (await stat(output)).size;
  await writeFile(stamp, JSON.stringify({ recipe, result }, null, 2));
  return result;
}

/**
 * Ours: the model cut to `triangles` and baked at `textureSize`. Returns `{ triangles, seconds,
 * warnings, bytes }`, or `{ refused }` with the program's sentence.
 */
export function bakeOurs(model, folder, { parbake, triangles, textureSize, bakeOptions, reuse, seconds }) {
  const low = path.join(folder, 'low.glb');
  const output = path.join(folder, 'ours.glb');
  const bake = ['bake', model, low, '-o', output, '--texture-size', String(textureSize), ...bakeOptions];
  const simplify = ['simplify', model, '-o', low, '--triangles', String(triangles)];
  const recipe = { model, simplify, bake };
  return made(output, recipe, reuse, async () => {
    await mkdir(folder, { recursive: true });
    const cut = await run(parbake, simplify, { seconds });
    if (cut.code !== 0) return { refused: `simplify: ${reason(cut)}` };
    const baked = await run(parbake, bake, { seconds });
    if (baked.code !== 0) return { refused: `bake: ${reason(baked)}` };
    return { triangles: await countTriangles(output), seconds: baked.seconds, warnings: warnings(baked) };
  });
}

/** Our levels of detail in `ours/`: `{ seconds, warnings, bytes }` (of lods.json), or `{ refused }`. */
export function makeLevels(model, folder, { parbake, lodOptions, reuse, seconds }) {
  const output = path.join(folder, 'ours');
  const lod = ['lod', model, '-o', output, ...lodOptions];
  return made(path.join(output, 'lods.json'), { model, lod }, reuse, async () => {
    await mkdir(output, { recursive: true });
    const done = await run(parbake, lod, { seconds });
    if (done.code !== 0) return { refused: `lod: ${reason(done)}` };
    return { seconds: done.seconds, warnings: warnings(done) };
  });
}

/** gltfpack's: `{ triangles, ratio, note, bytes }`, or `{ refused }`. */
export function makeGltfpacks(model, folder, { triangles, reuse }) {
  const output = path.join(folder, 'gltfpack.glb');
  return made(output, { model, triangles, flags: SIMPLIFY }, reuse, async () => {
    await mkdir(folder, { recursive: true });
    try {
      return await simplifyWithGltfpack(model, triangles, output);
    } catch (error) {
      return { refused: error.message };
    }
  });
}
