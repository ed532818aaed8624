// What each material can show besides its light: single channels, the studio's light, a headlight. The materials
// stay three.js's own; a few lines after their shading choose what is written.
import { Matrix3 } from './vendor.js';
import { STUDIO_GLSL, splitSum, studioUniforms } from './studio.js';

/** Channels: key, label, and whether the values are colours (which the screen encodes) or numbers. */
export const CHANNELS = [
  { key: 'lit', label: 'Lit', code: 0, isColor: true },
  { key: 'base', label: 'Base colour', code: 1, isColor: true },
  { key: 'normal', label: 'Normal', code: 2 },
  { key: 'roughness', label: 'Roughness', code: 3 },
  { key: 'metallic', label: 'Metallic', code: 4 },
  { key: 'occlusion', label: 'Occlusion', code: 5 },
  { key: 'emission', label: 'Emission', code: 6, isColor: true },
  { key: 'opacity', label: 'Opacity', code: 7 },
  { key: 'checker', label: 'UV checker', code: 8 },
];

/** What is written instead of three.js's own light. */
export const SHADED = { three: 0, studio: 10, headlight: 11 };

const uniforms = { pbTurn: { value: new Matrix3() }, pbUnit: { value: 1 }, pbSplitSum: { value: null }, ...studioUniforms };
const taught = new Map();
let shown = 0;

/** Chooses what all materials write. Each choice is a program of its own: branches would cost every pixel. */
export function show(code) {
  if (code === SHADED.studio) uniforms.pbSplitSum.value = splitSum();
  if (code === shown) return;
  shown = code;
  for (const [material, transmission] of taught) {
    if (transmission > 0) showGlass(material, transmission);
    material.needsUpdate = true;
  }
}

/** Glass is solid in channels and under the headlight. Where it transmits light, three.js draws all that is behind it first. */
function showGlass(material, transmission) {
  material.transmission = showsGlass(shown) ? transmission : 0;
}

/** Whether glass shows what is behind it. */
export const showsGlass = (code) => code === SHADED.three || code === SHADED.studio;

/** Says how long the model's unit is in the scene: attenuation is by lengths of the model. */
export function setUnit(length) { uniforms.pbUnit.value = length; }

/** Turns the studio about +Y, in radians. */
export function turnStudio(angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  uniforms.pbTurn.value.set(c, 0, s, 0, 1, 0, -s, 0, c);
}

const CHECKER = /* glsl */ `
varying vec2 pbUv;
vec3 pbChecker(vec2 uv) {
  vec2 at = floor(uv * 16.0), tile = fract(at / 16.0);
  vec3 hue = vec3(0.30 + 0.55 * tile.x, 0.38 + 0.4 * tile.y, 0.85 - 0.45 * tile.x);
  return mix(hue, hue * 0.55, mod(at.x + at.y, 2.0));
}
`;

/** What is written for each choice, of a material that light falls on and of one without. */
const WRITTEN = {
  1: ['diffuseColor.rgb', 'diffuseColor.rgb'],
  2: ['pbNormal * 0.5 + 0.5', 'vec3(0.5, 0.5, 1.0)'],
  3: ['vec3(roughnessFactor)', 'vec3(1.0)'],
  4: ['vec3(metalnessFactor)', 'vec3(0.0)'],
  5: ['vec3(pbOcclusion)', 'vec3(1.0)'],
  6: ['totalEmissiveRadiance', 'vec3(0.0)'],
  7: ['vec3(diffuseColor.a)', 'vec3(diffuseColor.a)'],
  8: ['pbChecker(pbUv)', 'pbChecker(pbUv)'],
  10: ['pbLit', 'diffuseColor.rgb'],
  11: ['max(dot(pbNormal, pbViewer), 0.0) * diffuseColor.rgb + totalEmissiveRadiance', 'diffuseColor.rgb'],
};

