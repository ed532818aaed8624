// The plug-in of GLTFLoader for WebGPURenderer.
import { MapLoader } from './loader.js';
import { parallaxNodeMaterial } from './nodes.js';
import { followSwitches } from './reach.js';

/** `loader.register((parser) => new ParallaxNodePlugin(parser))` */
export class ParallaxNodePlugin extends MapLoader {
  /** As of ParallaxPlugin. */
  constructor(parser, { alphaToCoverage = true, ...more } = {}) {
    super(parser, more);
    this.alphaToCoverage = alphaToCoverage;
  }

  give(material, maps, fallback) {
    const own = parallaxNodeMaterial(material, maps, { alphaToCoverage: this.alphaToCoverage, fallback });
    const { associations } = this.parser;
    associations.set(own, associations.get(material));
    return own;
  }

  finish(scene) {
    super.finish(scene);
    followSwitches(scene);
  }
}
