// In the browser: the same scenes by WebGLRenderer and by WebGPURenderer, with the package of integrations/three, for
// parallax_nodes.mjs.
import * as THREE from 'three';
import * as GPU from 'three/webgpu';
import { float, uniform, vec3, vec4, Fn, screenCoordinate } from 'three/tsl';
import { ParallaxPlugin } from '../../../integrations/three/src/index.js';
import { ParallaxNodePlugin, parallaxNodes, setParallax } from '../../../integrations/three/src/webgpu.js';
import { PLACED, SIZE, arrange, differing, replaced } from './parallax_scene.js';

const made = new Map();

/** A renderer of three.js: `webgl` is WebGLRenderer, `nodes` WebGPURenderer on WebGL, `webgpu` on WebGPU. */
async function rendererOf(kind, antialias) {
  const key = `${kind} ${antialias}`;
  if (made.has(key)) return made.get(key);
  const renderer = kind === 'webgl' ? new THREE.WebGLRenderer({ antialias, preserveDrawingBuffer: true })
    : new GPU.WebGPURenderer({ antialias, forceWebGL: kind === 'nodes' });
  renderer.setPixelRatio(1);
  renderer.setSize(SIZE, SIZE);
  renderer.shadowMap.enabled = true;
  await renderer.init?.();
  made.set(key, renderer);
  return renderer;
}

const encoded = (x) => 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * Math.max(x, 0) ** (1 / 2.4) - 0.055);

/** Draws, and reads what is to be seen: RGBA from 0 to 255, row 0 on top. Canvases of WebGPU need a screen, and are not used. */
async function picture(renderer, scene, camera, { kind, antialias }) {
  if (kind === 'webgpu') {
    const target = new THREE.RenderTarget(SIZE, SIZE, { type: THREE.HalfFloatType, samples: antialias ? 4 : 0 });
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    const linear = await renderer.readRenderTargetPixelsAsync(target, 0, 0, SIZE, SIZE);
    renderer.setRenderTarget(null);
    target.dispose();
    return Uint8ClampedArray.from(linear, (half, i) => {
      const value = THREE.DataUtils.fromHalfFloat(half);
      return i % 4 === 3 ? 255 * value : encoded(value);
    });
  }
  renderer.render(scene, camera);
  const canvas = new OffscreenCanvas(SIZE, SIZE), brush = canvas.getContext('2d');
  brush.drawImage(await createImageBitmap(renderer.domElement), 0, 0);
  return brush.getImageData(0, 0, SIZE, SIZE).data;
}

const decibels = (a, b) => {
  const sum = a.reduce((total, x, i) => total + (x - b[i]) ** 2, 0);
  return sum ? -10 * Math.log10(sum / (a.length * 255 ** 2)) : Infinity;
};

async function stage(name, kind, { antialias = false, ...more } = {}) {
  const Plugin = kind === 'webgl' ? ParallaxPlugin : ParallaxNodePlugin;
  const own = await arrange(Plugin, await rendererOf(kind, antialias), name, more), { renderer, scene, camera } = own;
  return { ...own, draw: () => picture(renderer, scene, camera, { kind, antialias }) };
}

const SCENES = {
  plain: {},
  orthographic: { orthographic: true },
  samples: { antialias: true },
  hard: { antialias: true, options: { alphaToCoverage: false } },
  mirrored: { change({ mesh }) { mesh.scale.x = -1; } },
  ...Object.fromEntries(Object.entries(PLACED).map(([way, make]) => [way, { change: replaced(make) }])),
  shadow: { change({ scene, camera, lamp, mesh }) {
    lamp.position.set(0, 0, 4);
    lamp.castShadow = mesh.castShadow = true;
    lamp.shadow.mapSize.set(1024, 1024);
    Object.assign(lamp.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2 });
    const wall = new THREE.Mesh(new THREE.PlaneGeometry(9, 9), new THREE.MeshStandardMaterial({ color: 0xff0000 }));
    wall.position.z = -1.2;
    wall.receiveShadow = true;
    scene.add(wall);
    camera.position.set(2.5, 0, 5);
    camera.lookAt(0, 0, 0);
  } },
};

const tests = {
  kinds: async () => ({ webgpu: Boolean(await navigator.gpu?.requestAdapter()) }),

  /** Each function of the format, by each of the rows that GLSL's test has. */
  async numbers([x, y, z], kind) {
    const renderer = await rendererOf(kind, false), rows = 17;
    const target = new THREE.RenderTarget(rows, 1, { type: THREE.FloatType, depthBuffer: false });
    const material = new GPU.NodeMaterial(), { opacity, shift } = parallaxNodes;
    material.fragmentNode = Fn(() => {
      const w = uniform(new THREE.Vector3(x, y, z)), k = screenCoordinate.x.floor();
      const one = (index) => vec4(...[0, 1, 2, 3].map((i) => index.equal(i).select(float(1), float(0))));
      const ofOpacity = opacity([one(k), one(k.sub(4)), one(k.sub(8))], w);
      const ofShift = shift([one(k.sub(12).mul(2)), one(k.sub(14).mul(2))], w, 0.25).x.mul(w.z);
      const below = shift([one(float(0)), vec4(0)], vec3(w.xy, 0.1), 0.25).x;
      return vec4(k.lessThan(12).select(ofOpacity, k.lessThan(16).select(ofShift, below)));
    })();
    const quad = new GPU.QuadMesh(material);
    renderer.setRenderTarget(target);
    quad.render(renderer);
    renderer.setRenderTarget(null);
    const out = await renderer.readRenderTargetPixelsAsync(target, 0, 0, rows, 1);
    return Array.from({ length: rows }, (_, k) => out[4 * k]);
  },

  /** A scene by WebGLRenderer and by nodes: decibels between the pictures with maps, and without, and how much the switch changes. */
  async alike(name, scene, kind) {
    const [ours, theirs] = [await stage(name, kind, SCENES[scene]), await stage(name, 'webgl', SCENES[scene])];
    const both = async (isOn) => {
      setParallax(ours.scene, isOn);
      setParallax(theirs.scene, isOn);
      return [await ours.draw(), await theirs.draw()];
    };
    const on = await both(true), off = await both(false), again = await both(true);
    return {
      on: decibels(...on), off: decibels(...off), changed: differing(on[0], off[0]), back: differing(on[0], again[0]),
      type: ours.mesh.material.type,
    };
  },

  /** A picture as a data URL, to look at. */
  async picture(name, scene, kind, isOn) {
    const { scene: whole, draw } = await stage(name, kind, SCENES[scene]), canvas = document.createElement('canvas');
    canvas.width = canvas.height = SIZE;
    setParallax(whole, isOn);
    canvas.getContext('2d').putImageData(new ImageData(await draw(), SIZE, SIZE), 0, 0);
    return canvas.toDataURL();
  },

  /** Images of the colour map with the maps, without, and of a copy that was made while they were off, likewise. */
  async fallback(name, kind) {
    const { gltf, mesh } = await stage(name, kind, { options: { fallback: true } });
    const { material } = mesh, { associations } = gltf.parser;
    const image = (of) => associations.get(of.map)?.textures ?? null, seen = [image(material)];
    setParallax(gltf.scene, false);
    seen.push(image(material));
    mesh.material = material.clone();
    setParallax(gltf.scene, true);
    seen.push(image(mesh.material));
    setParallax(gltf.scene, false);
    seen.push(image(mesh.material));
    return seen;
  },
};

window.lab = { run: (name, ...rest) => tests[name](...rest) };
