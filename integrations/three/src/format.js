// The extension's JSON, version 2: read and checked. A map that breaks a rule is left out as a whole.

export const NAME = 'PARBAKE_materials_parallax';
const VERSION = 2;
/** The attribute of vertex offsets, as GLTFLoader names it. */
export const OFFSET = '_parallax_offset';
/** Layers of four channels in an image, one below the other. */
export const LAYERS = { shift: 2, cutout: 3 };

const isNumbers = (list, count) => Array.isArray(list) && list.length === count && list.every(Number.isFinite);
const isIndex = (info) => Number.isInteger(info?.index) && info.index >= 0;

function fault(json) {
  if (json.version !== VERSION) return `its version is ${json.version}, and this reads version ${VERSION}`;
  const { cutout, limit, fadeFootprint } = json;
  const parts = cutout === undefined ? [[json, LAYERS.shift]] : [[json, LAYERS.shift], [cutout, LAYERS.cutout]];
  for (const [part, layers] of parts) {
    if (!isIndex(part?.texture)) return 'a texture of it is missing';
    if (!isNumbers(part.scale, 4 * layers) || !isNumbers(part.offset, 4 * layers))
      return `it has not ${4 * layers} scales and offsets`;
  }
  if (limit !== undefined && !(limit > 0 && limit <= 1)) return `its limit is ${limit}`;
  if (fadeFootprint !== undefined && !(fadeFootprint > 0)) return `its fade begins at ${fadeFootprint}`;
  return null;
}

/** The map of a material of the document, or null; `warn` is told why one is left out. */
export function readParallax(material, warn) {
  const json = material.extensions?.[NAME];
  if (!json) return null;
  const reason = fault(json);
  if (reason) {
    warn(`the parallax map of material "${material.name ?? ''}" was left out: ${reason}`);
    return null;
  }
  const { texture, scale, offset, limit = 0.25, fadeFootprint = Infinity, cutout = null } = json;
  return { texture, scale, offset, limit, fadeFootprint, cutout };
}

/** The material as a viewer of the extension has it: with the textures that the extension brings for it. */
export function withOwnTextures(material) {
  const { baseColorTexture, normalTexture } = material.extensions[NAME];
  const own = { ...material };
  if (isIndex(baseColorTexture))
    own.pbrMetallicRoughness = { ...material.pbrMetallicRoughness, baseColorTexture };
  // The strength of the normals stays the material's.
  if (isIndex(normalTexture))
    own.normalTexture = { ...normalTexture, scale: material.normalTexture?.scale ?? 1 };
  return own;
}
