// What tests of the packages for both renderers of three.js have in common: models, and numbers of the format.
import { parallaxModel } from './parallax_model.mjs';

export const MODELS = {
  ball: {},
  'no offsets': { reach: 0 },
  'no tangents': { change: (json) => { delete json.meshes[0].primitives[0].attributes.TANGENT; } },
  'no normals': { change: (json) => { for (const key of ['NORMAL', 'TANGENT']) delete json.meshes[0].primitives[0].attributes[key]; } },
  'no normal map': { change: (json) => { delete json.materials[0].normalTexture; } },
  'no normal map, no offsets': { reach: 0, change: (json) => { delete json.materials[0].normalTexture; } },
  'no colour map': { change: (json) => { delete json.materials[0].pbrMetallicRoughness.baseColorTexture; } },
  'alpha test': { change: (json) => { json.materials[0].alphaMode = 'MASK'; } },
  'vertex alpha': { change: (json) => { json.meshes[0].primitives[0].attributes.COLOR_0 = json.meshes[0].primitives[0].attributes.TANGENT; } },
  'blended': { change: (json) => { json.materials[0].alphaMode = 'BLEND'; } },
  'clearcoat': { change: (json) => {
    const texture = { index: 4 };
    json.extensionsUsed.push('KHR_materials_clearcoat');
    json.materials[0].extensions.KHR_materials_clearcoat = { clearcoatFactor: 1, clearcoatTexture: texture, clearcoatNormalTexture: texture };
  } },
  'no cutout': { change: (_, map) => { delete map.cutout; } },
  'fades': { change: (_, map) => { map.fadeFootprint = 0.01; } },
  'faded': { reach: 0, change: (_, map) => { map.fadeFootprint = 1e-6; } },
  'own textures': { change: (json, map) => { Object.assign(map, { baseColorTexture: { index: 4 }, normalTexture: { index: 4 } }); } },
  'next version': { change: (_, map) => { map.version = 3; } },
  'too few numbers': { change: (_, map) => { map.scale.pop(); } },
  'no image': { change: (json) => { json.bufferViews[json.images[2].bufferView] = { buffer: 0, byteOffset: 0, byteLength: 16 }; } },
};

/** A model by its name, or nothing. */
export const modelOf = (name) => MODELS[name] && parallaxModel(MODELS[name]);

/** A line of sight, and along it the twelve functions of a cutout, the four of a shift, and a shift below its limit. */
export const NUMBERS_AT = [0.48, -0.6, 0.64];
export const NUMBERS = [
  1, 0.484974, -0.855072, -0.966018, 0.831384, -1.03923, 0.904181, -1.130226, -0.250969, -1.115419, -0.852992, -0.415653,
  0.48, -0.6, 0.3072, -0.384, 0.48 / 0.25,
];
