// The page that headless Chromium opens. Shows an original and its candidates from the same
// viewpoints with three.js and measures how much their pictures differ.
//
// Conventions, the same for every model:
//   placement   the transform that centres the original's box and makes its longest side 2 is
//               applied to the original and to all candidates
//   cameras     a Fibonacci sphere (+y up) of radius 3.5 about the origin, 43.6 degrees of view
//   pictures    sRGB-encoded, no tone mapping, 2 × 2 samples a pixel averaged as they are encoded
//   PSNR        −10 log10 of the mean square over all pixels and channels; the mean over the views
// Skinned models stand in their bind pose and lights inside models are switched off.

import * as THREE from 'three';
import { DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { KTX2Loader } from 'three/examples/jsm/loaders/KTX2Loader.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { MTLLoader } from 'three/examples/jsm/loaders/MTLLoader.js';
import { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';
import { LIGHTS } from './lights.js';

const SAMPLES = 2;
const FIELD_OF_VIEW = 43.602818;
const DISTANCE = 3.5;
const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));
// A difference of zero would be infinitely good; this is 100 dB.
const LEAST_ERROR = 1e-10;

const renderer = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
renderer.outputColorSpace = THREE.SRGBColorSpace;
renderer.toneMapping = THREE.NoToneMapping;
renderer.setPixelRatio(1);

const gltfLoader = new GLTFLoader();
gltfLoader.setDRACOLoader(new DRACOLoader().setDecoderPath('/three/draco/'));
gltfLoader.setKTX2Loader(new KTX2Loader().setTranscoderPath('/three/basis/').detectSupport(renderer));
gltfLoader.setMeshoptDecoder(MeshoptDecoder);

/** Tabs separate words in OBJ and MTL as spaces do, but not for three.js. */
const withSpaces = (text) => text.replaceAll('\t', ' ');

/** The materials of an OBJ's library, once their textures have arrived. None if the file is missing. */
async function objMaterials(folder, library) {
  const manager = new THREE.LoadingManager();
  const url = folder + library.split('/').map(encodeURIComponent).join('/');
  const file = await fetch(url);
  if (!file.ok) return null;
  const materials = new MTLLoader(manager).parse(withSpaces(await file.text()), folder);
  await new Promise((done) => {
    manager.onLoad = done;
    // Without an item of its own the manager would never call for a library without textures.
    manager.itemStart('materials');
    materials.preload();
    manager.itemEnd('materials');
  });
  return materials;
}

/** An OBJ as a rough dielectric, which is what its Lambert materials come closest to in glTF. */
async function loadObj(url) {
  const folder = url.slice(0, url.lastIndexOf('/') + 1);
  const text = withSpaces(await (await fetch(url)).text());
  const loader = new OBJLoader();
  const library = /^[ \t]*mtllib[ \t]+(.+?)[ \t]*\r?$/m.exec(text)?.[1];
  const materials = library && (await objMaterials(folder, library));
  if (materials) loader.setMaterials(materials);
  const model = loader.parse(text);
  const convert = ({ color, map, vertexColors }) =>
    new THREE.MeshStandardMaterial({ color, map, vertexColors, roughness: 1, metalness: 0 });
  model.traverse((part) => {
    if (part.isMesh) part.material = Array.isArray(part.material) ? part.material.map(convert) : convert(part.material);
  });
  return model;
}

/** The model at a URL as three.js sees it: .glb, .gltf or .obj. */
async function load(url) {
  return /\.obj$/i.test(url) ? loadObj(url) : (await gltfLoader.loadAsync(url)).scene;
}

/** What a model costs the viewer: triangles, draw calls, textures and their texels. */
function cost(model) {
  const textures = new Set();
  let triangles = 0;
  let drawCalls = 0;
  model.traverse((part) => {
    if (!part.isMesh) return;
    const { index, attributes } = part.geometry;
    const instances = part.isInstancedMesh ? part.count : 1;
    triangles += (instances * (index ? index.count : attributes.position.count)) / 3;
    const materials = Array.isArray(part.material) ? part.material : [part.material];
    drawCalls += Math.max(1, Array.isArray(part.material) ? part.geometry.groups.length : 1);
    for (const material of materials) {
      for (const value of Object.values(material)) {
        if (value?.isTexture && value.image) textures.add(value.source);
      }
    }
  });
  let texels = 0;
  for (const { data } of textures) texels += (data.width ?? 0) * (data.height ?? 0);
  return { triangles, drawCalls, textures: textures.size, texels };
}

/** Scale and position that bring the box of `model` to the origin with a longest side of 2. */
function placementOf(model) {
  model.updateMatrixWorld(true);
  const box = new THREE.Box3().setFromObject(model, true);
  const size = box.getSize(new THREE.Vector3());
  const longest = Math.max(size.x, size.y, size.z);
  if (!(longest > 0)) throw new Error('the model shows nothing');
  const scale = 2 / longest;
  return { scale, position: box.getCenter(new THREE.Vector3()).multiplyScalar(-scale) };
}

