// Tests of what needs neither a browser nor other programs.

import assert from 'node:assert/strict';
import { mkdtemp, mkdir, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { chosen, lightsOf } from '../lib/common.mjs';
import { countTriangles, findModels, requires } from '../lib/models.mjs';
import { report } from '../lib/report.mjs';
import { inParallel, reason } from '../lib/run.mjs';
import { markdownTable, median } from '../lib/table.mjs';

/** Runs `work` in a folder that is removed afterwards. */
async function inFolder(work) {
  const folder = await mkdtemp(path.join(os.tmpdir(), 'compare-'));
  try {
    await work(folder);
  } finally {
    await rm(folder, { recursive: true });
  }
}

// Protects counts against forgotten strips, instances, shared meshes and nodes outside the scene.
test('triangles are those that the scene shows', () =>
  inFolder(async (folder) => {
    const file = path.join(folder, 'a.gltf');
    const json = {
      scene: 0,
      scenes: [{ nodes: [0, 1] }],
      nodes: [
        { mesh: 0, children: [2] },
        { mesh: 0, extensions: { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: 2 } } } },
        { mesh: 1 },
        { mesh: 0 },
      ],
      meshes: [
        { primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] },
        { primitives: [{ attributes: { POSITION: 0 }, mode: 5 }, { attributes: { POSITION: 0 }, mode: 1 }] },
      ],
      accessors: [{ count: 6 }, { count: 9 }, { count: 4 }],
      extensionsRequired: ['KHR_x'],
    };
    await writeFile(file, JSON.stringify(json));
    assert.equal(await countTriangles(file), 3 + 4 * 3 + 4);
    assert.equal(await requires(file, 'KHR_x'), true);
    const text = Buffer.from(JSON.stringify(json));
    const header = Buffer.alloc(20);
    [0x46546c67, 2, 20 + text.length, text.length, 0x4e4f534a].forEach((word, i) => header.writeUInt32LE(word, 4 * i));
    const glb = path.join(folder, 'a.glb');
    await writeFile(glb, Buffer.concat([header, text]));
    assert.equal(await countTriangles(glb), 19);
  }));

// Protects names: one model a sub-folder, or every file where a folder is searched deeply.
test('models are found and named', () =>
  inFolder(async (folder) => {
    for (const name of ['b', 'a/deeper']) await mkdir(path.join(folder, name), { recursive: true });
    for (const name of ['b/x.glb', 'a/deeper/y.gltf', 'a/deeper/z.obj', 'b/notes.txt']) {
      await writeFile(path.join(folder, name), '');
    }
    assert.deepEqual((await findModels(folder)).map(({ name }) => name), ['b']);
    const deep = await findModels(folder, { deep: true, extensions: ['.glb', '.gltf', '.obj'] });
    assert.deepEqual(deep.map(({ name }) => name), ['a/deeper/y', 'a/deeper/z', 'b']);
    assert.throws(() => chosen(deep, 'c'), /no such model/);
    assert.throws(() => lightsOf('room,moon'), /moon/);
  }));

// Protects the sums: a refused model is neither won nor lost, and does not move the median.
test('refused models are rows outside the sums', () => {
  const shown = (value) => ({ '#000000': { mean: value, least: value } });
  const rows = [
    { model: 'won', ours: {}, gltfpack: {}, psnr: { room: { ours: shown(40), gltfpack: shown(30) } } },
    { model: 'lost', ours: {}, gltfpack: {}, psnr: { room: { ours: shown(30), gltfpack: shown(32) } } },
    { model: 'refused', ours: { refused: 'no | door' }, gltfpack: {}, psnr: { room: { gltfpack: shown(30) } } },
  ];
  const settings = { lights: ['room'], backgrounds: ['#000000'], views: 1, size: 16, triangles: 9, textureSize: 16, bakeOptions: [] };
  const { markdown, json } = report(rows, settings);
  const [sums] = json.summaries;
  assert.equal(sums.compared, 2);
  assert.equal(sums.atOrAbove, 1);
  assert.equal(sums.moreThanOneBelow, 1);
  assert.equal(sums.medianDifference, 4);
  assert.match(markdown, /refused.*ours: no \\\| door/);
});

// Protects small things that tables rest on.
test('medians, reasons, cells, order', async () => {
  assert.equal(median([3, 1, NaN, 2]), 2);
  assert.equal(median([]), null);
  assert.equal(reason({ code: 1, output: 'warning: a\nerror: b is bad\n' }), 'b is bad');
  assert.match(reason({ code: 3, output: '' }), /code 3/);
  assert.match(markdownTable([{ title: 't', value: (row) => row.x }], [{}]), /– \|$/);
  assert.deepEqual(await inParallel([3, 1, 2], 2, async (n) => 2 * n), [6, 2, 4]);
});
