// Models: fetched, parsed, taught to show their channels, and counted.
import { AnimationMixer, Box3, DRACOLoader, GLTFLoader, Group, LoadingManager, MeshoptDecoder } from './vendor.js';
import { guard } from './guard.js';
import { Ktx2 } from './ktx2.js';
import { TEXTURE_SLOTS, forget, teach } from './materials.js';
import { ParallaxPlugin, parallaxMaterials, setParallax } from '../../../integrations/three/src/index.js';

/** Maps of the first version, which are not shown. */
const OLD_PARALLAX = 'PARBAKE_materials_parallax_sh';

/** Asks for a model of the session, `{ name, url, notes }`: its bytes and what there is to say about it. */
export async function fetchModel(entry) {
  const told = fetch(entry.notes).then((r) => r.json()).catch(() => ({}));
  const response = await fetch(entry.url).catch(() => {
    throw new Error('parbake view no longer answers: it was ended, or its address has changed. Start it again.');
  });
  if (!response.ok) throw new Error((await told).error ?? `${entry.name}: the viewer answered ${response.status}.`);
  const bytes = await response.arrayBuffer(), { warnings = [], bytes: size = bytes.byteLength } = await told;
  return { entry, bytes, size, notes: [...warnings] };
}

/** A function that makes a `Model` of what `fetchModel` gave. Errors have one sentence for people. */
export function createLoader(renderer) {
  let broken;
  const workerFails = new Promise((_, reject) => { broken = reject; });
  workerFails.catch(() => {});
  const draco = new DRACOLoader().setDecoderPath('draco/');
  const ktx2 = new Ktx2(undefined, broken).detectSupport(renderer);
  return async ({ entry, bytes, size, notes }) => {
    const manager = new LoadingManager();
    manager.onError = () => {
      const sentence = `${entry.name}: a texture could not be decoded; its material is shown without it.`;
      if (!notes.includes(sentence)) notes.push(sentence);
    };
    const loader = new GLTFLoader(manager).setDRACOLoader(draco).setKTX2Loader(ktx2).setMeshoptDecoder(MeshoptDecoder)
      .register((parser) => new ParallaxPlugin(parser, { fallback: true }));
    try {
      guard(bytes);
      const gltf = await Promise.race([loader.parseAsync(bytes, ''), workerFails]);
      return new Model(entry, gltf, await levelsOf(gltf), size, notes);
    } catch (error) {
      throw new Error(`${entry.name}: this file cannot be shown: ${error?.message ?? error}.`);
    }
  };
}

/** Nodes with MSFT_lod: each with its levels, the finest first, and the least coverage of the screen for each. */
async function levelsOf({ parser, scene }) {
  const found = [];
  scene.traverse((object) => {
    const index = parser.associations.get(object)?.nodes;
    const definition = index === undefined ? null : parser.json.nodes?.[index];
    const ids = definition?.extensions?.MSFT_lod?.ids;
    if (Array.isArray(ids) && ids.length && object.parent) found.push({ object, ids, definition });
  });
  const nodes = [];
  for (const { object, ids, definition } of found) {
    const coarser = await Promise.all(ids.map((id) => parser.getDependency('node', id)));
    for (const level of coarser) object.parent.add(level);
    const coverage = definition.extras?.MSFT_screencoverage;
    nodes.push({ objects: [object, ...coarser], coverage: Array.isArray(coverage) ? coverage : null });
  }
  return nodes;
}

/** One loaded file. */
export class Model {
  constructor(entry, gltf, lodNodes, bytes, notes) {
    this.name = entry.name;
    this.bytes = bytes;
    this.notes = notes;
    this.root = new Group().add(gltf.scene);
    this.clips = gltf.animations;
    this.mixer = this.clips.length ? new AnimationMixer(gltf.scene) : null;
    this.lodNodes = lodNodes;
    this.levels = Math.max(1, ...lodNodes.map((node) => node.objects.length));
    this.coverage = lodNodes[0]?.coverage ?? null;
    const used = gltf.parser.json.extensionsUsed ?? [];
    if (used.includes(OLD_PARALLAX))
      notes.push(`${this.name} has parallax maps of the older kind. This viewer shows the plain material, without their depth.`);
    this.prepare();
    this.parallax = parallaxMaterials(this.root);
    this.showLevel(0);
  }

