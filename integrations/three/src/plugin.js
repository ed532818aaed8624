// The plug-in of GLTFLoader for WebGLRenderer.
import { addShadowMaterials } from './depth.js';
import { MapLoader } from './loader.js';
import { applyParallax } from './material.js';

/** `loader.register((parser) => new ParallaxPlugin(parser))` */
export class ParallaxPlugin extends MapLoader {
  /**
   * `alphaToCoverage: false` leaves the borders of cutouts jagged where the target has several samples. `fallback: true`
   * also loads the textures for other viewers, which are shown while maps are switched off.
   */
  constructor(parser, { alphaToCoverage = true, ...more } = {}) {
    super(parser, more);
    this.alphaToCoverage = alphaToCoverage;
  }

  give(material, maps, fallback) {
    return applyParallax(material, maps, { alphaToCoverage: this.alphaToCoverage, fallback });
  }

  finish(scene) {
    super.finish(scene);
    addShadowMaterials(scene);
  }
}
