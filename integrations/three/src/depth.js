// Depth passes of what is cut out: shadow maps, and prepasses with the camera's own depth. They discard what the line
// of sight misses, towards the light or the camera that draws them.
import { MeshDepthMaterial, MeshDistanceMaterial, ShaderChunk } from 'three';
import { OFFSET } from './format.js';
import { SIDE } from './glsl.js';
import { defines, patchFragment, patchVertex } from './patch.js';

// Shadow passes leave normalMatrix as the camera's, but not modelViewMatrix.
const NORMALS = ['beginnormal_vertex', 'morphnormal_vertex', 'skinnormal_vertex', 'defaultnormal_vertex', 'normal_vertex']
  .map((name) => ShaderChunk[name].replaceAll('normalMatrix', 'transpose( inverse( mat3( modelViewMatrix ) ) )')).join('\n');
/** In both shaders of depth: normals, but for displacement alone. */
const DISPLACED = /#ifdef USE_DISPLACEMENTMAP\s+(?:#include <\w+>\s+)+#endif/;

const isOpaque = (material) => !(material.alphaTest > 0) && !material.alphaHash;

function patch(shader, source, { hasTangents, hasNormals, hasOffsets }) {
  const { maps } = source.parallax, anchor = source.map ?? source.normalMap, isShifted = !isOpaque(source);
  const hasFrame = hasNormals && hasTangents;
  const names = [
    'PARALLAX_CUTOUT', isShifted && 'PARALLAX_SHIFT', maps.isFading && 'PARALLAX_FADE', !hasNormals && 'PARALLAX_FLAT',
    hasFrame && 'PARALLAX_TANGENT', hasFrame && 'USE_TANGENT', hasOffsets && 'PARALLAX_OFFSET',
  ].filter(Boolean);
  const set = `uv${anchor.channel || ''}`;
  // With a map three.js brings the coordinate.
  const macros = defines(names) + (source.map ? '#define PARALLAX_UV vMapUv\n' : '#define PARALLAX_UV vParallaxUv\n')
    + '#define PARALLAX_IS_ORTHOGRAPHIC ( vParallaxIsPerspective < 0.5 )\n';
  const varyings = `varying vec3 vViewPosition;\nvarying float vParallaxIsPerspective;\n${source.map ? '' : 'varying vec2 vParallaxUv;\n'}`;
  const normals = hasNormals ? NORMALS : '';
  shader.vertexShader = macros + patchVertex(shader.vertexShader)
    .replace('#include <common>', `#include <common>
      ${varyings}
      ${hasNormals ? ShaderChunk.normal_pars_vertex : ''}
      ${hasFrame ? 'attribute vec4 tangent;\nvarying float vParallaxSide;' : ''}
      ${source.map ? '' : `uniform mat3 parallaxTransform;\n${anchor.channel ? `attribute vec2 ${set};` : ''}`}`)
    .replace(DISPLACED, `${normals}\n${SIDE}`)
    .replace('#include <project_vertex>', `#include <project_vertex>
      vViewPosition = - mvPosition.xyz;
      vParallaxIsPerspective = isPerspectiveMatrix( projectionMatrix ) ? 1.0 : 0.0;
      ${source.map ? '' : `vParallaxUv = ( parallaxTransform * vec3( ${set}, 1 ) ).xy;`}`);
  let fragment = patchFragment(shader.fragmentShader, macros, isShifted).replace('#include <common>', `#include <common>
      ${varyings}
      ${hasNormals ? ShaderChunk.normal_pars_fragment : ''}`);
  // Coverage of the colour pass makes three.js test alpha here, which what is opaque has no use for.
  if (!isShifted) fragment = fragment.replace('#include <map_fragment>', '').replace('#include <alphatest_fragment>', '');
  shader.fragmentShader = fragment;
}

/**
 * A material for depth passes of a geometry with this material, which has parallax maps with a cutout. With
 * `isDistance` it is for the shadows of point lights.
 */
export function createDepthMaterial(source, geometry, { isDistance = false } = {}) {
  const depth = isDistance ? new MeshDistanceMaterial() : new MeshDepthMaterial();
  const { attributes } = geometry;
  const has = {
    hasTangents: Boolean(attributes.tangent), hasNormals: Boolean(attributes.normal), hasOffsets: Boolean(attributes[OFFSET]),
  };
  Object.assign(depth, { map: source.map, alphaMap: source.alphaMap, alphaTest: source.alphaTest, side: source.side });
  depth.onBeforeCompile = (shader) => {
    const { parallax, map, normalMap } = source;
    // As in material.js, always.
    Object.assign(shader.uniforms, parallax.maps.uniforms, { parallaxTransform: { value: (map ?? normalMap)?.matrix } });
    if (parallax.isActive) patch(shader, source, has);
  };
  depth.customProgramCacheKey = () => {
    const { parallax } = source, anchor = source.map ?? source.normalMap;
    if (!parallax.isActive) return '';
    const flags = [has.hasTangents, has.hasNormals, has.hasOffsets, parallax.maps.isFading, isOpaque(source), Boolean(source.map)].map(Number);
    return `parallax depth ${flags.join('')} ${anchor.channel}`;
  };
  source.parallax.followers.add(depth);
  return depth;
}

/** Gives meshes below an object, whose materials are cut out, materials for the shadows of all lights. */
export function addShadowMaterials(root) {
  const made = new Map();
  root.traverse((object) => {
    const { material, geometry } = object;
    if (!object.isMesh || !material?.parallax?.maps.hasCutout || object.customDepthMaterial) return;
    const key = [material.uuid, ...['tangent', 'normal', OFFSET].map((name) => geometry.attributes[name] !== undefined)].join(' ');
    if (!made.has(key))
      made.set(key, [false, true].map((isDistance) => createDepthMaterial(material, geometry, { isDistance })));
    [object.customDepthMaterial, object.customDistanceMaterial] = made.get(key);
  });
}
