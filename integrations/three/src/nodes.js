// The parallax of a material as nodes, for WebGPURenderer: MeshStandardNodeMaterial and MeshPhysicalNodeMaterial, whose textures
// are read where the shift leads. three.js asks the material's context where to read, and with which gradients; everything else
// goes on as it is.
import {
  MeshPhysicalNodeMaterial, MeshStandardNodeMaterial, NormalRGPacking, RED_GREEN_RGTC2_Format, RG11_EAC_Format, RGFormat, TangentSpaceNormalMap,
} from 'three/webgpu';
import {
  Fn, attribute, context, dFdx, dFdy, determinant, faceDirection, float, fwidth, mat3, materialReference,
  modelViewMatrix, normalFlat, normalMap, normalViewGeometry, output, positionView, positionViewDirection, sign, step, tangentLocal, texture, uniform, uv,
  vec2, vec3, vec4,
} from 'three/tsl';
import { coefficients, derivedFrame, fade, line, opacity, shift, vertexFrame } from './formulas_tsl.js';
import { BORDERS } from './maps.js';

/** A texture's coordinate, its own transform included. */
function coordinate(image) {
  const matrix = uniform(image.matrix).onObjectUpdate(() => {
    if (image.matrixAutoUpdate) image.updateMatrix();
    return image.matrix;
  });
  return matrix.mul(vec3(uv(image.channel), 1)).xy;
}

/** The frame of the surface, which is not turned over where it is seen from behind. */
function frameAt(material, at, { geometry, object }) {
  const isFlat = material.flatShading || !geometry.hasAttribute('normal');
  const normal = (isFlat ? normalFlat.mul(faceDirection) : normalViewGeometry).toVar();
  // three.js turns tangents of instances not at all, and those of batches the wrong way round.
  const isPlaced = object.isInstancedMesh || object.isBatchedMesh;
  if (isFlat || isPlaced || !geometry.hasAttribute('tangent')) return derivedFrame(normal, positionView, at);
  const tangent = modelViewMatrix.mul(vec4(tangentLocal, 0)).xyz.toVarying('vParallaxTangent');
  // A mirrored mesh turns cross products over.
  const side = attribute('tangent', 'vec4').w.mul(sign(determinant(mat3(modelViewMatrix)))).toVarying('vParallaxSide');
  return vertexFrame(normal, tangent, side);
}

/** How far coordinates move at a pixel, and, with a cutout, how much more than nothing is there. */
function seen(material, { uniforms, hasCutout, isFading }) {
  const value = (name) => uniforms[name].value;
  const at = coordinate(material.map ?? material.normalMap).toVar('parallaxAt');
  const sight = Fn((builder) => line(positionViewDirection, frameAt(material, at, builder)), 'vec3').once()().toVar('parallaxSight');
  const left = isFading ? fade(dFdx(at), dFdy(at), sight.z, value('parallaxFootprint')).toVar('parallaxLeft') : float(1);
  const read = (image, rows, scale, offset) => {
    const [factors, added] = [scale, offset].map((name) => value(name).map((vector) => uniform(vector)));
    return coefficients(value(image), at, uniform(value(rows)), factors, added);
  };
  const pairs = read('parallaxMap', 'parallaxRows', 'parallaxScale', 'parallaxOffset');
  const moved = left.mul(shift(pairs, sight, value('parallaxLimit'))).toVar('parallaxMoved');
  if (!hasCutout) return { moved, there: null };
  const twelve = read('parallaxCutoutMap', 'parallaxCutoutRows', 'parallaxCutoutScale', 'parallaxCutoutOffset');
  return { moved, there: left.mul(opacity(twelve, sight).sub(1)).add(1).toVar('parallaxThere') };
}

/** A shift of transformed coordinates as one of those before a texture's transform. */
function untransformed(node, moved) {
  const [origin, u, v] = [[0, 0], [1, 0], [0, 1]].map((corner) => node.getTransformedUV(vec2(...corner)));
  const [a, b] = [u.sub(origin), v.sub(origin)];
  const area = a.x.mul(b.y).sub(b.x.mul(a.y));
  return vec2(moved.x.mul(b.y).sub(moved.y.mul(b.x)), moved.y.mul(a.x).sub(moved.x.mul(a.y))).div(area);
}

/** Where the material's textures are read. Baked light has a layout of its own, and no depth. */
function shiftedReads(material, moved) {
  const slots = Object.keys(material).filter((slot) => slot !== 'lightMap' && material[slot]?.isTexture);
  const isOwn = ({ value }) => slots.some((slot) => material[slot] === value);
  return context({
    getUV: (node, { shaderStage }) => (shaderStage === 'fragment' && isOwn(node) ? node.getDefaultUV().add(untransformed(node, moved)) : null),
    // Those that it would have without the shift.
    getTextureGradient: (node, { shaderStage }) => (shaderStage === 'fragment' && isOwn(node) ? [dFdx(node.getDefaultUV()), dFdy(node.getDefaultUV())] : null),
  });
}

/** Formats that hold two numbers of a normal. */
const IN_TWO = [RGFormat, RED_GREEN_RGTC2_Format, RG11_EAC_Format];

