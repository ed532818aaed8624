// The lights to choose from. `studio` and `headlight` are computed in the materials (materials.js); the others are
// made of geometry and filtered here, so no picture is loaded.
import {
  BackSide, BufferAttribute, Color, DirectionalLight, Mesh, MeshBasicMaterial, PMREMGenerator, RoomEnvironment, Scene,
  SphereGeometry,
} from './vendor.js';
import { SHADED } from './materials.js';

export const LIGHTS = [
  { key: 'studio', label: 'Studio, as in eval', shaded: SHADED.studio },
  { key: 'room', label: 'Room', shaded: SHADED.three },
  { key: 'sky', label: 'Evening sky', shaded: SHADED.three },
  { key: 'sun', label: 'Sun', shaded: SHADED.three },
  { key: 'headlight', label: 'Headlight, matte', shaded: SHADED.headlight },
];

/** A sphere seen from within, its radiance a function of the direction. */
function dome(radiance) {
  const geometry = new SphereGeometry(10, 64, 32), { position } = geometry.attributes, colors = [];
  const color = new Color();
  for (let i = 0; i < position.count; i++) {
    radiance(color, position.getX(i) / 10, position.getY(i) / 10, position.getZ(i) / 10);
    colors.push(color.r, color.g, color.b);
  }
  geometry.setAttribute('color', new BufferAttribute(new Float32Array(colors), 3));
  const scene = new Scene();
  scene.add(new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, side: BackSide })));
  return scene;
}

// Blue above, a low bright band to one side, dark ground.
function evening(color, x, y) {
  const band = Math.min(1, Math.exp(-(((y - 0.12) / 0.12) ** 2)) * (x > 0 ? 1 : 0.2));
  const [r, g, b] = y > 0 ? [0.25, 0.42, 0.85] : [0.12, 0.1, 0.08];
  color.setRGB(r + (5 - r) * band, g + (3 - g) * band, b + (1.6 - b) * band);
}

// Little but the sun itself, which is a lamp.
function noon(color, x, y) {
  const up = Math.max(0, y);
  color.setRGB(0.16 + 0.1 * up, 0.18 + 0.14 * up, 0.2 + 0.24 * up);
}

/** Lights for scenes that are to look alike. */
export class Lights {
  constructor(renderer, scenes) {
    this.renderer = renderer;
    this.scenes = scenes;
    this.made = {};
    this.suns = scenes.map((scene) => {
      const sun = new DirectionalLight(0xffffff, 2.6);
      sun.visible = false;
      scene.add(sun, sun.target);
      return sun;
    });
  }

  environment(key) {
    if (this.made[key]) return this.made[key];
    const generator = new PMREMGenerator(this.renderer);
    const scene = key === 'room' ? new RoomEnvironment() : dome(key === 'sky' ? evening : noon);
    this.made[key] = generator.fromScene(scene, key === 'room' ? 0.04 : 0.02).texture;
    generator.dispose();
    return this.made[key];
  }

  /** Chooses a light and turns it about +Y, in radians. */
  choose(key, turn) {
    const isComputed = key === 'studio' || key === 'headlight';
    const environment = isComputed ? null : this.environment(key);
    this.scenes.forEach((scene, index) => {
      scene.environment = environment;
      scene.environmentRotation.y = turn;
      const sun = this.suns[index];
      sun.visible = key === 'sun';
      sun.position.set(Math.cos(-turn) * 3 + Math.sin(turn) * 1.5, 3, Math.sin(-turn) * 3 + Math.cos(turn) * 1.5);
    });
  }
}
