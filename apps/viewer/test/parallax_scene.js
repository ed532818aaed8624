// What the labs of both renderers have in common: a scene around a model with parallax maps, and ways to place its mesh.
import * as THREE from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

/** Pixels along a side of a picture. */
export const SIZE = 192;

/** Share of components that differ by more than rounding does. */
export const differing = (a, b) => a.reduce((count, x, i) => count + (Math.abs(x - b[i]) > 8 ? 1 : 0), 0) / a.length;

/** A scene around a model, which is read with a plug-in; `change` may add to it. */
export async function arrange(Plugin, renderer, name, { options, change = () => {}, orthographic = false } = {}) {
  const loader = new GLTFLoader().register((parser) => new Plugin(parser, options));
  const gltf = await loader.parseAsync(await (await fetch(name)).arrayBuffer(), ''), scene = new THREE.Scene();
  const camera = orthographic ? new THREE.OrthographicCamera(-1.4, 1.4, 1.4, -1.4, 0.1, 400) : new THREE.PerspectiveCamera(40, 1, 0.1, 400);
  camera.position.set(1.2, 1.6, 3.2);
  camera.lookAt(0, 0, 0);
  scene.background = new THREE.Color(0.02, 0.02, 0.02);
  const lamp = new THREE.DirectionalLight(0xffffff, 2);
  lamp.position.set(1, 2, 3);
  scene.add(lamp, new THREE.AmbientLight(0xffffff, 0.5), gltf.scene);
  const own = { gltf, scene, camera, renderer, lamp, mesh: gltf.scene.getObjectByProperty('isMesh', true) };
  change(own);
  return own;
}

/** How the mesh is turned by each of `PLACED`. */
export const TURN = new THREE.Matrix4().makeRotationAxis(new THREE.Vector3(1, 2, 3).normalize(), 0.7);

/** The same surface by way of instances, batches and bones. */
export const PLACED = {
  instances(mesh) {
    const many = new THREE.InstancedMesh(mesh.geometry, mesh.material, 1);
    many.setMatrixAt(0, TURN);
    return many;
  },
  batches(mesh) {
    const { position } = mesh.geometry.attributes, batch = new THREE.BatchedMesh(1, position.count, mesh.geometry.index.count, mesh.material);
    batch.setMatrixAt(batch.addInstance(batch.addGeometry(mesh.geometry)), TURN);
    return batch;
  },
  bones(mesh) {
    const { geometry } = mesh, { count } = geometry.attributes.position;
    geometry.setAttribute('skinIndex', new THREE.Uint16BufferAttribute(new Uint16Array(4 * count), 4));
    geometry.setAttribute('skinWeight', new THREE.Float32BufferAttribute(Float32Array.from({ length: 4 * count }, (_, i) => (i % 4 ? 0 : 1)), 4));
    const skinned = new THREE.SkinnedMesh(geometry, mesh.material), bone = new THREE.Bone();
    skinned.add(bone);
    skinned.bind(new THREE.Skeleton([bone]));
    bone.applyMatrix4(TURN);
    return skinned;
  },
};

/** A change of a scene that puts what `make` makes of the mesh into its place. */
export const replaced = (make) => ({ mesh }) => {
  const other = make(mesh);
  other.frustumCulled = false;
  mesh.parent.add(other);
  mesh.removeFromParent();
  // Bones know where they stand only now.
  other.parent.updateMatrixWorld(true);
};