// What extensions show, of a physical material in the studio's light.
const LAYERED = /* glsl */ `
  vec3 pbF0 = vec3(0.04), pbReflects;
  float pbF90 = 1.0, pbPassing = 0.0;
  #ifdef USE_TRANSMISSION
    float pbThickness = thickness;
    pbPassing = transmission;
    #ifdef USE_TRANSMISSIONMAP
      pbPassing *= texture2D(transmissionMap, vTransmissionMapUv).r;
    #endif
    #ifdef USE_THICKNESSMAP
      pbThickness *= texture2D(thicknessMap, vThicknessMapUv).g;
    #endif
  #endif
  #ifdef USE_SPECULAR
    vec3 pbTint = specularColor;
    pbF90 = specularIntensity;
    #ifdef USE_SPECULAR_COLORMAP
      pbTint *= texture2D(specularColorMap, vSpecularColorMapUv).rgb;
    #endif
    #ifdef USE_SPECULAR_INTENSITYMAP
      pbF90 *= texture2D(specularIntensityMap, vSpecularIntensityMapUv).a;
    #endif
    float pbIor = (ior - 1.0) / (ior + 1.0);
    pbF0 = min(pbIor * pbIor * pbTint, vec3(1.0)) * pbF90;
  #endif
  vec3 pbLit = pbBase(diffuseColor.rgb, metalnessFactor, roughnessFactor, pbOcclusion, totalEmissiveRadiance, pbNormal, pbViewer,
    pbF0, pbF90, 1.0 - pbPassing, pbReflects);
  float pbBelow = 1.0;
  #ifdef USE_SHEEN
    vec3 pbSheenColor = sheenColor;
    float pbSheenRoughness = sheenRoughness;
    #ifdef USE_SHEEN_COLORMAP
      pbSheenColor *= texture2D(sheenColorMap, vSheenColorMapUv).rgb;
    #endif
    #ifdef USE_SHEEN_ROUGHNESSMAP
      pbSheenRoughness *= texture2D(sheenRoughnessMap, vSheenRoughnessMapUv).a;
    #endif
    vec4 pbCloth = pbSheen(pbSheenColor, pbSheenRoughness, pbOcclusion, pbNormal, pbViewer);
    pbLit = pbLit * pbCloth.a + pbCloth.rgb;
    pbBelow *= pbCloth.a;
  #endif
  #ifdef USE_CLEARCOAT
    float pbStrength = clearcoat, pbCoatRoughness = clearcoatRoughness;
    #ifdef USE_CLEARCOATMAP
      pbStrength *= texture2D(clearcoatMap, vClearcoatMapUv).x;
    #endif
    #ifdef USE_CLEARCOAT_ROUGHNESSMAP
      pbCoatRoughness *= texture2D(clearcoatRoughnessMap, vClearcoatRoughnessMapUv).y;
    #endif
    vec4 pbVarnish = pbCoat(pbStrength, pbCoatRoughness, pbOcclusion,
      inverseTransformDirection(clearcoatNormal, viewMatrix), pbViewer);
    pbLit = pbLit * pbVarnish.a + pbVarnish.rgb;
    pbBelow *= pbVarnish.a;
  #endif
  #ifdef USE_TRANSMISSION
    vec3 pbWay = getVolumeTransmissionRay(pbNormal, pbViewer, pbThickness, ior, modelMatrix);
    vec3 pbLeft = pbThickness > 0.0 ? volumeAttenuation(length(pbWay) / pbUnit, attenuationColor, attenuationDistance) : vec3(1.0);
    vec3 pbPasses = clamp(pbPassing * pbLeft * (1.0 - metalnessFactor) * (1.0 - pbReflects) * diffuseColor.rgb, 0.0, 1.0) * pbBelow;
    vec4 pbOnScreen = projectionMatrix * viewMatrix * vec4(vWorldPosition + pbWay, 1.0);
    vec4 pbBehind = getTransmissionSample(0.5 * pbOnScreen.xy / pbOnScreen.w + 0.5, max(roughnessFactor, 0.0525), ior);
    pbLit += pbPasses * pbBehind.rgb;
    diffuseColor.a *= 1.0 - dot(pbPasses, vec3(1.0 / 3.0)) * (1.0 - pbBehind.a);
  #endif
`;

