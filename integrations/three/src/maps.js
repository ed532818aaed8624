// The maps as shaders have them, whichever renderer compiles these.
import { CustomBlending, MaxEquation, OneFactor, Vector2, Vector4, ZeroFactor } from 'three';
import { LAYERS } from './format.js';

const vectors = (numbers) => Array.from({ length: numbers.length / 4 }, (_, i) => new Vector4(...numbers.slice(4 * i, 4 * i + 4)));

function rowsOf(texture, layers) {
  const { height } = texture.image;
  if (height % layers) throw new Error(`an image of ${height} rows has no ${layers} layers of one height`);
  return new Vector2(height / layers, height);
}

/** The maps of one or more materials, as the shaders have them. */
export class ParallaxMaps {
  /** `texture` and `cutout.texture` are textures; the rest is as in the format. */
  constructor({ texture, scale, offset, limit = 0.25, fadeFootprint = Infinity, cutout = null }) {
    this.textures = cutout ? [texture, cutout.texture] : [texture];
    this.hasCutout = Boolean(cutout);
    this.isFading = Number.isFinite(fadeFootprint);
    this.uniforms = {
      parallaxMap: { value: texture }, parallaxScale: { value: vectors(scale) }, parallaxOffset: { value: vectors(offset) },
      parallaxRows: { value: rowsOf(texture, LAYERS.shift) }, parallaxLimit: { value: limit },
      parallaxFootprint: { value: fadeFootprint }, parallaxIsMultisampled: { value: false },
    };
    if (cutout) Object.assign(this.uniforms, {
      parallaxCutoutMap: { value: cutout.texture }, parallaxCutoutScale: { value: vectors(cutout.scale) },
      parallaxCutoutOffset: { value: vectors(cutout.offset) }, parallaxCutoutRows: { value: rowsOf(cutout.texture, LAYERS.cutout) },
    });
  }
}

/**
 * How borders of cutouts are blended where alpha covers samples: alpha chooses them, and is then no longer wanted, so that over an
 * opaque background it stays 1.
 */
export const BORDERS = {
  blending: CustomBlending, blendSrc: OneFactor, blendDst: ZeroFactor, blendSrcAlpha: OneFactor, blendDstAlpha: OneFactor,
  blendEquationAlpha: MaxEquation,
};
