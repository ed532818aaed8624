// What plug-ins of GLTFLoader have in common: reads the extension, and loads its images. Which materials get the maps is
// up to the renderer.
import { ClampToEdgeWrapping, LinearFilter, NoColorSpace, SRGBColorSpace, Vector3 } from 'three';
import { NAME, OFFSET, readParallax, withOwnTextures } from './format.js';
import { ParallaxMaps } from './maps.js';

const warn = (text) => console.warn(`${NAME}: ${text}`);

/** An image of numbers: as it is stored, without mip levels. */
function asData(texture) {
  const data = texture.clone();
  return Object.assign(data, {
    colorSpace: NoColorSpace, premultiplyAlpha: false, generateMipmaps: false, anisotropy: 1, channel: 0,
    minFilter: LinearFilter, magFilter: LinearFilter, wrapS: ClampToEdgeWrapping, wrapT: ClampToEdgeWrapping,
  });
}

/** Culling is by the surface that reaches furthest. */
function growBounds(root) {
  const offset = new Vector3(), reaches = new Map();
  root.traverse((object) => {
    const { geometry } = object, offsets = geometry?.attributes[OFFSET];
    if (!offsets) return;
    if (!reaches.has(geometry)) {
      let reach = 0;
      for (let i = 0; i < offsets.count; i++) reach = Math.max(reach, offset.fromBufferAttribute(offsets, i).length() || 0);
      reaches.set(geometry, reach);
      geometry.computeBoundingSphere();
      geometry.boundingSphere.radius += reach;
      geometry.boundingBox?.expandByScalar(reach);
    }
    if (!object.isSkinnedMesh) return;
    // Its bones move the sphere, which is made anew when it is asked for.
    const { computeBoundingSphere } = object;
    object.computeBoundingSphere = function () {
      computeBoundingSphere.call(this);
      this.boundingSphere.radius += reaches.get(geometry);
    };
  });
}

/** The base of the plug-ins; they have `give(material, maps, fallback)`, which returns the material with its maps. */
export class MapLoader {
  /** `fallback: true` also loads the textures for other viewers, which are shown while maps are switched off. */
  constructor(parser, { fallback = false } = {}) {
    this.name = NAME;
    this.parser = parser;
    this.loadsFallback = fallback;
    this.maps = [];
    this.plain = [];
  }

  /** A scene is loaded. */
  finish(scene) { growBounds(scene); }

  beforeRoot() {
    const { json } = this.parser;
    this.maps = (json.materials ?? []).map((material) => readParallax(material, warn));
    this.plain = json.materials ?? [];
    // The small textures for other viewers are then never asked for, but here.
    if (json.materials) json.materials = json.materials.map((material, i) => (this.maps[i] ? withOwnTextures(material) : material));
    return null;
  }

  loadMaterial(index) {
    const map = this.maps[index];
    return map ? this.#load(index, map) : null;
  }

  async #load(index, map) {
    const { parser } = this;
    const data = (info) => (info ? parser.getDependency('texture', info.index) : null);
    const [material, shift, cut] = await Promise.all([parser.loadMaterial(index), data(map.texture), data(map.cutout?.texture)]);
    const fallback = this.loadsFallback ? await this.#loadFallback(this.plain[index]) : {};
    try {
      if (!material.isMeshStandardMaterial) throw new Error('the material is not lit, and this reads lit ones');
      if (!shift?.image || (map.cutout && !cut?.image)) throw new Error('an image of it cannot be read');
      const cutout = map.cutout && { ...map.cutout, texture: asData(cut) };
      return this.give(material, new ParallaxMaps({ ...map, texture: asData(shift), cutout }), fallback);
    } catch (error) {
      warn(`the parallax map of material "${material.name}" was left out: ${error.message}`);
    }
    return material;
  }

  /** What slots of a material hold without the maps, of those where they hold something else with them. */
  async #loadFallback(json) {
    const own = json.extensions[NAME], held = {};
    const slots = [
      ['map', own.baseColorTexture, json.pbrMetallicRoughness?.baseColorTexture, SRGBColorSpace],
      ['normalMap', own.normalTexture, json.normalTexture],
    ];
    await Promise.all(slots.filter(([, ofMap, plain]) => ofMap && plain)
      .map(([slot, , plain, space]) => this.parser.assignTexture(held, slot, plain, space)));
    return held;
  }

  afterRoot({ scenes }) {
    for (const scene of scenes) this.finish(scene);
    return null;
  }
}