// Instead of the shading, once all that it needs is fetched.
const chosen = (code, isLit) => /* glsl */ `
{
  #ifdef OPAQUE
    diffuseColor.a = 1.0;
  #endif
  ${isLit ? `
  vec3 pbNormal = inverseTransformDirection(normal, viewMatrix);
  vec3 pbViewer = inverseTransformDirection(normalize(vViewPosition), viewMatrix);
  float pbOcclusion = 1.0;
  #ifdef USE_AOMAP
    pbOcclusion = (texture2D(aoMap, vAoMapUv).r - 1.0) * aoMapIntensity + 1.0;
  #endif` : ''}
  ${isLit && code === SHADED.studio ? LAYERED : ''}
  gl_FragColor = vec4(${WRITTEN[code][isLit ? 0 : 1]}, ${code === 7 || code === 8 ? '1.0' : 'diffuseColor.a'});
  return;
}
`;

function patched(shader) {
  // Also where nothing of ours is shown: three.js keeps the uniforms of the program that it compiled last.
  Object.assign(shader.uniforms, uniforms);
  if (shown === SHADED.three) return;
  const place = ['#include <lights_physical_fragment>', '#include <opaque_fragment>'].find((p) => shader.fragmentShader.includes(p));
  const isLit = place !== '#include <opaque_fragment>';
  const studio = isLit && shown === SHADED.studio ? STUDIO_GLSL : '';
  const declared = (shown === 8 ? CHECKER : '') + studio;
  if (shown === 8)
    shader.vertexShader = shader.vertexShader.replace('void main() {', 'varying vec2 pbUv;\nvoid main() {\n  pbUv = uv;');
  shader.fragmentShader = shader.fragmentShader
    .replace('void main() {', `${declared}\nvoid main() {`)
    .replace(place, `${chosen(shown, isLit)}\n${place}`);
}

/** Teaches a material to show its channels. */
export function teach(material) {
  if (taught.has(material) || (!material.isMeshStandardMaterial && !material.isMeshBasicMaterial)) return;
  const { transmission = 0 } = material;
  taught.set(material, transmission);
  if (transmission > 0) showGlass(material, transmission);
  // Parallax maps come second: they change what is fetched, ours included.
  const { onBeforeCompile, customProgramCacheKey } = material;
  material.onBeforeCompile = function (shader, renderer) {
    patched(shader);
    onBeforeCompile.call(this, shader, renderer);
  };
  material.customProgramCacheKey = function () { return `parbake ${shown} ${customProgramCacheKey.call(this)}`; };
}

/** Forgets a material that is shown no more. */
export function forget(material) { taught.delete(material); }

/** Each texture of a material with the channel that it is for. */
export const TEXTURE_SLOTS = [
  ['map', 'Base colour'], ['normalMap', 'Normal'], ['roughnessMap', 'Roughness, metallic'],
  ['metalnessMap', 'Roughness, metallic'], ['aoMap', 'Occlusion'], ['emissiveMap', 'Emission'],
  ['clearcoatMap', 'Clearcoat'], ['clearcoatRoughnessMap', 'Clearcoat roughness'],
  ['clearcoatNormalMap', 'Clearcoat normal'], ['sheenColorMap', 'Sheen'], ['sheenRoughnessMap', 'Sheen roughness'],
  ['transmissionMap', 'Transmission'], ['thicknessMap', 'Thickness'], ['specularColorMap', 'Specular colour'],
  ['specularIntensityMap', 'Specular'], ['iridescenceMap', 'Iridescence'],
  ['iridescenceThicknessMap', 'Iridescence thickness'], ['anisotropyMap', 'Anisotropy'],
];
