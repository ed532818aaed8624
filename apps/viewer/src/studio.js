// The built-in light of `parbake eval` and of its reports, so that pictures and decibels here are those there:
// crates/render/src/lighting.rs (soft lamps as spherical Gaussians), split_sum.rs, metallic_roughness.rs and
// material_layers.rs, which have the formulas and their sources. Directions are in the common frame: +Y up, +Z to the front.
import { DataTexture, FloatType, NearestFilter, RGFormat, Vector3 } from './vendor.js';

const NODES = 32, SAMPLES = 512;

const unit = (x, y, z) => new Vector3(x, y, z).normalize();
const SOFT = [
  [unit(0, 1, 0), 2, new Vector3(0.42, 0.44, 0.48)],
  [unit(0, -1, 0), 2.5, new Vector3(0.14, 0.12, 0.1)],
  [unit(0.6, 0.7, 0.5), 24, new Vector3(4.6, 4.4, 4.1)],
  [unit(-0.9, 0.25, 0.35), 16, new Vector3(1.2, 1.35, 1.6)],
  [unit(-0.3, 0.45, -0.85), 30, new Vector3(3.4, 3.4, 3.6)],
  [unit(0.95, 0.05, -0.3), 60, new Vector3(4.2, 3.8, 3.2)],
];

function reversed(i) {
  let bits = 0;
  for (let k = 0; k < 32; k++) bits = (bits * 2 + ((i >>> k) & 1)) >>> 0;
  return bits / 4294967296;
}

/** Scale and bias of F₀ at a cosine and a roughness. */
function integral(c, roughness) {
  const cosine = Math.max(c, 1e-3), alpha = Math.max(roughness, 0.02) ** 2, square = alpha * alpha;
  const across = Math.sqrt(Math.max(0, 1 - cosine * cosine));
  let scale = 0, bias = 0;
  for (let i = 0; i < SAMPLES; i++) {
    const share = SHARES[i], up = Math.sqrt((1 - share) / (1 + (square - 1) * share));
    const vh = across * Math.sqrt(Math.max(0, 1 - up * up)) * COSINES[i] + cosine * up;
    const nl = 2 * vh * up - cosine;
    if (nl <= 0 || vh <= 0) continue;
    const masked = (a, b) => a * Math.sqrt(b * b * (1 - square) + square);
    const weight = (0.5 / (masked(nl, cosine) + masked(cosine, nl))) * nl * 4 * vh / up;
    const grazing = (1 - vh) ** 5;
    scale += (1 - grazing) * weight;
    bias += grazing * weight;
  }
  return [scale / SAMPLES, bias / SAMPLES];
}
const SHARES = Float64Array.from({ length: SAMPLES }, (_, i) => reversed(i));
const COSINES = Float64Array.from({ length: SAMPLES }, (_, i) => Math.cos((2 * Math.PI * (i + 0.5)) / SAMPLES));

let table = null;

/** The table of the split sum, made when it is first needed. */
export function splitSum() {
  if (table) return table;
  const data = new Float32Array(2 * NODES * NODES);
  for (let i = 0; i < NODES * NODES; i++)
    data.set(integral((i % NODES) / (NODES - 1), Math.floor(i / NODES) / (NODES - 1)), 2 * i);
  table = new DataTexture(data, NODES, NODES, RGFormat, FloatType);
  table.magFilter = table.minFilter = NearestFilter;
  table.needsUpdate = true;
  return table;
}

/** Uniforms of the lamps. */
export const studioUniforms = {
  pbAxis: { value: SOFT.map((lamp) => lamp[0]) },
  pbSharpness: { value: SOFT.map((lamp) => lamp[1]) },
  pbLamp: { value: SOFT.map((lamp) => lamp[2]) },
};

