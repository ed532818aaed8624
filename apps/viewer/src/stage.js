// Draws the models: each into a target in linear light, then both to the screen (compose.js). Draws only when asked.
import {
  Color, CustomBlending, DoubleSide, EqualDepth, FloatType, HalfFloatType, MeshBasicMaterial, OneFactor, Scene, UnsignedByteType,
  Vector3, WebGLRenderer, WebGLRenderTarget, ZeroFactor,
} from './vendor.js';
import { Composer, LAYOUTS } from './compose.js';
import { GpuTimer } from './gpu_timer.js';
import { Lights, LIGHTS } from './lights.js';
import { CHANNELS, setUnit, show, showsGlass, turnStudio } from './materials.js';
import { UvLayout } from './uv_layout.js';
import { View } from './view.js';
import { psnr } from './psnr.js';
import { followOffsets } from '../../../integrations/three/src/index.js';

/** Pixels of a picture, at most: what is more is scaled up by the browser. */
const MOST_PIXELS = 9e6;
/** Up to so many pixels have four samples, more of them two: they are small. */
const FINE_PIXELS = 4e6;

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: false, powerPreference: 'high-performance' });
    this.renderer.setPixelRatio(1);
    this.renderer.info.autoReset = true;
    this.composer = new Composer(this.renderer);
    this.timer = new GpuTimer(this.renderer.getContext());
    this.scenes = [new Scene(), new Scene()];
    this.lights = new Lights(this.renderer, this.scenes);
    this.view = new View();
    this.uv = new UvLayout();
    this.wire = new MeshBasicMaterial({ wireframe: true, transparent: true, opacity: 0.55, depthWrite: false });
    // Writes alpha alone, 1, where something was drawn.
    this.cover = new MeshBasicMaterial({
      side: DoubleSide, depthFunc: EqualDepth, depthWrite: false, blending: CustomBlending, blendSrc: ZeroFactor, blendDst: OneFactor,
      blendSrcAlpha: OneFactor, blendDstAlpha: ZeroFactor,
    });
    this.cover.onBeforeCompile = (shader) => { shader.fragmentShader = 'void main() { gl_FragColor = vec4(1.0); }'; };
    // Drawn where something is cut, so always where maps are shown.
    followOffsets(this.cover);
    this.wireFollows = followOffsets(this.wire);
    this.targets = [null, null];
    this.measured = [null, null];
    this.levels = null;
    this.compare = null;
    this.drawCalls = [0, 0];
    this.milliseconds = null;
    /** Share of the screen's pixels along a side that are drawn. */
    this.sharpness = 1;
  }

  /** The models: `Levels`, and a `Model` or null. Both stand in the frame of the second, if there is one. */
  setModels(levels, compare) {
    this.compare = compare;
    const box = (compare ?? levels.models[0]).box();
    const size = box.getSize(new Vector3());
    const longest = Math.max(size.x, size.y, size.z);
    if (!(longest > 0) || !Number.isFinite(longest)) throw new Error('The model has no size: all its vertices lie at one point.');
    this.frame = { center: box.getCenter(new Vector3()), scale: 2 / longest };
    setUnit(this.frame.scale);
    this.setLevels(levels);
    if (compare) this.place(compare, 1);
    this.view.radius = (this.frame.scale * size.length()) / 2;
    this.view.fit();
  }

  /** Shows other levels in the place of those before, in the same frame. */
  setLevels(levels) {
    for (const model of this.levels?.models ?? []) this.scenes[0].remove(model.root);
    this.levels = levels;
    for (const model of levels.models) this.place(model, 0);
  }

  place(model, which) {
    const { center, scale } = this.frame;
    model.root.scale.setScalar(scale);
    model.root.position.copy(center).multiplyScalar(-scale);
    model.root.updateMatrixWorld(true);
    this.scenes[which].add(model.root);
  }

  /** Fits the picture to the element; whether anything changed. */
  resize() {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const ratio = this.sharpness * Math.min(window.devicePixelRatio || 1, Math.sqrt(MOST_PIXELS / Math.max(1, w * h)));
    const width = Math.max(1, Math.round(w * ratio)), height = Math.max(1, Math.round(h * ratio));
    if (this.width === width && this.height === height) return false;
    Object.assign(this, { width, height, ratio });
    this.renderer.setSize(width, height, false);
    return true;
  }

  /** The size of a picture of one model. */
  part(layout) {
    return layout === LAYOUTS.side ? [Math.max(1, Math.floor(this.width / 2)), this.height] : [this.width, this.height];
  }

  target(which, width, height) {
    const samples = width * height > FINE_PIXELS ? 2 : 4;
    let target = this.targets[which];
    if (target?.samples !== samples) {
      target?.dispose();
      target = new WebGLRenderTarget(width, height, { type: HalfFloatType, samples });
      this.targets[which] = target;
    }
    target.setSize(width, height);
    return target;
  }

  choose({ light, channel, turn }) {
    const chosen = CHANNELS.find((c) => c.key === channel), lamp = LIGHTS.find((l) => l.key === light);
    this.lights.choose(light, turn);
    turnStudio(turn);
    const code = chosen.key === 'lit' ? lamp.shaded : chosen.code;
    this.showsGlass = showsGlass(code);
    show(code);
    return chosen.isColor ?? false;
  }

  /** Draws one model into a target. */
  picture(which, target, camera, { wireframe, ink, background }) {
    const scene = this.scenes[which], { renderer } = this;
    const owners = which === 0 ? this.levels.models : [this.compare];
    // What is seen through glass needs something behind it.
    scene.background = this.showsGlass && owners.some((model) => model.hasTransmission) ? new Color().setRGB(...background, 'srgb') : null;
    renderer.setRenderTarget(target);
    renderer.setClearColor(0x000000, 0);
    renderer.autoClear = true;
    setOffset(owners, wireframe);
    renderer.render(scene, camera);
    this.drawCalls[which] = renderer.info.render.calls;
    // Alpha of cut borders has chosen their samples; each sample that is left is there wholly.
    if (target.samples > 0 && owners.some((model) => model.isCut)) {
      Object.assign(this.cover, { polygonOffset: wireframe, ...OFFSET });
      this.over(scene, camera, this.cover);
    }
    if (!wireframe) return;
    this.wire.color.set(ink);
    this.wireFollows(owners.some((model) => model.showsMaps));
    this.over(scene, camera, this.wire);
  }

  /** Draws everything once more, over what is there. */
  over(scene, camera, material) {
    this.renderer.autoClear = false;
    scene.background = null;
    scene.overrideMaterial = material;
    this.renderer.render(scene, camera);
    scene.overrideMaterial = null;
    this.renderer.autoClear = true;
  }

  /** Draws what the page shows. */
  draw(options) {
    const { layout, uv } = options;
    if (uv) return this.drawUv(options);
    const isColor = this.choose(options);
    const [width, height] = this.part(layout), camera = this.view.at(width / height);
    const wanted = { [LAYOUTS.first]: [0], [LAYOUTS.second]: [1] }[layout] ?? [0, 1];
    const began = performance.now();
    for (const which of wanted) {
      const work = () => this.picture(which, this.target(which, width, height), camera, options);
      if (which === wanted[0]) this.timer.run(work);
      else work();
    }
    this.composer.draw({
      first: this.targets[0]?.texture ?? null, second: this.targets[1]?.texture ?? null, layout, isColor,
      tone: options.tone, split: options.split, exposure: options.exposure, background: options.background,
    });
    this.milliseconds = performance.now() - began;
  }

  /** Waits for what was drawn; a picture takes the graphics processor longer than it takes to ask for it. */
  finish() {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  drawUv({ background, uvLines }) {
    const { renderer } = this, target = this.target(0, this.width, this.height);
    this.uv.showLines(uvLines);
    renderer.setRenderTarget(target);
    renderer.setClearColor(0x000000, 0);
    renderer.render(this.uv.scene, this.uv.at(this.width / this.height));
    this.composer.draw({ first: target.texture, layout: LAYOUTS.first, isColor: false, background });
  }

  /** PSNR of the current view, both models as the screen shows them; needs both to be loaded. */
  async measure(options) {
    const isColor = this.choose(options), [width, height] = this.part(options.layout);
    const camera = this.view.at(width / height), pixels = [];
    for (const which of [0, 1]) {
      const target = this.target(which, width, height);
      this.picture(which, target, camera, { ...options, wireframe: false });
      this.measured[which] ??= new WebGLRenderTarget(width, height, { type: UnsignedByteType, depthBuffer: false });
      this.measured[which].setSize(width, height);
      this.composer.draw({
        first: target.texture, layout: LAYOUTS.first, isColor, tone: options.tone, exposure: options.exposure,
        background: options.background,
      }, this.measured[which]);
      pixels.push(new Uint8Array(4 * width * height));
    }
    const read = (which) => this.renderer
      .readRenderTargetPixelsAsync(this.measured[which], 0, 0, width, height, pixels[which]);
    await Promise.all([read(0), read(1)]);
    return psnr(pixels[0], pixels[1]);
  }

  /**
   * A picture like those of `parbake eval`: square, with a camera in `direction` that looks at the middle of the
   * common frame, each pixel the mean of `supersample`² samples in linear light. Gives `size`² RGBA bytes, row 0 on top.
   */
  still({ direction, size = 256, supersample = 2, radius = 3.5, which = 0, light = 'studio', channel = 'lit', background = 0 }) {
    const isColor = this.choose({ light, channel, turn: 0 });
    const encode = (x) => (!isColor ? x : x > 0.0031308 ? 1.055 * x ** (1 / 2.4) - 0.055 : 12.92 * x);
    const fine = size * supersample, target = new WebGLRenderTarget(fine, fine, { type: FloatType });
    const camera = this.view.at(1).clone();
    camera.position.set(...direction).normalize().multiplyScalar(radius);
    camera.up.set(0, 1, 0);
    camera.lookAt(0, 0, 0);
    camera.near = 0.05;
    camera.far = radius + 4;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    // Glass shows a picture of these pixels, whatever the samples: roughness blurs by a share of its width.
    this.renderer.transmissionResolutionScale = 1 / supersample;
    try {
      this.picture(which, target, camera, { wireframe: false, background: Array(3).fill(encode(background)) });
    } finally {
      this.renderer.transmissionResolutionScale = 1;
    }
    const raw = new Float32Array(4 * fine * fine);
    this.renderer.readRenderTargetPixels(target, 0, 0, fine, fine, raw);
    target.dispose();
    const out = new Uint8ClampedArray(4 * size * size), share = 1 / (supersample * supersample);
    for (let y = 0; y < size; y++)
      for (let x = 0; x < size; x++) {
        const sum = [0, 0, 0, 0];
        for (let j = 0; j < supersample; j++)
          for (let i = 0; i < supersample; i++) {
            const from = 4 * ((fine - 1 - (y * supersample + j)) * fine + x * supersample + i);
            for (let k = 0; k < 4; k++) sum[k] += raw[from + k] * share;
          }
        const to = 4 * (y * size + x);
        for (let k = 0; k < 3; k++) out[to + k] = 255 * encode(sum[k] + (1 - sum[3]) * background);
        out[to + 3] = 255;
      }
    return out;
  }
}

// Lines of triangles lie on them: these step back a little.
const OFFSET = { polygonOffsetFactor: 1, polygonOffsetUnits: 1 };

function setOffset(models, isOn) {
  for (const model of models) {
    if (!model || model.isOffset === isOn) continue;
    model.isOffset = isOn;
    model.root.traverse((object) => {
      for (const material of [object.material ?? []].flat())
        Object.assign(material, { polygonOffset: isOn, ...OFFSET });
    });
  }
}

/** Components of a colour as `#rrggbb`, 0 to 1, as they are stored. */
export function rgb(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}

