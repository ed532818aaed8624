// What it costs to shade each pixel once: PSNR of a model against its high-poly, both as the viewer's headlight shows them.
//   node test/samples.mjs --parbake COMMAND HIGH FILE
// The high-poly has nine samples a pixel, the model nine; one, with borders smoothed by four samples of coverage; one.
import { parseArgs } from 'node:util';
import { launch, settled, view, watchedPage } from './browser.mjs';

const { values, positionals: [high, file] } = parseArgs({ allowPositionals: true, options: { parbake: { type: 'string' } } });
const VIEWS = 12;
const directions = Array.from({ length: VIEWS }, (_, i) => {
  const y = 1 - (2 * (i + 0.5)) / VIEWS, r = Math.sqrt(1 - y * y), angle = i * 2.399963;
  return [r * Math.cos(angle), y, r * Math.sin(angle)];
});

/** In the page: means over all views, `{ black: [nine, smoothed, one], white: … }`. */
function measure(directions) {
  const { stage } = window.parbake, Target = stage.targets[0].constructor, size = 384, HALF_FLOAT = 1016;
  const half = (bits) => {
    const exponent = (bits >> 10) & 31, mantissa = bits & 1023;
    const value = exponent ? 2 ** (exponent - 15) * (1 + mantissa / 1024) : 2 ** -14 * (mantissa / 1024);
    return bits & 0x8000 ? -value : value;
  };
  const picture = (direction, which, fine, samples) => {
    const isColor = stage.choose({ light: 'headlight', channel: 'lit', turn: 0 }), side = size * fine;
    const target = new Target(side, side, { type: HALF_FLOAT, samples }), camera = stage.view.at(1).clone();
    camera.position.set(...direction).normalize().multiplyScalar(3.5);
    camera.lookAt(0, 0, 0);
    Object.assign(camera, { near: 0.05, far: 7.5 });
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    stage.picture(which, target, camera, { wireframe: false, background: [0, 0, 0] });
    const raw = new Uint16Array(4 * side * side), mean = new Float64Array(4 * size * size);
    stage.renderer.readRenderTargetPixels(target, 0, 0, side, side, raw);
    target.dispose();
    for (let y = 0; y < side; y++)
      for (let x = 0; x < side; x++)
        for (let k = 0; k < 4; k++)
          mean[4 * (Math.floor(y / fine) * size + Math.floor(x / fine)) + k] += half(raw[4 * (y * side + x) + k]) / fine ** 2;
    return { mean, isColor };
  };
  const shown = ({ mean, isColor }, background) => {
    const encode = (x) => Math.min(1, !isColor ? x : x > 0.0031308 ? 1.055 * x ** (1 / 2.4) - 0.055 : 12.92 * x);
    return Float64Array.from({ length: 3 * size * size }, (_, i) => {
      const pixel = 4 * Math.floor(i / 3);
      return encode(Math.max(0, mean[pixel + (i % 3)] + (1 - mean[pixel + 3]) * background));
    });
  };
  const psnr = (a, b) => -10 * Math.log10(a.reduce((sum, x, i) => sum + (x - b[i]) ** 2, 0) / a.length);
  const means = { black: [0, 0, 0], white: [0, 0, 0] };
  for (const direction of directions) {
    const reference = picture(direction, 1, 3, 0);
    [[3, 0], [1, 4], [1, 0]].forEach(([fine, samples], k) => {
      const own = picture(direction, 0, fine, samples);
      for (const [name, background] of [['black', 0], ['white', 1]])
        means[name][k] += psnr(shown(own, background), shown(reference, background)) / directions.length;
    });
  }
  return means;
}

const browser = await launch();
const { url, stop } = await view(values.parbake, [file], ['--compare', high]);
const { page } = await watchedPage(browser, { width: 400, height: 300 });
await page.goto(url);
await settled(page);
for (const [name, [nine, smoothed, one]] of Object.entries(await page.evaluate(measure, directions)))
  console.log(`on ${name}: nine samples ${nine.toFixed(2)}, one with smoothed borders ${smoothed.toFixed(2)}, one ${one.toFixed(2)} dB`);
await browser.close();
await stop();
