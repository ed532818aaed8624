// Vertex offsets: a cutout cannot add, so the surface that it cuts reaches further than the one without. Skins, morph targets
// and batches start from the positions, so these are exchanged.
import { BufferAttribute } from 'three';
import { OFFSET } from './format.js';

/** The positions of a geometry with the offsets and without. */
class Reach {
  constructor(geometry) {
    const { position, [OFFSET]: offsets } = geometry.attributes;
    const moved = new Float32Array(3 * position.count);
    for (let i = 0; i < position.count; i++)
      for (let k = 0; k < 3; k++) moved[3 * i + k] = position.getComponent(i, k) + (offsets.getComponent(i, k) || 0);
    this.geometry = geometry;
    // Copies that are made while the maps are on would be moved twice.
    geometry.deleteAttribute(OFFSET);
    this.plain = position;
    this.moved = new BufferAttribute(moved, 3);
  }

  show(isOn) { this.geometry.setAttribute('position', isOn ? this.moved : this.plain); }
}

const made = new WeakMap();

/** Lets the geometries below an object that have offsets follow the switches of their materials. */
export function followSwitches(root) {
  root.traverse(({ geometry, material }) => {
    if (!geometry?.attributes[OFFSET] && !made.has(geometry)) return;
    for (const { parallax } of [material].flat().filter((own) => own?.parallax?.reaches)) {
      if (!made.has(geometry)) made.set(geometry, new Reach(geometry));
      const reach = made.get(geometry);
      parallax.reaches.add(reach);
      reach.show(parallax.enabled);
    }
  });
}
