// Levels of detail of a lods.json that Parbake has written, for three.js.
//
//     import { loadLods } from './parbake_lods.js';
//     scene.add(await loadLods('models/@NAME@/lods.json', { camera }));

import { LOD } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

/**
 * Loads all levels into a THREE.LOD, which switches by the distance to the camera.
 * @param {string} url of lods.json; the levels lie beside it
 * @param {object} options
 * @param {import('three').PerspectiveCamera} [options.camera] whose vertical field of view says at which distance the
 *   model has which size; 50 degrees without one
 * @param {GLTFLoader} [options.loader] with decoders, if files need some
 * @param {number} [options.hysteresis] share of a distance within which levels do not switch back
 * @returns {Promise<LOD>}
 */
export async function loadLods(url, { camera, loader = new GLTFLoader(), hysteresis = 0.05 } = {}) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  const chain = await response.json();
  const base = new URL('.', new URL(url, document.baseURI));
  const scenes = await Promise.all(
    chain.levels.map(async (level) => (await loader.loadAsync(new URL(level.file, base).href)).scene));
  const slope = 2 * Math.tan(((camera?.fov ?? 50) * Math.PI) / 360);
  const lod = new LOD();
  lod.name = chain.name;
  let distance = 0;
  scenes.forEach((scene, index) => {
    lod.addLevel(scene, distance, hysteresis);
    distance = chain.longest_side / (chain.levels[index].min_coverage * slope);
  });
  return lod;
}
