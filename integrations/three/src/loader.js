// The plug-in of GLTFLoader: reads the extension, loads its images, and gives the materials their maps.
import { ClampToEdgeWrapping, LinearFilter, NoColorSpace } from 'three';
import { ParallaxMaps, applyParallax } from './material.js';
import { NAME, readParallax, withOwnTextures } from './format.js';
import { addShadowMaterials } from './depth.js';

const warn = (text) => console.warn(`${NAME}: ${text}`);

/** An image of numbers: as it is stored, without mip levels. */
function asData(texture) {
  const data = texture.clone();
  return Object.assign(data, {
    colorSpace: NoColorSpace, premultiplyAlpha: false, generateMipmaps: false, anisotropy: 1, channel: 0,
    minFilter: LinearFilter, magFilter: LinearFilter, wrapS: ClampToEdgeWrapping, wrapT: ClampToEdgeWrapping,
  });
}

/** `loader.register((parser) => new ParallaxPlugin(parser))` */
export class ParallaxPlugin {
  /** `alphaToCoverage: false` leaves the borders of cutouts jagged where the target has several samples. */
  constructor(parser, { alphaToCoverage = true } = {}) {
    this.name = NAME;
    this.parser = parser;
    this.options = { alphaToCoverage };
    this.maps = [];
  }

  beforeRoot() {
    const { json } = this.parser;
    this.maps = (json.materials ?? []).map((material) => readParallax(material, warn));
    // The small textures for other viewers are then never asked for.
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
    try {
      if (!material.isMeshStandardMaterial) throw new Error('the material is not lit, and this reads lit ones');
      if (!shift?.image || (map.cutout && !cut?.image)) throw new Error('an image of it cannot be read');
      const cutout = map.cutout && { ...map.cutout, texture: asData(cut) };
      applyParallax(material, new ParallaxMaps({ ...map, texture: asData(shift), cutout }), this.options);
    } catch (error) {
      warn(`the parallax map of material "${material.name}" was left out: ${error.message}`);
    }
    return material;
  }

  afterRoot({ scenes }) {
    for (const scene of scenes) addShadowMaterials(scene);
    return null;
  }
}
