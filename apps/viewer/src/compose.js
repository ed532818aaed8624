// From linear light to the screen: exposure, tone curve, background, sRGB; and how two pictures share it.
import { LinearSRGBColorSpace, Mesh, OrthographicCamera, PlaneGeometry, Scene, ShaderMaterial } from './vendor.js';

export const LAYOUTS = { first: 0, second: 1, split: 2, side: 3, difference: 4 };
export const TONES = [['none', 'None'], ['neutral', 'Khronos neutral'], ['aces', 'ACES']];

/** Stops of the heat map, from no difference to `HEAT_MOST` of the range and more. */
export const HEAT = ['#0d0f1c', '#45217a', '#b5366e', '#f07f3c', '#fcf2a4'];
export const HEAT_MOST = 0.25;

const stop = (hex) => `vec3(${[1, 3, 5].map((at) => (parseInt(hex.slice(at, at + 2), 16) / 255).toFixed(4))})`;

const VERTEX = 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }';
const FRAGMENT = /* glsl */ `
uniform sampler2D first, second;
uniform float split, exposure;
uniform vec3 background, backgroundLight;
varying vec2 at;

vec3 encoded(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
// Khronos PBR Neutral tone mapper, from its specification.
vec3 neutral(vec3 c) {
  float low = min(c.r, min(c.g, c.b)), offset = low < 0.08 ? low - 6.25 * low * low : 0.04;
  c -= offset;
  float peak = max(c.r, max(c.g, c.b)), start = 0.76;
  if (peak < start) return c;
  float d = 1.0 - start, top = 1.0 - d * d / (peak + d - start);
  c *= top / peak;
  return mix(c, vec3(top), 1.0 - 1.0 / (0.15 * (peak - top) + 1.0));
}
// Narkowicz' fit to the ACES curve.
vec3 aces(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }

vec3 shown(vec4 c) {
  if (c.a == 0.0) return background;
#ifdef IS_COLOR
  vec3 light = c.rgb * exposure;
#if TONE == 1
  light = neutral(light / c.a) * c.a;
#elif TONE == 2
  light = aces(light / c.a) * c.a;
#endif
  return encoded(light + (1.0 - c.a) * backgroundLight);
#else
  return clamp(c.rgb + (1.0 - c.a) * background, 0.0, 1.0);
#endif
}
vec3 heat(float x) {
  vec3 c = mix(${stop(HEAT[0])}, ${stop(HEAT[1])}, clamp(4.0 * x, 0.0, 1.0));
  c = mix(c, ${stop(HEAT[2])}, clamp(4.0 * x - 1.0, 0.0, 1.0));
  c = mix(c, ${stop(HEAT[3])}, clamp(4.0 * x - 2.0, 0.0, 1.0));
  return mix(c, ${stop(HEAT[4])}, clamp(4.0 * x - 3.0, 0.0, 1.0));
}
void main() {
#if LAYOUT == ${LAYOUTS.first}
  vec3 c = shown(texture2D(first, at));
#elif LAYOUT == ${LAYOUTS.second}
  vec3 c = shown(texture2D(second, at));
#elif LAYOUT == ${LAYOUTS.split}
  vec3 c = shown(at.x < split ? texture2D(first, at) : texture2D(second, at));
#elif LAYOUT == ${LAYOUTS.side}
  vec2 half_ = vec2(fract(2.0 * at.x), at.y);
  vec3 c = shown(at.x < 0.5 ? texture2D(first, half_) : texture2D(second, half_));
#else
  vec3 d = shown(texture2D(first, at)) - shown(texture2D(second, at));
  vec3 c = heat(sqrt(dot(d, d) / 3.0) / ${HEAT_MOST.toFixed(4)});
#endif
  gl_FragColor = vec4(c, 1.0);
}`;

const decoded = (c) => (c > 0.04045 ? ((c + 0.055) / 1.055) ** 2.4 : c / 12.92);

/** Draws linear pictures, premultiplied by their coverage, to a target or the screen. */
export class Composer {
  constructor(renderer) {
    renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer = renderer;
    this.uniforms = {
      first: { value: null }, second: { value: null }, split: { value: 0.5 }, exposure: { value: 1 },
      background: { value: [0, 0, 0] }, backgroundLight: { value: [0, 0, 0] },
    };
    this.materials = {};
    this.scene = new Scene();
    this.quad = new Mesh(new PlaneGeometry(2, 2));
    this.quad.frustumCulled = false;
    this.scene.add(this.quad);
    this.camera = new OrthographicCamera();
  }

  /** One program for each way to draw: software renderers pay for every branch that is not taken. */
  material(layout, isColor, tone) {
    const key = `${layout} ${isColor} ${tone}`;
    this.materials[key] ??= new ShaderMaterial({
      defines: { LAYOUT: layout, TONE: tone, ...(isColor ? { IS_COLOR: 1 } : {}) }, uniforms: this.uniforms,
      vertexShader: VERTEX, fragmentShader: FRAGMENT, depthTest: false, depthWrite: false,
    });
    return this.materials[key];
  }

  draw({ layout, isColor, tone = 0, ...values }, target = null) {
    for (const [name, value] of Object.entries(values)) this.uniforms[name].value = value;
    this.uniforms.backgroundLight.value = this.uniforms.background.value.map(decoded);
    this.quad.material = this.material(layout, isColor, tone);
    this.renderer.setRenderTarget(target);
    this.renderer.render(this.scene, this.camera);
  }
}
