// A small model with parallax maps for tests: a ball of few triangles that is cut rounder than it is, as GLB.
import zlib from 'node:zlib';

const crcTable = Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});
const crc = (bytes) => ~bytes.reduce((c, byte) => crcTable[(c ^ byte) & 255] ^ (c >>> 8), -1) >>> 0;

/** RGBA as PNG; `texel(x, y)` gives four bytes. */
export function png(width, height, texel) {
  const rows = Buffer.alloc(height * (4 * width + 1));
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) rows.set(texel(x, y), y * (4 * width + 1) + 1 + 4 * x);
  const chunk = (kind, body) => {
    const named = Buffer.concat([Buffer.from(kind, 'latin1'), body]), out = Buffer.alloc(named.length + 8);
    out.writeUInt32BE(body.length);
    named.copy(out, 4);
    out.writeUInt32BE(crc(named), named.length + 4);
    return out;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  head.set([8, 6, 0, 0, 0], 8);
  return Buffer.concat([
    Buffer.from('89504e470d0a1a0a', 'hex'), chunk('IHDR', head), chunk('IDAT', zlib.deflateSync(rows)), chunk('IEND', Buffer.alloc(0)),
  ]);
}

const wave = (x, y, c) => Math.round(127.5 + 127.5 * Math.sin(0.7 * x + 1.3 * c) * Math.cos(0.5 * y + 0.4 * c));
/** Layers one below the other, a channel of four each. */
const layers = (count, size) => png(size, count * size, (x, y) => {
  const first = 4 * Math.floor(y / size);
  return [0, 1, 2, 3].map((c) => wave(x, y % size, first + c));
});
const BOARD = (light) => (x, y) => ((x >> 3) + (y >> 3)) & 1 ? [...light, 255] : [40 + 3 * x, 40 + 3 * y, 90, 255];

/**
 * `change` may change the document before it is written. Without its maps the ball is smaller, by `reach`: its vertices
 * have offsets.
 */
export function parallaxModel({ rings = 7, sectors = 12, reach = 0.1, change = () => {} } = {}) {
  const offset = [], position = [], normal = [], tangent = [], uv = [], index = [];
  for (let r = 0; r <= rings; r++)
    for (let s = 0; s <= sectors; s++) {
      const [u, v] = [s / sectors, r / rings], [a, b] = [2 * Math.PI * u, Math.PI * v];
      const n = [Math.sin(b) * Math.sin(a), Math.cos(b), Math.sin(b) * Math.cos(a)];
      position.push(...n.map((x) => (1 - reach) * x));
      offset.push(...n.map((x) => reach * x));
      normal.push(...n);
      tangent.push(Math.cos(a), 0, -Math.sin(a), 1);
      uv.push(u, v);
      if (r < rings && s < sectors) {
        const i = r * (sectors + 1) + s, below = i + sectors + 1;
        if (r > 0) index.push(i, below, i + 1);
        if (r < rings - 1) index.push(i + 1, below, below + 1);
      }
    }
  const parts = [], views = [];
  const add = (bytes) => {
    const from = parts.reduce((sum, part) => sum + part.length, 0), padded = Buffer.alloc(Math.ceil(bytes.byteLength / 4) * 4);
    Buffer.from(bytes.buffer, bytes.byteOffset, bytes.byteLength).copy(padded);
    parts.push(padded);
    return views.push({ buffer: 0, byteOffset: from, byteLength: bytes.byteLength }) - 1;
  };
  const accessors = [];
  const numbers = (list, type, width) => accessors.push({
    bufferView: add(Float32Array.from(list)), componentType: 5126, count: list.length / width, type,
    ...(type === 'VEC3' && width === 3 ? { min: [-1, -1, -1], max: [1, 1, 1] } : {}),
  }) - 1;
  const attributes = {
    POSITION: numbers(position, 'VEC3', 3), NORMAL: numbers(normal, 'VEC3', 3), TANGENT: numbers(tangent, 'VEC4', 4),
    TEXCOORD_0: numbers(uv, 'VEC2', 2), ...(reach ? { _PARALLAX_OFFSET: numbers(offset, 'VEC3', 3) } : {}),
  };
  const indices = accessors.push({ bufferView: add(Uint16Array.from(index)), componentType: 5123, count: index.length, type: 'SCALAR' }) - 1;
  const image = (bytes) => ({ bufferView: add(bytes), mimeType: 'image/png' });
  const flat = (x, y) => [128 + 40 * Math.sin(x), 128 + 40 * Math.cos(y), 245, 255].map(Math.round);
  const images = [
    image(png(64, 64, BOARD([230, 200, 60]))), image(png(64, 64, flat)), image(layers(2, 12)), image(layers(3, 12)),
    image(png(64, 64, BOARD([60, 200, 230]))),
  ];
  // Seen under more than about 65 degrees the surface is not there; where exactly varies.
  const scale = [0.1, 0.1, ...Array(10).fill(0.1)], least = [0.15, 0.55, ...Array(10).fill(-0.05)];
  const json = {
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0, name: 'ball' }],
    meshes: [{ primitives: [{ attributes, indices, material: 0 }] }],
    materials: [{
      name: 'ball', doubleSided: true,
      pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicRoughnessTexture: { index: 4 }, metallicFactor: 0.4, roughnessFactor: 0.9 },
      normalTexture: { index: 1 }, occlusionTexture: { index: 4 }, emissiveTexture: { index: 4 }, emissiveFactor: [0.1, 0.1, 0.1],
      extensions: { PARBAKE_materials_parallax: {
        version: 2, texture: { index: 2 }, scale: Array(8).fill(0.08), offset: Array(8).fill(-0.04), limit: 0.25,
        cutout: { texture: { index: 3 }, scale, offset: least },
      } },
    }],
    textures: [{ source: 0 }, { source: 1 }, { sampler: 0, source: 2 }, { sampler: 0, source: 3 }, { source: 4 }],
    samplers: [{ magFilter: 9729, minFilter: 9729, wrapS: 33071, wrapT: 33071 }], images, accessors, bufferViews: views,
    extensionsUsed: ['PARBAKE_materials_parallax'],
  };
  change(json, json.materials[0].extensions.PARBAKE_materials_parallax);
  const binary = Buffer.concat(parts);
  json.buffers = [{ byteLength: binary.length }];
  let text = Buffer.from(JSON.stringify(json));
  text = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const words = (...list) => Buffer.from(Uint32Array.from(list).buffer);
  return Buffer.concat([
    words(0x46546c67, 2, 28 + text.length + binary.length), words(text.length, 0x4e4f534a), text, words(binary.length, 0x004e4942), binary,
  ]);
}
