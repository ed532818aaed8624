// Parallax maps of PARBAKE_materials_parallax, version 2, for three.js' WebGLRenderer. What users import; for WebGPURenderer
// it is webgpu.js.
export { ParallaxPlugin } from './plugin.js';
export { applyParallax, followOffsets } from './material.js';
export { ParallaxMaps } from './maps.js';
export { parallaxMaterials, setParallax } from './switch.js';
export { addShadowMaterials, createDepthMaterial } from './depth.js';
export { FUNCTIONS as PARALLAX_GLSL } from './glsl.js';
