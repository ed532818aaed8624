// The lights under which models are compared. Each function lights one scene.
//
// room  image-based: three.js's RoomEnvironment, a closed room with ceiling lamps
// sky   image-based: blue sky, dark ground, a bright warm band above the horizon on the side of +x
// sun   one directional light from the side, and an ambient light of a twentieth of it
//
// The first two have soft highlights, the last has sharp ones and hard terminators. Roughness and
// metal show under the first two, errors of normals under the last.

import * as THREE from 'three';
import { RoomEnvironment } from 'three/examples/jsm/environments/RoomEnvironment.js';

/** A sphere seen from inside whose radiance depends on the direction alone. */
function skyDome() {
  const material = new THREE.ShaderMaterial({
    side: THREE.BackSide,
    depthWrite: false,
    vertexShader: `
      varying vec3 direction;
      void main() {
        direction = position;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: `
      varying vec3 direction;
      void main() {
        vec3 d = normalize(direction);
        vec3 base = d.y > 0.0 ? vec3(0.25, 0.45, 1.0) : vec3(0.12, 0.10, 0.08);
        float height = (d.y - 0.12) / 0.1;
        float share = exp(-height * height) * (d.x > 0.0 ? 1.0 : 0.15);
        gl_FragColor = vec4(mix(base, vec3(6.0, 3.6, 1.8), share), 1.0);
      }`,
  });
  const scene = new THREE.Scene();
  scene.add(new THREE.Mesh(new THREE.SphereGeometry(10, 128, 64), material));
  return scene;
}

function environment(renderer, scene, surroundings, blur) {
  const generator = new THREE.PMREMGenerator(renderer);
  scene.environment = generator.fromScene(surroundings, blur).texture;
  generator.dispose();
}

export const LIGHTS = {
  room: (renderer, scene) => environment(renderer, scene, new RoomEnvironment(), 0.04),
  sky: (renderer, scene) => environment(renderer, scene, skyDome(), 0.02),
  sun: (renderer, scene) => {
    const sun = new THREE.DirectionalLight(0xffffff, 3);
    sun.position.set(3, 2, 1);
    scene.add(sun, new THREE.AmbientLight(0xffffff, 0.15));
  },
};