  prepare() {
    let others = 0;
    this.hasTransmission = false;
    this.hasExtensions = false;
    this.root.traverse((object) => {
      // Every model is shown in the same light.
      if (object.isLight) object.visible = false;
      if (object.isPoints || object.isLine) others++;
      for (const material of materialsOf(object)) {
        // Before it is taught: where channels are shown it is solid then.
        if (material.transmission > 0) this.hasTransmission = true;
        teach(material);
        if (material.isMeshPhysicalMaterial) this.hasExtensions = true;
      }
    });
    if (others) this.notes.push(`${this.name}: points and lines are shown, but not counted.`);
  }

  /** Shows one level of nodes that have several; `null` shows none. */
  showLevel(level) {
    for (const { objects } of this.lodNodes) {
      const shown = level === null ? -1 : Math.min(level, objects.length - 1);
      objects.forEach((object, index) => { object.visible = index === shown; });
    }
  }

  /** Shows parallax maps and their cutouts, or the plain materials. */
  setParallax(isOn) { setParallax(this.root, isOn); }

  /** Gives back what it takes of the graphics processor; it is shown no more. */
  dispose() {
    this.root.traverse((object) => {
      object.geometry?.dispose();
      for (const material of materialsOf(object)) {
        const own = TEXTURE_SLOTS.map(([slot]) => material[slot]);
        for (const texture of [...own, ...(material.parallax?.textures ?? [])]) {
          texture?.dispose();
          // Pictures that were decoded for the graphics processor are not given back with their textures.
          texture?.source.data?.close?.();
        }
        forget(material);
        material.dispose();
      }
    });
  }

  /** Whether maps are shown. */
  get showsMaps() { return this.parallax.some((material) => material.parallax.enabled); }

  /** Whether borders are drawn with their coverage as alpha. */
  get isCut() { return this.parallax.some((material) => material.parallax.enabled && material.alphaToCoverage); }

  /** The box around all vertices as they stand in the file. */
  box() {
    this.root.updateMatrixWorld(true);
    return new Box3().setFromObject(this.root, true);
  }

  /** What is drawn and kept of what is visible now. */
  figures() {
    const figures = { triangles: 0, vertices: 0, materials: 0, textures: 0, texels: 0 };
    const materials = new Set(), sources = new Map(), geometries = new Set();
    this.root.traverseVisible((object) => {
      if (!object.isMesh) return;
      const { geometry } = object, position = geometry.attributes.position;
      if (!position) return;
      const instances = object.isInstancedMesh ? object.count : 1;
      figures.triangles += ((geometry.index ? geometry.index.count : position.count) / 3) * instances;
      if (!geometries.has(position)) figures.vertices += position.count;
      geometries.add(position);
      for (const material of materialsOf(object)) materials.add(material);
    });
    for (const material of materials)
      for (const texture of [...TEXTURE_SLOTS.map(([slot]) => material[slot]), ...(material.parallax?.textures ?? [])]) {
        const image = texture?.image;
        if (image) sources.set(texture.source, (image.width || 0) * (image.height || 0));
      }
    figures.materials = materials.size;
    figures.textures = sources.size;
    for (const texels of sources.values()) figures.texels += texels;
    return figures;
  }

  /** Each texture once: `{ label, texture, meshes }`, the meshes being those that use it. */
  textures() {
    const found = new Map();
    this.root.traverse((object) => {
      if (!object.isMesh) return;
      for (const material of materialsOf(object))
        for (const [slot, label] of TEXTURE_SLOTS) {
          const texture = material[slot];
          if (!texture?.image) continue;
          const key = `${texture.source.uuid} ${label}`;
          if (!found.has(key)) found.set(key, { label, material: material.name, texture, meshes: new Set() });
          found.get(key).meshes.add(object);
        }
    });
    return [...found.values()];
  }

  /** All meshes that are visible now. */
  meshes() {
    const meshes = [];
    this.root.traverseVisible((object) => { if (object.isMesh) meshes.push(object); });
    return meshes;
  }
}

/** An object's materials, as a list. */
export function materialsOf(object) {
  return object.material ? [object.material].flat() : [];
}
