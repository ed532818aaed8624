// Models on disk: which there are in a folder, and how many triangles one has.

import { readdir, readFile } from 'node:fs/promises';
import path from 'node:path';

const GLB_MAGIC = 0x46546c67;

/**
 * The models of a folder, sorted by name: `{ name, file }`. A sub-folder that holds a model is one
 * model, named after it. A model that lies in the folder itself is named after its file. With
 * `deep`, sub-folders are searched at any depth and every file is a model of its own.
 */
export async function findModels(folder, { extensions = ['.glb', '.gltf'], deep = false } = {}) {
  const isModel = (name) => extensions.includes(path.extname(name).toLowerCase());
  const sorted = async (at) =>
    (await readdir(at, { withFileTypes: true })).sort((a, b) => (a.name < b.name ? -1 : 1));
  const found = [];
  const search = async (at, prefix) => {
    const entries = await sorted(at);
    const files = entries.filter((entry) => entry.isFile() && isModel(entry.name));
    for (const { name } of files) {
      const own = files.length === 1 && prefix ? prefix : path.posix.join(prefix, path.parse(name).name);
      found.push({ name: own, file: path.join(at, name) });
      if (!deep && prefix) return;
    }
    if (!deep && prefix) return;
    for (const entry of entries.filter((other) => other.isDirectory())) {
      await search(path.join(at, entry.name), path.posix.join(prefix, entry.name));
    }
  };
  await search(folder, '');
  return found;
}

/** The JSON of a .gltf or .glb. */
export async function readJson(file) {
  const bytes = await readFile(file);
  if (bytes.length >= 20 && bytes.readUInt32LE(0) === GLB_MAGIC) {
    return JSON.parse(bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)));
  }
  return JSON.parse(bytes.toString('utf8'));
}

/** Whether a file names an extension among those that it needs. */
export async function requires(file, extension) {
  return ((await readJson(file)).extensionsRequired ?? []).includes(extension);
}

/** Triangles of a primitive, by its mode (list, strip, fan). Points and lines have none. */
function trianglesOf(json, primitive) {
  const accessor = json.accessors?.[primitive.indices ?? primitive.attributes.POSITION];
  const corners = accessor?.count ?? 0;
  const mode = primitive.mode ?? 4;
  if (mode === 4) return Math.floor(corners / 3);
  return mode === 5 || mode === 6 ? Math.max(0, corners - 2) : 0;
}

/** Triangles that a glTF file shows: those of its scene's nodes, instances included. */
export async function countTriangles(file) {
  const json = await readJson(file);
  const nodes = json.nodes ?? [];
  const ofNode = (index, above) => {
    if (above.has(index)) throw new Error(`${file}: node ${index} is its own ancestor`);
    const node = nodes[index];
    const instancing = node.extensions?.EXT_mesh_gpu_instancing?.attributes;
    const instances = instancing ? (json.accessors[Object.values(instancing)[0]]?.count ?? 1) : 1;
    let sum = 0;
    for (const primitive of json.meshes?.[node.mesh]?.primitives ?? []) sum += instances * trianglesOf(json, primitive);
    for (const child of node.children ?? []) sum += ofNode(child, new Set([...above, index]));
    return sum;
  };
  const children = new Set(nodes.flatMap((node) => node.children ?? []));
  const roots = json.scenes?.[json.scene ?? 0]?.nodes ?? [...nodes.keys()].filter((index) => !children.has(index));
  let sum = 0;
  for (const root of roots) sum += ofNode(root, new Set());
  return sum;
}
