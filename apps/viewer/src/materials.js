// What each material can show besides its light: single channels, the studio's light, a headlight. The materials
// stay three.js's own; a few lines after their shading choose what is written.
import { CustomBlending, Matrix3, OneFactor, OneMinusSrcAlphaFactor, Vector3 } from './vendor.js';
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

const uniforms = { pbTurn: { value: new Matrix3() }, pbSplitSum: { value: null }, ...studioUniforms };
const taught = new Map();
let shown = 0;

/** Chooses what all materials write. Each choice is a program of its own: branches would cost every pixel. */
export function show(code) {
  if (code === SHADED.studio) uniforms.pbSplitSum.value = splitSum();
  if (code === shown) return;
  shown = code;
  for (const [material, own] of taught) {
    if (own.transmission > 0) showGlass(material, own);
    material.needsUpdate = true;
  }
}

/** Blends glass in the studio; in channels it is solid. three.js draws all that is behind it first, for its own light alone. */
function showGlass(material, own) {
  material.transmission = shown === SHADED.three ? own.transmission : 0;
  Object.assign(material, shown === SHADED.studio ? GLASS : own.blending);
}

const GLASS = { transparent: true, depthWrite: false, blending: CustomBlending, blendSrc: OneFactor, blendDst: OneMinusSrcAlphaFactor };

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
  vec3 pbF0 = vec3(0.04), pbReflects, pbAttenuated;
  float pbPassing = pbThrough(pbAttenuated);
  float pbF90 = 1.0;
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
  // Glass is blended, by the mean of what passes.
  vec3 pbPasses = clamp(pbPassing * pbAttenuated * (1.0 - metalnessFactor) * (1.0 - pbReflects) * diffuseColor.rgb, 0.0, 1.0) * pbBelow;
  pbOpacity = 1.0 - dot(pbPasses, vec3(1.0 / 3.0));
