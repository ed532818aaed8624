// The texture layout: a texture as it is stored, and the triangles that use it over it.
import {
  BufferAttribute, BufferGeometry, Color, DataTexture, LineSegments, Mesh, OrthographicCamera, PlaneGeometry, Scene,
  ShaderMaterial, SRGBColorSpace, Vector2,
} from './vendor.js';

const VERTEX = 'varying vec2 at; void main() { at = uv; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }';
const TEXTURE = /* glsl */ `
uniform sampler2D map; uniform bool isColor; uniform float light; varying vec2 at;
void main() {
  vec3 c = texture2D(map, vec2(at.x, 1.0 - at.y)).rgb;
  if (isColor) c = mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
  gl_FragColor = vec4(light * c, 1.0);
}`;
const LINE = 'uniform vec3 ink; uniform float opacity; void main() { gl_FragColor = vec4(ink, opacity); }';
/** The texture under its layout is darker, so that lines stand out from any colour. */
const UNDER = 0.55;
const INK = [1, 0.56, 0.3];

export class UvLayout {
  constructor() {
    this.scene = new Scene();
    this.camera = new OrthographicCamera(-1, 1, 1, -1, -1, 1);
    this.center = new Vector2(0.5, 0.5);
    this.span = 1.15;
    this.blank = new DataTexture(new Uint8Array([128, 128, 128, 255]), 1, 1);
    this.blank.needsUpdate = true;
    this.paper = new ShaderMaterial({
      uniforms: { map: { value: this.blank }, isColor: { value: false }, light: { value: 1 } },
      vertexShader: VERTEX, fragmentShader: TEXTURE,
    });
    this.ink = new ShaderMaterial({
      uniforms: { ink: { value: new Color(...INK) }, opacity: { value: 1 } }, vertexShader: VERTEX, fragmentShader: LINE,
      depthTest: false, depthWrite: false, transparent: true,
    });
    const sheet = new Mesh(new PlaneGeometry(1, 1), this.paper);
    sheet.position.set(0.5, 0.5, -0.5);
    this.scene.add(sheet);
    this.lines = [];
  }

  /** Shows a texture of `Model.textures()` or, with none, only the layout of these meshes. */
  show(entry, meshes) {
    const { texture } = entry ?? {};
    this.paper.uniforms.map.value = texture ?? this.blank;
    this.paper.uniforms.isColor.value = texture?.colorSpace === SRGBColorSpace;
    for (const line of this.lines) {
      this.scene.remove(line);
      line.geometry.dispose();
    }
    this.lines = [];
    for (const mesh of entry ? entry.meshes : meshes) {
      const line = lineOf(mesh.geometry, texture, this.ink);
      if (line) this.lines.push(line);
    }
    if (this.lines.length) this.scene.add(...this.lines);
    const triangles = this.lines.reduce((sum, line) => sum + line.geometry.index.count / 6, 0);
    this.ink.uniforms.opacity.value = Math.max(0.15, Math.min(0.9, 60 / Math.sqrt(triangles + 1)));
  }

  /** Shows or hides the triangles. */
  showLines(isOn) {
    for (const line of this.lines) line.visible = isOn;
    this.paper.uniforms.light.value = isOn ? UNDER : 1;
  }

  /** Moves by CSS pixels of a view with this shorter side. */
  move(dx, dy, shorter) {
    this.center.x -= (dx / shorter) * this.span;
    this.center.y += (dy / shorter) * this.span;
  }

  /** Zooms about a point, given in shares of the shorter side from the middle. */
  zoom(factor, x, y) {
    const span = Math.min(40, Math.max(0.005, this.span * factor)), change = this.span - span;
    this.center.x += x * change;
    this.center.y -= y * change;
    this.span = span;
  }

  fit() {
    this.center.set(0.5, 0.5);
    this.span = 1.15;
  }

  at(aspect) {
    const [w, h] = aspect >= 1 ? [aspect, 1] : [1, 1 / aspect], { x, y } = this.center, half = this.span / 2;
    Object.assign(this.camera, { left: x - w * half, right: x + w * half, top: y + h * half, bottom: y - h * half });
    this.camera.updateProjectionMatrix();
    return this.camera;
  }
}

/** The edges of all triangles in the space of the texture, +v down as glTF has it. */
function lineOf(geometry, texture, material) {
  const uvs = geometry.attributes[texture?.channel ? `uv${texture.channel}` : 'uv'];
  if (!uvs) return null;
  texture?.updateMatrix();
  const points = new Float32Array(3 * uvs.count), uv = new Vector2();
  for (let i = 0; i < uvs.count; i++) {
    uv.fromBufferAttribute(uvs, i);
    if (texture) uv.applyMatrix3(texture.matrix);
    points.set([uv.x, 1 - uv.y, 0], 3 * i);
  }
  const { index } = geometry, count = Math.floor((index ? index.count : uvs.count) / 3), edges = new Uint32Array(6 * count);
  for (let t = 0; t < count; t++) {
    const [a, b, c] = [0, 1, 2].map((k) => (index ? index.getX(3 * t + k) : 3 * t + k));
    edges.set([a, b, b, c, c, a], 6 * t);
  }
  const layout = new BufferGeometry();
  layout.setAttribute('position', new BufferAttribute(points, 3));
  layout.setIndex(new BufferAttribute(edges, 1));
  const line = new LineSegments(layout, material);
  line.frustumCulled = false;
  line.renderOrder = 1;
  return line;
}
