// Parallax maps of PARBAKE_materials_parallax, version 2, for three.js' WebGLRenderer. What users import.
export { ParallaxPlugin } from './loader.js';
export { ParallaxMaps, applyParallax, followOffsets, parallaxMaterials, setParallax } from './material.js';
export { addShadowMaterials, createDepthMaterial } from './depth.js';
export { FUNCTIONS as PARALLAX_GLSL } from './glsl.js';
