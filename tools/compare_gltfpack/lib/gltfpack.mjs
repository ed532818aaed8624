// Makes gltfpack's low-poly with as many triangles as ours: the ratio that it is asked for
// (`-si`) is searched by bisection.

import { rename, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import path from 'node:path';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS, KHRDracoMeshCompression } from '@gltf-transform/extensions';
import draco3d from 'draco3dgltf';
import { countTriangles, requires } from './models.mjs';
import { reason, run } from './run.mjs';

const cli = path.join(path.dirname(createRequire(import.meta.url).resolve('gltfpack/package.json')), 'cli.js');

/** Permissive simplification that also moves what is left. */
export const SIMPLIFY = ['-sp', '-sv'];
// Floats without extensions: no loss that is not the simplification's own.
const UNCOMPRESSED = ['-noq'];
// gltfpack stops at an error of 1 % by default. A higher limit reaches lower numbers, but one that is
// higher than needed lets whole parts vanish, so the limit rises only until the number is reached.
const ERROR_LIMITS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1];
const LEAST_RATIO = 1e-4;
const STEPS = 14;
const CLOSE = 0.01;
const ALLOWED = 0.05;

/** A copy of a Draco-compressed model that gltfpack reads; it has no decoder of its own. */
async function withoutDraco(model, file) {
  const io = new NodeIO()
    .registerExtensions(ALL_EXTENSIONS)
    .registerDependencies({ 'draco3d.decoder': await draco3d.createDecoderModule() });
  const document = await io.read(model);
  for (const extension of document.getRoot().listExtensionsUsed()) {
    if (extension.extensionName === KHRDracoMeshCompression.EXTENSION_NAME) extension.dispose();
  }
  await io.write(file, document);
  return file;
}

/**
 * Writes `output`, a copy of `model` simplified to `target` triangles within 1 %, or the nearest
 * found: 14 attempts for each limit of the error with which the number can be reached, until it is
 * met within 5 %. Returns `{ triangles, ratio, note }`; the note says what a reader of the figures
 * must know. Throws when gltfpack cannot read the model.
 */
export async function simplifyWithGltfpack(model, target, output) {
  const notes = [];
  let source = model;
  const decoded = `${output}.decoded.glb`;
  const attempt = `${output}.attempt.glb`;
  if (await requires(model, 'KHR_draco_mesh_compression')) {
    source = await withoutDraco(model, decoded);
    notes.push('Draco decoded beforehand');
  }
  let best = null;
  const deviation = (triangles) => Math.abs(Math.log(Math.max(triangles, 1) / target));
  const simplify = async (ratio, limit) => {
    const flags = [...SIMPLIFY, ...UNCOMPRESSED, '-se', String(limit), '-si', String(ratio)];
    const result = await run(process.execPath, [cli, '-i', source, '-o', attempt, ...flags]);
    if (result.code !== 0) throw new Error(`gltfpack: ${reason(result)}`);
    const triangles = await countTriangles(attempt);
    if (!best || deviation(triangles) < deviation(best.triangles)) {
      await rename(attempt, output);
      best = { triangles, ratio, limit };
    }
    return triangles;
  };
  const search = async (limit, first) => {
    if ((await simplify(LEAST_RATIO, limit)) > target * (1 + ALLOWED)) return;
    let [low, high] = [0, 1];
    let ratio = first;
    for (let step = 0; step < STEPS && deviation(best.triangles) > CLOSE; step += 1) {
      if ((await simplify(ratio, limit)) > target) high = ratio;
      else low = ratio;
      ratio = (low + high) / 2;
    }
  };
  try {
    const first = Math.min(1, target / Math.max(1, await countTriangles(source)));
    for (const limit of ERROR_LIMITS) {
      await search(limit, first);
      if (deviation(best.triangles) <= ALLOWED) break;
    }
    if (best.limit !== ERROR_LIMITS[0]) notes.push(`limit of its error raised to ${best.limit} (-se)`);
    if (deviation(best.triangles) > ALLOWED) notes.push(`${best.triangles} triangles is the nearest`);
    return { triangles: best.triangles, ratio: best.ratio, note: notes.join('; ') };
  } finally {
    await Promise.all([decoded, attempt].map((file) => rm(file, { force: true })));
  }
}
