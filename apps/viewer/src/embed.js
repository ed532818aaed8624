// The small view in reports: one model, which the page holds as text, turned by mouse, touch and keys. Nothing is loaded.
import {
  Box3, Color, GLTFLoader, MeshBasicMaterial, PMREMGenerator, RoomEnvironment, Scene, Vector3, WebGLRenderer,
} from './vendor.js';
import { byId } from './dom.js';
import { listenToGestures } from './gestures.js';
import { View } from './view.js';
import { ParallaxPlugin, followOffsets, parallaxMaterials, setParallax } from '../../../integrations/three/src/index.js';

const RADIANS_PER_PIXEL = 0.01, STEP = 0.12;
const KEYS = {
  ArrowLeft: (view) => view.orbit(-STEP, 0), ArrowRight: (view) => view.orbit(STEP, 0),
  ArrowUp: (view) => view.orbit(0, STEP), ArrowDown: (view) => view.orbit(0, -STEP),
  '+': (view) => view.zoom(0.9), '=': (view) => view.zoom(0.9), '-': (view) => view.zoom(1 / 0.9),
};

/** The bytes that an element of the page holds in base 64. */
const bytesOf = (element) => Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0)).buffer;

async function start(canvas) {
  const renderer = new WebGLRenderer({ canvas, antialias: true });
  const loader = new GLTFLoader().register((parser) => new ParallaxPlugin(parser, { fallback: true }));
  const { scene: root } = await loader.parseAsync(bytesOf(byId('view-model')), '');
  const scene = new Scene().add(root), view = new View();
  const generator = new PMREMGenerator(renderer);
  scene.environment = generator.fromScene(new RoomEnvironment(), 0.04).texture;
  generator.dispose();

  const box = new Box3().setFromObject(root, true), size = box.getSize(new Vector3());
  const scale = 2 / Math.max(size.x, size.y, size.z);
  root.position.copy(box.getCenter(new Vector3())).multiplyScalar(-scale);
  root.scale.setScalar(scale);
  view.radius = (scale * size.length()) / 2;
  // Most models fill less than their sphere.
  const showWhole = () => { view.fit(); view.zoom(0.8); };
  showWhole();

  const wire = new MeshBasicMaterial({ wireframe: true, transparent: true, opacity: 0.5, depthWrite: false });
  const wireFollows = followOffsets(wire);
  let isWanted = false;
  const draw = () => {
    isWanted = false;
    const width = Math.max(1, canvas.clientWidth), height = Math.max(1, canvas.clientHeight);
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setSize(width, height, false);
    const style = getComputedStyle(canvas);
    scene.background = new Color(style.backgroundColor);
    wire.color.set(style.color);
    const camera = view.at(width / height);
    renderer.render(scene, camera);
    if (!byId('view-wireframe').checked) return;
    Object.assign(renderer, { autoClear: false });
    Object.assign(scene, { overrideMaterial: wire, background: null });
    renderer.render(scene, camera);
    scene.overrideMaterial = null;
    renderer.autoClear = true;
  };
  const ask = () => {
    if (!isWanted) requestAnimationFrame(draw);
    isWanted = true;
  };

  listenToGestures(canvas, {
    turn: (x, y) => { view.orbit(-x * RADIANS_PER_PIXEL, y * RADIANS_PER_PIXEL); ask(); },
    move: (x, y) => { const shorter = Math.min(canvas.clientWidth, canvas.clientHeight); view.pan(x / shorter, y / shorter); ask(); },
    zoom: (factor) => { view.zoom(factor); ask(); },
    // Until the view was chosen, the wheel scrolls the page.
    takesWheel: () => document.activeElement === canvas,
  });
  canvas.addEventListener('keydown', (event) => {
    const move = KEYS[event.key];
    if (!move || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    move(view);
    ask();
  });
  byId('view-wireframe').addEventListener('change', ask);
  byId('view-whole').addEventListener('click', () => { showWhole(); ask(); });
  const maps = byId('view-parallax');
  maps.closest('label').hidden = !parallaxMaterials(root).length;
  maps.addEventListener('change', () => { setParallax(root, maps.checked); wireFollows(maps.checked); ask(); });
  new ResizeObserver(ask).observe(canvas);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', ask);
  for (const control of document.querySelectorAll('#view-controls input, #view-controls button')) control.disabled = false;
  draw();
  canvas.dataset.shown = 'true';
}

// What is not looked at costs nothing.
const canvas = byId('view-canvas');
new IntersectionObserver((entries, observer) => {
  if (!entries.some((entry) => entry.isIntersecting)) return;
  observer.disconnect();
  start(canvas).catch((error) => {
    byId('view-told').textContent = `The model cannot be shown here: ${error?.message ?? error}`;
  });
}, { rootMargin: '200px' }).observe(canvas);
