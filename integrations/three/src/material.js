// The parallax of a material: MeshStandardMaterial and MeshPhysicalMaterial stay three.js' own; their shaders get the
// format's formulas before they are compiled. Everything else of three.js goes on as it is.
import { OFFSET } from './format.js';
import { SIDE } from './glsl.js';
import { BORDERS } from './maps.js';
import { defines, patchFragment, patchVertex } from './patch.js';

/** `material.parallax`: the switch, and what it switches. */
class Parallax {
  #isOn = true;

  constructor(material, maps, fallback) {
    this.material = material;
    this.maps = maps;
    /** What other slots hold while the maps are off: the textures for viewers without them. */
    this.fallback = { ...fallback };
    /** Materials of depth passes, which follow the switch. */
    this.followers = new Set();
    /** Whether the geometry has tangents, where three.js itself does not want to know. */
    this.hasTangents = false;
    /** Whether the geometry has offsets. */
    this.hasOffsets = false;
    /** Whether maps are to be filtered along the longer side of a pixel's footprint. */
    this.isAnisotropic = isAnisotropic(material);
  }

  get textures() { return [...this.maps.textures, ...Object.values(this.fallback).filter(Boolean)]; }

  get enabled() { return this.#isOn; }

  set enabled(isOn) {
    if (this.#isOn === isOn) return;
    this.#isOn = isOn;
    for (const [slot, texture] of Object.entries(this.fallback)) {
      this.fallback[slot] = this.material[slot];
      this.material[slot] = texture;
    }
    for (const follower of this.followers) follower.map = this.material.map;
    for (const material of [this.material, ...this.followers]) material.needsUpdate = true;
  }

  /** Whether there is anything to do: without a coordinate nothing shifts. */
  get isActive() { return this.#isOn && Boolean(this.material.map || this.material.normalMap); }
}

const isAnisotropic = ({ map, normalMap }) => map?.anisotropy > 1 || normalMap?.anisotropy > 1;

/** Whether three.js tells shaders of the geometry's tangents. */
const usesTangents = (material) => Boolean(material.normalMap || material.anisotropy > 0);

function patch(shader, { material, maps, hasTangents, hasOffsets, isAnisotropic: isStretched }) {
  const isOwn = !usesTangents(material) && hasTangents;
  const isFlat = material.flatShading, hasFrame = !isFlat && (shader.vertexTangents || isOwn);
  const names = [
    'PARALLAX_SHIFT', maps.hasCutout && 'PARALLAX_CUTOUT', maps.isFading && 'PARALLAX_FADE', isFlat && 'PARALLAX_FLAT',
    isStretched && 'PARALLAX_ANISOTROPIC', hasOffsets && 'PARALLAX_OFFSET',
    hasFrame && 'PARALLAX_TANGENT', isOwn && !isFlat && 'USE_TANGENT',
  ].filter(Boolean);
  const macros = `${defines(names)}#define PARALLAX_UV ${material.map ? 'vMapUv' : 'vNormalMapUv'}\n`
    + '#define PARALLAX_IS_ORTHOGRAPHIC isOrthographic\n';
  shader.vertexShader = defines(names) + patchVertex(shader.vertexShader)
    .replace('void main() {', `${isOwn ? 'attribute vec4 tangent;\n' : ''}#ifdef PARALLAX_TANGENT\nvarying float vParallaxSide;\n#endif\nvoid main() {`)
    .replace('#include <normal_vertex>', `#include <normal_vertex>\n${SIDE}`);
  let fragment = shader.fragmentShader;
  if (maps.hasCutout) {
    // What three.js would draw opaque is as opaque as it is covered, whatever the alpha of its map.
    const isOpaque = !material.transparent && !(material.alphaTest > 0) && !material.alphaHash;
    fragment = fragment.replace('#include <map_fragment>', 'float parallaxClipped = diffuseColor.a;\n#include <map_fragment>')
      .replace('#include <alphahash_fragment>', `#include <alphahash_fragment>\n#ifdef ALPHA_TO_COVERAGE\n${isOpaque
        ? 'diffuseColor.a = parallaxClipped * parallaxCoverage;' : 'diffuseColor.a *= parallaxCoverage;'}\n#endif`);
  }
  shader.fragmentShader = patchFragment(fragment, macros, true);
}

const multisampled = new WeakMap();

/** Whether what is drawn into now has several samples a pixel. */
function isMultisampled(renderer) {
  const target = renderer.getRenderTarget();
  if (target) return target.samples > 0;
  if (!multisampled.has(renderer)) multisampled.set(renderer, renderer.getContext().getContextAttributes().antialias);
  return multisampled.get(renderer);
}

/**
 * Gives a material parallax maps, which then are `material.parallax`. Calls of its onBeforeCompile and
 * customProgramCacheKey that were there before go first. Clones have the maps, too.
 */
export function applyParallax(material, maps, { alphaToCoverage = true, fallback = {} } = {}) {
  if (!material.isMeshStandardMaterial) throw new Error('Parallax maps are for MeshStandardMaterial and MeshPhysicalMaterial.');
  const parallax = new Parallax(material, maps, fallback);
  const { onBeforeCompile, customProgramCacheKey, onBeforeRender, clone } = material;
  const hasOwnKey = Object.hasOwn(material, 'customProgramCacheKey');
  material.parallax = parallax;
  material.onBeforeCompile = function (shader, renderer) {
    onBeforeCompile.call(this, shader, renderer);
    // Also where they are switched off: three.js keeps the uniforms of the program that it compiled last.
    Object.assign(shader.uniforms, maps.uniforms);
    if (parallax.isActive) patch(shader, parallax);
  };
  material.customProgramCacheKey = function () {
    const before = hasOwnKey ? customProgramCacheKey.call(this) : onBeforeCompile.toString();
    if (!parallax.isActive) return before;
    const isOpaque = !this.transparent && !(this.alphaTest > 0) && !this.alphaHash;
    const own = [Boolean(this.map), parallax.hasTangents, parallax.hasOffsets, parallax.isAnisotropic, maps.hasCutout, maps.isFading, isOpaque].map(Number).join('');
    return `${before} parallax ${own}`;
  };
  material.onBeforeRender = function (renderer, scene, camera, geometry, ...rest) {
    onBeforeRender.call(this, renderer, scene, camera, geometry, ...rest);
    if (maps.hasCutout) maps.uniforms.parallaxIsMultisampled.value = isMultisampled(renderer);
    // None of these is told to three.js' own programs.
    const now = {
      hasTangents: Boolean(geometry.attributes.tangent) && !usesTangents(this), isAnisotropic: isAnisotropic(this),
      hasOffsets: Boolean(geometry.attributes[OFFSET]),
    };
    if (Object.entries(now).every(([name, value]) => parallax[name] === value)) return;
    Object.assign(parallax, now);
    this.needsUpdate = true;
  };
  material.clone = function () {
    const copy = clone.call(this);
    if (!copy.parallax) {
      // The copy's slots are those of the moment.
      const own = parallax.enabled ? parallax.fallback : Object.fromEntries(Object.keys(parallax.fallback).map((slot) => [slot, material[slot]]));
      if (!parallax.enabled) Object.assign(copy, parallax.fallback);
      applyParallax(copy, maps, { alphaToCoverage: false, fallback: own });
    }
    copy.parallax.enabled = parallax.enabled;
    return copy;
  };
  if (maps.hasCutout && alphaToCoverage && !material.transparent) {
    material.alphaToCoverage = true;
    Object.assign(material, BORDERS);
  }
  return material;
}

/**
 * Lets another material of the same geometries, such as one that draws their edges, stand where maps are shown. The function
 * that comes back switches that.
 */
export function followOffsets(material) {
  const { onBeforeCompile, customProgramCacheKey } = material;
  let isOn = true;
  material.onBeforeCompile = function (shader, renderer) {
    onBeforeCompile.call(this, shader, renderer);
    // Of a geometry without offsets the attribute is 0.
    if (isOn) shader.vertexShader = defines(['PARALLAX_OFFSET']) + patchVertex(shader.vertexShader);
  };
  material.customProgramCacheKey = function () { return `${customProgramCacheKey.call(this)} offsets ${isOn}`; };
  return (on) => {
    if (on === isOn) return;
    isOn = on;
    material.needsUpdate = true;
  };
}