`;

// Instead of the shading, once all that it needs is fetched.
const chosen = (code, isLit) => /* glsl */ `
{
  #ifdef OPAQUE
    diffuseColor.a = 1.0;
  #endif
  ${isLit ? `
  float pbOpacity = 1.0;
  vec3 pbNormal = inverseTransformDirection(normal, viewMatrix);
  vec3 pbViewer = inverseTransformDirection(normalize(vViewPosition), viewMatrix);
  float pbOcclusion = 1.0;
  #ifdef USE_AOMAP
    pbOcclusion = (texture2D(aoMap, vAoMapUv).r - 1.0) * aoMapIntensity + 1.0;
  #endif` : ''}
  ${isLit && code === SHADED.studio ? LAYERED : ''}
  gl_FragColor = vec4(${WRITTEN[code][isLit ? 0 : 1]}, ${code === 7 || code === 8 ? '1.0' : 'diffuseColor.a'});
  ${isLit && code === SHADED.studio ? 'if (pbIsGlass) gl_FragColor = vec4(pbLit, pbOpacity) * (pbIsBlended ? diffuseColor.a : 1.0);' : ''}
  return;
}
`;

/** The textures of glass, each with its channel, as three.js has them where it draws glass itself. */
const GLASS_MAPS = [['transmissionMap', 'r'], ['thicknessMap', 'g']];

/** Gives a program `pbThrough()`: the share of light that passes its material, and what the inside leaves of it, by channel. */
function teachGlass(shader, material) {
  const own = taught.get(material), maps = GLASS_MAPS.filter(([name]) => own.transmission > 0 && material[name]);
  const { attenuationColor = new Vector3(1, 1, 1), attenuationDistance = Infinity, thickness = 0 } = material;
  const depth = own.transmission > 0 && thickness > 0 && Number.isFinite(attenuationDistance) ? thickness / attenuationDistance : 0;
  const color = attenuationColor.isColor ? new Vector3(...attenuationColor.toArray()) : attenuationColor;
  Object.assign(shader.uniforms, {
    pbGlass: { value: own.transmission }, pbDepth: { value: depth }, pbAttenuation: { value: color },
  });
  let declared = 'uniform float pbGlass, pbDepth;\nuniform vec3 pbAttenuation;\n', vertex = '', fetched = '';
  for (const [name, channel] of maps) {
    const texture = material[name], uv = texture.channel === 1 ? 'uv1' : 'uv', varying = `pb_${name}_uv`;
    // three.js does so for textures that it reads itself.
    if (texture.matrixAutoUpdate) texture.updateMatrix();
    shader.uniforms[`pb_${name}`] = { value: texture };
    shader.uniforms[`pb_${name}_transform`] = { value: texture.matrix };
    declared += `uniform sampler2D pb_${name};\nvarying vec2 ${varying};\n`;
    shader.vertexShader = `uniform mat3 pb_${name}_transform;\nvarying vec2 ${varying};\n${shader.vertexShader}`;
    vertex += `  ${varying} = (pb_${name}_transform * vec3(${uv}, 1.0)).xy;\n`;
    fetched += `  ${name === 'thicknessMap' ? 'depth' : 'passes'} *= texture2D(pb_${name}, ${varying}).${channel};\n`;
  }
  // Without USE_UV1 three.js declares no second set: nothing else reads it.
  const second = vertex.includes('uv1') ? '#ifndef USE_UV1\nattribute vec2 uv1;\n#endif\n' : '';
  shader.vertexShader = second + shader.vertexShader.replace('void main() {', `void main() {\n${vertex}`);
  return `${declared}const bool pbIsGlass = ${own.transmission > 0}, pbIsBlended = ${own.blending.transparent};
float pbThrough(out vec3 left) {
  float passes = pbGlass, depth = pbDepth;
${fetched}  left = exp(depth * log(max(pbAttenuation, vec3(1e-6))));
  return passes;
}
`;
}

function patched(shader, material) {
  // Also where nothing of ours is shown: three.js keeps the uniforms of the program that it compiled last.
  Object.assign(shader.uniforms, uniforms);
  if (shown === SHADED.three) return;
  const place = ['#include <lights_physical_fragment>', '#include <opaque_fragment>'].find((p) => shader.fragmentShader.includes(p));
  const isLit = place !== '#include <opaque_fragment>';
  const studio = isLit && shown === SHADED.studio ? STUDIO_GLSL + teachGlass(shader, material) : '';
  const declared = (shown === 8 ? CHECKER : '') + studio;
  if (shown === 8)
    shader.vertexShader = shader.vertexShader.replace('void main() {', 'varying vec2 pbUv;\nvoid main() {\n  pbUv = uv;');
  shader.fragmentShader = shader.fragmentShader
    .replace('void main() {', `${declared}\nvoid main() {`)
    .replace(place, `${chosen(shown, isLit)}\n${place}`);
}

/** What the program of glass depends on besides. */
function glassKey(material) {
  const own = taught.get(material);
  return own?.transmission > 0 ? `${own.blending.transparent} ${GLASS_MAPS.map(([name]) => material[name]?.channel ?? '-').join('')}` : '';
}

/** Teaches a material to show its channels. */
export function teach(material) {
  if (taught.has(material) || (!material.isMeshStandardMaterial && !material.isMeshBasicMaterial)) return;
  const { transmission = 0, transparent, depthWrite, blending, blendSrc, blendDst } = material;
  taught.set(material, { transmission, blending: { transparent, depthWrite, blending, blendSrc, blendDst } });
  if (transmission > 0) showGlass(material, taught.get(material));
  // Parallax maps come second: they change what is fetched, ours included.
  const { onBeforeCompile, customProgramCacheKey } = material;
  material.onBeforeCompile = function (shader, renderer) {
    patched(shader, this);
    onBeforeCompile.call(this, shader, renderer);
  };
  material.customProgramCacheKey = function () { return `parbake ${shown} ${glassKey(this)} ${customProgramCacheKey.call(this)}`; };
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
