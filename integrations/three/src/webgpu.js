// Parallax maps of PARBAKE_materials_parallax, version 2, for three.js' WebGPURenderer, on WebGPU and on WebGL. What users import
// as parbake-three-parallax/webgpu.
export { ParallaxNodePlugin } from './node_plugin.js';
export { parallaxNodeMaterial } from './nodes.js';
export { followSwitches } from './reach.js';
export { ParallaxMaps } from './maps.js';
export { parallaxMaterials, setParallax } from './switch.js';
export * as parallaxNodes from './formulas_tsl.js';