function sceneOf(model, { scale, position }, light) {
  model.traverse((part) => {
    if (part.isLight) part.visible = false;
  });
  const placed = new THREE.Group();
  placed.scale.setScalar(scale);
  placed.position.copy(position);
  placed.add(model);
  const scene = new THREE.Scene();
  scene.add(placed);
  LIGHTS[light](renderer, scene);
  return scene;
}

function cameraAt(view, views) {
  const camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 50);
  const height = 1 - (2 * view + 1) / views;
  const radius = Math.sqrt(1 - height * height);
  const angle = view * GOLDEN_ANGLE;
  camera.position.set(radius * Math.cos(angle), height, radius * Math.sin(angle)).multiplyScalar(DISTANCE);
  camera.lookAt(0, 0, 0);
  camera.updateMatrixWorld();
  return camera;
}

/** One picture: `size` × `size` pixels of three channels in [0, 255], bottom row first. */
function picture(scene, camera, size) {
  const side = size * SAMPLES;
  renderer.render(scene, camera);
  const gl = renderer.getContext();
  const samples = new Uint8Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, samples);
  const pixels = new Float32Array(3 * size * size);
  for (let row = 0; row < side; row += 1) {
    const target = Math.floor(row / SAMPLES) * size;
    for (let column = 0; column < side; column += 1) {
      const from = 4 * (row * side + column);
      const to = 3 * (target + Math.floor(column / SAMPLES));
      for (let channel = 0; channel < 3; channel += 1) pixels[to + channel] += samples[from + channel];
    }
  }
  return pixels.map((sum) => sum / (SAMPLES * SAMPLES));
}

function psnr(one, other) {
  let sum = 0;
  for (let i = 0; i < one.length; i += 1) sum += ((one[i] - other[i]) / 255) ** 2;
  return -10 * Math.log10(Math.max(sum / one.length, LEAST_ERROR));
}

/** Pictures side by side, one row of them for each view, as the data of a PNG. */
function sheet(rows, size) {
  const canvas = document.createElement('canvas');
  canvas.width = size * rows[0].length;
  canvas.height = size * rows.length;
  const context = canvas.getContext('2d');
  rows.forEach((row, down) =>
    row.forEach((pixels, across) => {
      const image = context.createImageData(size, size);
      for (let y = 0; y < size; y += 1) {
        for (let x = 0; x < size; x += 1) {
          const from = 3 * ((size - 1 - y) * size + x);
          image.data.set([pixels[from], pixels[from + 1], pixels[from + 2], 255], 4 * (y * size + x));
        }
      }
      context.putImageData(image, across * size, down * size);
    }),
  );
  return canvas.toDataURL('image/png').split(',')[1];
}

/**
 * Compares candidates with the original.
 *
 * `original` is a URL and `candidates` an object of name → URL. Returns `costs` (name → cost,
 * the original's under "original"), `psnr` (name → background → mean and least over the views)
 * and `sheets` (background → PNG in base64: a row of original and candidates for each of the first
 * `pictures` views). Rejects with a sentence when a file does not load.
 */
window.compareModels = async ({ original, candidates, light, views, size, backgrounds, pictures }) => {
  const urls = { original, ...candidates };
  const models = {};
  for (const [name, url] of Object.entries(urls)) {
    try {
      models[name] = await load(url);
    } catch (error) {
      throw new Error(`${name} does not load: ${error?.message ?? error}`);
    }
  }
  const names = Object.keys(candidates);
  const result = { costs: {}, psnr: Object.fromEntries(names.map((name) => [name, {}])), sheets: {} };
  for (const [name, model] of Object.entries(models)) result.costs[name] = cost(model);
  const placement = placementOf(models.original);
  renderer.setSize(size * SAMPLES, size * SAMPLES, false);
  const scenes = Object.entries(models).map(([, model]) => sceneOf(model, placement, light));
  for (const background of backgrounds) {
    for (const scene of scenes) scene.background = new THREE.Color(background);
    const perView = names.map(() => []);
    const rows = [];
    for (let view = 0; view < views; view += 1) {
      const camera = cameraAt(view, views);
      const shown = scenes.map((scene) => picture(scene, camera, size));
      names.forEach((_, i) => perView[i].push(psnr(shown[0], shown[i + 1])));
      if (view < pictures) rows.push(shown);
    }
    names.forEach((name, i) => {
      const mean = perView[i].reduce((sum, value) => sum + value, 0) / views;
      result.psnr[name][background] = { mean, least: Math.min(...perView[i]) };
    });
    if (rows.length > 0) result.sheets[background] = sheet(rows, size);
  }
  return result;
};
window.pageIsReady = true;
