// The scene of both examples: a model on a floor, in a room, with a sun.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { parallaxMaterials, setParallax } from '../src/switch.js';

/** Shows models by this renderer, read with this plug-in. */
export function start(renderer, Plugin) {
  renderer.setPixelRatio(devicePixelRatio);
  renderer.shadowMap.enabled = true;
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color('#d8d8d4');
  scene.environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment(), 0.04).texture;
  scene.environmentIntensity = 0.6;
  const camera = new THREE.PerspectiveCamera(40, 1, 0.01, 100);
  camera.position.set(1.6, 1.4, 3.2);
  const controls = new OrbitControls(camera, renderer.domElement);
  const sun = new THREE.DirectionalLight('#fff', 2);
  sun.position.set(2, 4, 2);
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.bias = -0.002;
  Object.assign(sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2 });
  const floor = new THREE.Mesh(new THREE.PlaneGeometry(20, 20), new THREE.ShadowMaterial({ opacity: 0.3 }));
  floor.rotation.x = -Math.PI / 2;
  floor.position.y = -1;
  floor.receiveShadow = true;
  const shown = new THREE.Group();
  scene.add(sun, floor, shown);

  const loader = new GLTFLoader().register((parser) => new Plugin(parser));
  const told = document.getElementById('told'), toggle = document.getElementById('parallax');

  async function show(bytes, name) {
    const gltf = await loader.parseAsync(bytes, '');
    // In the middle, and two units long.
    const box = new THREE.Box3().setFromObject(gltf.scene), size = box.getSize(new THREE.Vector3());
    const scale = 2 / Math.max(size.x, size.y, size.z);
    gltf.scene.scale.setScalar(scale);
    gltf.scene.position.copy(box.getCenter(new THREE.Vector3())).multiplyScalar(-scale);
    floor.position.y = (-size.y * scale) / 2;
    gltf.scene.traverse((object) => { object.castShadow = object.isMesh ?? false; });
    shown.clear();
    shown.add(gltf.scene);
    setParallax(shown, toggle.checked);
    told.textContent = `${name}: ${parallaxMaterials(shown).length ? 'with parallax maps' : 'without parallax maps'}`;
  }
  const fail = (error) => { told.textContent = error.message; };
  const open = (file) => file && file.arrayBuffer().then((bytes) => show(bytes, file.name)).catch(fail);
  document.getElementById('file').addEventListener('change', (event) => open(event.target.files[0]));
  addEventListener('dragover', (event) => event.preventDefault());
  addEventListener('drop', (event) => {
    event.preventDefault();
    open(event.dataTransfer.files[0]);
  });
  toggle.addEventListener('change', () => setParallax(shown, toggle.checked));
  const named = new URLSearchParams(location.search).get('model');
  if (named) fetch(named).then((r) => r.arrayBuffer()).then((bytes) => show(bytes, named)).catch(fail);

  function resize() {
    renderer.setSize(innerWidth, innerHeight);
    camera.aspect = innerWidth / innerHeight;
    camera.updateProjectionMatrix();
  }
  addEventListener('resize', resize);
  resize();
  renderer.setAnimationLoop(() => {
    controls.update();
    renderer.render(scene, camera);
  });
}