/** three.js reads normals without the context. */
function shiftedNormal(image, scale, moved, type = TangentSpaceNormalMap) {
  const at = coordinate(image).toVar();
  const node = normalMap(texture(image, at.add(moved)).grad(dFdx(at), dFdy(at)), materialReference(scale, 'vec2'));
  node.normalMapType = type;
  if (IN_TWO.includes(image.format)) node.unpackNormalMode = NormalRGPacking;
  return node;
}

/** `material.parallax`: the switch, and what it switches. */
class Parallax {
  #isOn = true;
  /** Nodes that are set now. */
  #own = {};

  constructor(material, maps, fallback, coversSamples) {
    this.material = material;
    this.maps = maps;
    /** What other slots hold while the maps are off: the textures for viewers without them. */
    this.fallback = { ...fallback };
    /** Geometries that reach further with the maps than without (`reach.js`). */
    this.reaches = new Set();
    this.coversSamples = coversSamples;
    this.update();
  }

  get textures() { return [...this.maps.textures, ...Object.values(this.fallback).filter(Boolean)]; }

  get enabled() { return this.#isOn; }

  set enabled(isOn) {
    if (this.#isOn === isOn) return;
    this.#isOn = isOn;
    for (const [slot, image] of Object.entries(this.fallback)) {
      this.fallback[slot] = this.material[slot];
      this.material[slot] = image;
    }
    for (const reach of this.reaches) reach.show(isOn);
    this.update();
  }

  /** Takes these nodes from the material, or from a copy of it. */
  forget(copy) {
    for (const [slot, node] of Object.entries(this.#own)) if (copy[slot] === node) copy[slot] = null;
  }

  /** Makes the material's nodes. Needed where one of its textures was exchanged; the switch does so by itself. */
  update() {
    const { material } = this;
    this.forget(material);
    // Without a coordinate nothing shifts.
    this.#own = this.#isOn && (material.map || material.normalMap) ? this.#nodes() : {};
    Object.assign(material, this.#own);
    material.needsUpdate = true;
  }

  #nodes() {
    const { material, maps } = this, { moved, there } = seen(material, maps);
    const nodes = { contextNode: shiftedReads(material, moved) };
    if (material.normalMap) nodes.normalNode = shiftedNormal(material.normalMap, 'normalScale', moved, material.normalMapType);
    if (material.clearcoatNormalMap) nodes.clearcoatNormalNode = shiftedNormal(material.clearcoatNormalMap, 'clearcoatNormalScale', moved);
    if (!there) return nodes;
    const isThere = there.greaterThanEqual(0);
    if (!this.coversSamples) return { ...nodes, maskNode: isThere };
    // The width is bounded, for past the edge of a triangle it is any number.
    const smooth = there.div(fwidth(there).clamp(1e-6, 10)).add(0.5).clamp(0, 1);
    const coverage = Fn(({ renderer }) => (renderer.currentSamples > 0 ? smooth : step(0, there)), 'float').once()().toVar('parallaxCoverage');
    // What three.js would draw opaque is as opaque as it is covered, whatever the alpha of its map.
    const isOpaque = !(material.alphaTest > 0) && !material.alphaHash;
    const alpha = isOpaque ? materialReference('opacity', 'float') : output.a;
    return { ...nodes, maskNode: coverage.greaterThan(0), maskShadowNode: isThere, outputNode: vec4(output.rgb, alpha.mul(coverage)) };
  }
}

/** Gives a node material maps. */
function attach(own, maps, fallback, coversSamples) {
  const parallax = new Parallax(own, maps, fallback, coversSamples);
  own.parallax = parallax;
  own.clone = function () {
    const { enabled, fallback: other } = parallax, copy = new own.constructor().copy(own);
    // The copy's slots are those of the moment.
    const shown = Object.fromEntries(Object.keys(other).map((slot) => [slot, own[slot]]));
    parallax.forget(copy);
    if (!enabled) Object.assign(copy, other);
    attach(copy, maps, enabled ? other : shown, coversSamples);
    copy.parallax.enabled = enabled;
    parallax.reaches.forEach((reach) => copy.parallax.reaches.add(reach));
    return copy;
  };
  return own;
}

/**
 * A node material with parallax maps, which then are `material.parallax`, in the place of a lit material. Clones have the maps,
 * too.
 */
export function parallaxNodeMaterial(material, maps, { alphaToCoverage = true, fallback = {} } = {}) {
  const isPhysical = material.isMeshPhysicalMaterial || material.isMeshPhysicalNodeMaterial;
  if (!isPhysical && !material.isMeshStandardMaterial && !material.isMeshStandardNodeMaterial)
    throw new Error('Parallax maps are for MeshStandardMaterial, MeshPhysicalMaterial and their node materials.');
  const own = new (isPhysical ? MeshPhysicalNodeMaterial : MeshStandardNodeMaterial)().copy(material);
  const coversSamples = maps.hasCutout && alphaToCoverage && !own.transparent;
  if (coversSamples) Object.assign(own, { alphaToCoverage: true }, BORDERS);
  return attach(own, maps, fallback, coversSamples);
}
