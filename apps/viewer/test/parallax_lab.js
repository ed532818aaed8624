// In the browser: scenes of three.js with the package of integrations/three, for parallax.mjs.
import * as THREE from 'three';
import { ParallaxPlugin, PARALLAX_GLSL, createDepthMaterial, parallaxMaterials, setParallax } from '../../../integrations/three/src/index.js';
import { PLACED, SIZE, TURN, arrange, differing, replaced } from './parallax_scene.js';

const renderers = {};

/** A renderer whose canvas has several samples a pixel, or one. */
function rendererOf(antialias) {
  if (renderers[antialias]) return renderers[antialias];
  const renderer = new THREE.WebGLRenderer({ antialias, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(SIZE, SIZE);
  renderer.shadowMap.enabled = true;
  renderer.debug.onShaderError = (gl, program, vertex, fragment) => {
    console.error(`a shader does not compile: ${gl.getProgramInfoLog(program)} ${gl.getShaderInfoLog(vertex)} ${gl.getShaderInfoLog(fragment)}`);
  };
  return (renderers[antialias] = renderer);
}

let sky;
/** The light of an even sky; made once, since on a processor it takes seconds. */
function skyOf(renderer) {
  if (!sky) {
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(0.4, 0.5, 0.7);
    sky = new THREE.PMREMGenerator(renderer).fromScene(scene).texture;
  }
  return sky;
}

function pixels(renderer) {
  const gl = renderer.getContext(), out = new Uint8Array(4 * SIZE * SIZE);
  gl.readPixels(0, 0, SIZE, SIZE, gl.RGBA, gl.UNSIGNED_BYTE, out);
  const error = gl.getError();
  if (error) console.error(`WebGL has an error: ${error}`);
  return out;
}

const difference = (a, b) => a.reduce((most, x, i) => Math.max(most, Math.abs(x - b[i])), 0);
const shareOf = (picture, test) => {
  let count = 0;
  for (let i = 0; i < picture.length; i += 4) if (test(picture[i], picture[i + 1], picture[i + 2], picture[i + 3])) count++;
  return count / (picture.length / 4);
};

/** A scene around a model, and a function that draws it. */
async function stage(name, { antialias = false, ...more } = {}) {
  const own = await arrange(ParallaxPlugin, rendererOf(antialias), name, more), { renderer, scene, camera } = own;
  const draw = () => {
    renderer.setRenderTarget(null);
    renderer.render(scene, camera);
    return pixels(renderer);
  };
  return { ...own, draw };
}

/** The functions of the format at one line of sight. */
function numbers([x, y, z]) {
  const rows = 17;
  const renderer = rendererOf(false), target = new THREE.WebGLRenderTarget(rows, 1, { type: THREE.FloatType });
  const material = new THREE.ShaderMaterial({
    vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: `uniform vec3 w;\n${PARALLAX_GLSL}
      vec4 one(int k) { return vec4(k == 0, k == 1, k == 2, k == 3); }
      void main() {
        int k = int(gl_FragCoord.x);
        float value;
        if (k < 12) value = parallaxOpacity(one(k), one(k - 4), one(k - 8), w);
        // Pairs (1, 0) alone; the shift is divided by z.
        else if (k < 16) value = parallaxShift(one(2 * (k - 12)), one(2 * (k - 14)), w, 0.25).x * w.z;
        // Below the limit.
        else value = parallaxShift(one(0), vec4(0.0), vec3(w.xy, 0.1), 0.25).x;
        gl_FragColor = vec4(value);
      }`,
    uniforms: { w: { value: new THREE.Vector3(x, y, z) } },
  });
  const quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material), out = new Float32Array(4 * rows);
  quad.frustumCulled = false;
  renderer.setRenderTarget(target);
  renderer.render(quad, new THREE.Camera());
  renderer.readRenderTargetPixels(target, 0, 0, rows, 1, out);
  renderer.setRenderTarget(null);
  return Array.from({ length: rows }, (_, k) => out[4 * k]);
}

/** What parallax.mjs asks for; each gives plain values. */
const tests = {
  numbers,

  async switching(name) {
    const { gltf, draw } = await stage(name);
    const on = draw();
    setParallax(gltf.scene, false);
    const off = draw();
    setParallax(gltf.scene, true);
    return { changed: differing(on, off), back: difference(on, draw()), materials: parallaxMaterials(gltf.scene).length };
  },

  /** All of three.js at once: fog, environment, shadows of three kinds of lights, several samples. */
  async everything(name) {
    const { gltf, draw, mesh } = await stage(name, { antialias: true, change({ scene, renderer, lamp, mesh: object }) {
      scene.fog = new THREE.Fog(0x8899aa, 2, 6);
      scene.environment = skyOf(renderer);
      const [point, spot] = [new THREE.PointLight(0xff8844, 8), new THREE.SpotLight(0x88aaff, 8)];
      point.position.set(-2, 1, 2);
      spot.position.set(0, 3, 1);
      for (const light of [lamp, point, spot]) light.castShadow = true;
      object.castShadow = object.receiveShadow = true;
      scene.add(point, spot);
    } });
    const on = draw();
    setParallax(gltf.scene, false);
    return { changed: differing(on, draw()), coverage: mesh.material.alphaToCoverage };
  },

  /** The same surface by way of instances, bones and targets of morphing. */
  async ways(name) {
    const plain = await stage(name, { change: ({ mesh }) => mesh.applyMatrix4(TURN) }), wanted = plain.draw(), out = {};
    const drawn = async (make) => (await stage(name, { change: replaced(make) })).draw();
    for (const [way, make] of Object.entries(PLACED)) out[way] = differing(wanted, await drawn(make));
    out.morphs = differing(wanted, await drawn((mesh) => {
      const { geometry } = mesh;
      for (const key of ['position', 'normal']) {
        // The ball's normals are also its points.
        const target = geometry.attributes.normal.clone();
        target.array = target.array.map((value) => 0.3 * value);
        geometry.morphAttributes[key] = [target];
      }
      geometry.morphTargetsRelative = true;
      const morphed = new THREE.Mesh(geometry, mesh.material);
      morphed.morphTargetInfluences = [0.5];
      // The target makes the ball larger.
      morphed.applyMatrix4(TURN.clone().scale(new THREE.Vector3().setScalar(1 / 1.15)));
      return morphed;
    }));
    // A mirrored mesh is the mirrored picture: seen and lit from the other side.
    const mirror = async (x) => (await stage(name, { change({ mesh, camera, lamp }) {
      mesh.scale.x = x;
      mesh.material.normalMap = null;
      for (const object of [camera, lamp]) object.position.x *= x;
      camera.lookAt(0, 0, 0);
    } })).draw();
    const straight = await mirror(1), mirrored = await mirror(-1), flipped = new Uint8Array(straight.length);
    for (let y = 0; y < SIZE; y++)
      for (let px = 0; px < SIZE; px++)
        flipped.set(mirrored.subarray(4 * (y * SIZE + SIZE - 1 - px), 4 * (y * SIZE + SIZE - px)), 4 * (y * SIZE + px));
    out.mirrored = differing(straight, flipped);
    return out;
  },

  /** From far away, perspective is orthographic. */
  async orthographic(name) {
    const near = (await stage(name, { orthographic: true })).draw();
    const far = (await stage(name, { change({ camera }) {
      camera.position.normalize().multiplyScalar(300);
      camera.fov = (2 * Math.atan(1.4 / 300) * 180) / Math.PI;
      camera.updateProjectionMatrix();
    } })).draw();
    return differing(near, far);
  },

  /** Maps that are filtered along the longer side: the same but for detail. */
  async anisotropic(name) {
    const { draw, mesh, renderer } = await stage(name), plain = draw(), { material } = mesh;
    material.map.anisotropy = renderer.capabilities.getMaxAnisotropy();
    material.map.needsUpdate = true;
    return { isTaken: (draw(), material.parallax.isAnisotropic), differs: differing(plain, draw()) };
  },

  /** The shadow on a wall behind the model, for each kind of light: its size with and without the cutout. */
  async shadows(name) {
    const out = {};
    for (const [key, make] of Object.entries({
      sun: () => new THREE.DirectionalLight(0xffffff, 3), lamp: () => new THREE.PointLight(0xffffff, 60), spot: () => new THREE.SpotLight(0xffffff, 60),
    })) {
      const { gltf, draw } = await stage(name, { change({ scene, camera, lamp, mesh }) {
        const light = make();
        lamp.removeFromParent();
        light.position.set(0, 0, 4);
        light.castShadow = true;
        light.shadow.mapSize.set(1024, 1024);
        light.shadow.camera.near = 1;
        if (light.isDirectionalLight) Object.assign(light.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2 });
        mesh.castShadow = true;
        const wall = new THREE.Mesh(new THREE.PlaneGeometry(9, 9), new THREE.MeshStandardMaterial({ color: 0xff0000 }));
        wall.position.z = -1.2;
        wall.receiveShadow = true;
        scene.add(light, wall);
        // Behind the wall, looking through it at nothing but the shadow.
        wall.material.side = THREE.DoubleSide;
        mesh.layers.set(1);
        light.shadow.camera.layers.enable(1);
        camera.position.set(0, 0, 6);
        camera.lookAt(0, 0, 0);
      } });
      const dark = (r) => r < 160;
      const cut = shareOf(draw(), dark);
      setParallax(gltf.scene, false);
      out[key] = { cut, whole: shareOf(draw(), dark) };
    }
    return out;
  },

  /** Depth first, then colours where it is equal: the same picture. */
  async prepass(name) {
    const { scene, camera, renderer, mesh, draw } = await stage(name);
    const wanted = draw(), { material } = mesh, depth = createDepthMaterial(material, mesh.geometry);
    depth.colorWrite = false;
    renderer.autoClear = true;
    mesh.material = depth;
    draw();
    mesh.material = material;
    material.depthFunc = THREE.EqualDepth;
    renderer.autoClearDepth = false;
    renderer.render(scene, camera);
    renderer.autoClearDepth = true;
    return differing(wanted, pixels(renderer));
  },

  /** Borders with several samples: neither holes nor glass, but more shades than without. */
  async borders(name) {
    const shades = async (options) => {
      const { draw } = await stage(name, { antialias: true, options, change({ scene, mesh }) {
        scene.background = new THREE.Color(0, 0, 0);
        // White all over, so that every other shade is a border.
        const { material } = mesh;
        Object.assign(material, { emissive: new THREE.Color(9, 9, 9), emissiveMap: null });
      } });
      const picture = draw();
      return { clear: shareOf(picture, (r, g, b, a) => a < 255), between: shareOf(picture, (r) => r > 20 && r < 235), white: shareOf(picture, (r) => r >= 235) };
    };
    return { covered: await shades({}), plain: await shades({ alphaToCoverage: false }) };
  },

  /** Images of the colour map with the maps, without, and of a copy that was made while they were off, likewise. */
  async fallback(name) {
    const { gltf, mesh } = await stage(name, { options: { fallback: true } });
    const { material } = mesh, { associations } = gltf.parser;
    const image = (of) => associations.get(of.map)?.textures ?? null;
    const seen = [image(material)];
    setParallax(gltf.scene, false);
    seen.push(image(material));
    mesh.material = material.clone();
    setParallax(gltf.scene, true);
    seen.push(image(mesh.material));
    setParallax(gltf.scene, false);
    seen.push(image(mesh.material));
    return seen;
  },

  /** What is loaded of a file, and what it looks like. */
  async loaded(name) {
    const warnings = [], { warn } = console;
    console.warn = (text) => warnings.push(text);
    const { gltf, mesh, draw } = await stage(name);
    console.warn = warn;
    const on = draw(), hasMaps = Boolean(mesh.material.parallax);
    setParallax(gltf.scene, false);
    return {
      hasMaps, warnings, changed: differing(on, draw()), images: Object.keys(gltf.parser.sourceCache).map(Number),
      shades: new Set(on).size, type: mesh.material.type,
    };
  },
};

window.lab = { run: (name, ...rest) => tests[name](...rest) };