export const STUDIO_GLSL = /* glsl */ `
uniform vec3 pbAxis[${SOFT.length}];
uniform float pbSharpness[${SOFT.length}];
uniform vec3 pbLamp[${SOFT.length}];
uniform highp sampler2D pbSplitSum;
uniform mat3 pbTurn;
uniform float pbUnit;
const vec3 PB_AMBIENT = vec3(0.16, 0.165, 0.175);
const vec3 PB_SUN = vec3(0.95, 0.92, 0.86);
const vec3 PB_SUN_FROM = vec3(-0.2952407, 0.7873085, 0.5412746);

float pbIntegral(float sharpness) { return (1.0 - exp(-2.0 * sharpness)) * 6.28318531 / sharpness; }
float pbDiffuse(float lambda, float cosine) {
  float once = exp(-lambda), twice = exp(-2.0 * lambda);
  float scale = 1.0 + 2.0 * twice - 1.0 / lambda;
  float bias = (once - twice) / lambda - twice;
  float x = sqrt(max(1.0 - scale, 1e-6));
  float x0 = 0.36 * cosine, x1 = x / (4.0 * 0.36);
  float lit = abs(x0) <= x1 ? (x0 + x1) * (x0 + x1) / x : clamp(cosine, 0.0, 1.0);
  return max(lit * scale + bias, 0.0) * pbIntegral(lambda) / 3.14159265;
}
float pbSmoothed(float own, float cosine, float lobe) {
  float sharpness = lobe * own / (lobe + own);
  return exp(sharpness * (cosine - 1.0)) * pbIntegral(own) / pbIntegral(sharpness);
}
vec2 pbScaleAndBias(float cosine, float roughness) {
  vec2 place = clamp(vec2(cosine, roughness), 0.0, 1.0) * ${NODES - 1}.0;
  ivec2 node = min(ivec2(place), ivec2(${NODES - 2}));
  vec2 at = place - vec2(node);
  vec2 a = mix(texelFetch(pbSplitSum, node, 0).rg, texelFetch(pbSplitSum, node + ivec2(1, 0), 0).rg, at.x);
  vec2 b = mix(texelFetch(pbSplitSum, node + ivec2(0, 1), 0).rg, texelFetch(pbSplitSum, node + ivec2(1, 1), 0).rg, at.x);
  return mix(a, b, at.y);
}
vec3 pbShare(vec3 f0, float f90, float roughness, float grazing, vec2 table) {
  float lost = 1.0 - table.x - table.y;
  vec3 most = max(vec3((1.0 - roughness) * f90), f0);
  vec3 once = (f0 + (most - f0) * grazing) * table.x + table.y * f90;
  vec3 mean = f0 + (1.0 - f0) / 21.0;
  return once + lost * once * mean / (1.0 - mean * lost);
}
float pbFifth(float x) { float square = x * x; return square * square * x; }
vec3 pbIrradiance(vec3 normal) {
  vec3 light = PB_AMBIENT;
  for (int i = 0; i < ${SOFT.length}; i++) light += pbLamp[i] * pbDiffuse(pbSharpness[i], dot(pbTurn * pbAxis[i], normal));
  return light;
}
vec3 pbReflected(vec3 mirrored, float alpha) {
  vec3 light = PB_AMBIENT;
  float lobe = 0.5 / (alpha * alpha);
  for (int i = 0; i < ${SOFT.length}; i++)
    light += pbLamp[i] * pbSmoothed(pbSharpness[i], dot(pbTurn * pbAxis[i], mirrored), lobe);
  return light;
}
// The cosine to the lamp far away, and D V of GGX; 0 where the surface is turned away. schlick is Schlick's fifth power.
vec2 pbSun(vec3 normal, vec3 viewer, float cosine, float alpha, out float schlick) {
  vec3 sun = pbTurn * PB_SUN_FROM, sum = sun + viewer;
  float nl = dot(normal, sun);
  schlick = 0.0;
  if (nl <= 0.0 || dot(sum, sum) < 1e-8) return vec2(0.0);
  vec3 h = normalize(sum), across = cross(normal, h);
  float nh = dot(normal, h), width = alpha * alpha;
  float spread = dot(across, across) + width * nh * nh;
  float masks = nl * sqrt(cosine * cosine * (1.0 - width) + width) + cosine * sqrt(nl * nl * (1.0 - width) + width);
  schlick = pbFifth(max(1.0 - dot(viewer, h), 0.0));
  return vec2(nl, width / (3.14159265 * spread * spread) * 0.5 / masks);
}
// Without layers; the share that a dielectric reflects is left in reflects, and scatters is the rest that does not pass.
vec3 pbBase(vec3 color, float metallic, float rough, float occlusion, vec3 emission, vec3 normal, vec3 viewer,
    vec3 f0, float f90, float scatters, out vec3 reflects) {
  float roughness = clamp(rough, 0.0525, 1.0), alpha = roughness * roughness;
  float towards = dot(normal, viewer), cosine = clamp(towards, 1e-4, 1.0);
  vec3 reflected = pbReflected(2.0 * towards * normal - viewer, alpha);
  vec2 table = pbScaleAndBias(cosine, roughness);
  float grazing = pbFifth(1.0 - cosine), schlick;
  reflects = pbShare(f0, f90, roughness, grazing, table);
  vec3 dielectric = mix(pbIrradiance(normal) * color * scatters, reflected, reflects);
  vec3 metal = reflected * pbShare(color, 1.0, roughness, grazing, table);
  vec3 light = mix(dielectric, metal, metallic) * occlusion + emission;
  vec2 sun = pbSun(normal, viewer, cosine, alpha, schlick);
  vec3 below = mix(color * scatters / 3.14159265, vec3(sun.y), f0 + (f90 - f0) * schlick);
  return light + mix(below, sun.y * (color + (1.0 - color) * schlick), metallic) * PB_SUN * sun.x;
}
// What a sheen adds, and in the fourth number what multiplies all that is below it.
vec4 pbSheen(vec3 color, float rough, float occlusion, vec3 normal, vec3 viewer) {
  float r = clamp(rough, 0.07, 1.0), rr = r * r, cosine = clamp(dot(normal, viewer), 1e-4, 1.0);
  float inverse = 1.0 / (r + 0.1);
  float slope = -1.9362 + 1.0678 * r + 0.4573 * rr - 0.8469 * inverse;
  float start = -0.6014 + 0.5538 * r - 0.4670 * rr - 0.1255 * inverse;
  float albedo = min(exp(slope * cosine + start), 1.0);
  vec3 light = pbIrradiance(normal) * albedo * occlusion, sun = pbTurn * PB_SUN_FROM, sum = sun + viewer;
  float nl = dot(normal, sun);
  if (nl > 0.0 && dot(sum, sum) >= 1e-8) {
    float sine = min(length(cross(normal, normalize(sum))), 1.0);
    float distribution = (2.0 + 1.0 / rr) * pow(sine, 1.0 / rr) / 6.28318531;
    light += PB_SUN * (distribution / (4.0 * (nl + cosine - nl * cosine)) * nl);
  }
  return vec4(light * color, 1.0 - max(color.r, max(color.g, color.b)) * albedo);
}
// The same of a coat.
vec4 pbCoat(float strength, float rough, float occlusion, vec3 normal, vec3 viewer) {
  float roughness = clamp(rough, 0.0525, 1.0), alpha = roughness * roughness;
  float towards = dot(normal, viewer), cosine = clamp(towards, 1e-4, 1.0), schlick;
  vec2 table = pbScaleAndBias(cosine, roughness), sun = pbSun(normal, viewer, cosine, alpha, schlick);
  vec3 light = pbReflected(2.0 * towards * normal - viewer, alpha) * (0.04 * table.x + table.y) * occlusion;
  light += PB_SUN * (sun.x * sun.y * (0.04 + 0.96 * schlick));
  return vec4(light * strength, 1.0 - strength * (0.04 + 0.96 * pbFifth(1.0 - cosine)));
}
`;
