// Frames of `parbake turntable`: what the CPU renders, as an animated PNG of eight bits, RGB, each frame the rectangle
// that changed.
import zlib from 'node:zlib';

/** Undoes the filters of a PNG's rows, three bytes a pixel. */
function unfilter(data, width, height) {
  const stride = 3 * width, out = Buffer.alloc(stride * height);
  for (let y = 0; y < height; y++) {
    const filter = data[y * (stride + 1)];
    for (let x = 0; x < stride; x++) {
      const left = x >= 3 ? out[y * stride + x - 3] : 0, up = y ? out[(y - 1) * stride + x] : 0;
      const corner = x >= 3 && y ? out[(y - 1) * stride + x - 3] : 0;
      const p = left + up - corner, [a, b, c] = [Math.abs(p - left), Math.abs(p - up), Math.abs(p - corner)];
      const guess = [0, left, up, (left + up) >> 1, a <= b && a <= c ? left : b <= c ? up : corner][filter];
      out[y * stride + x] = data[y * (stride + 1) + 1 + x] + guess;
    }
  }
  return out;
}

/** All frames, whole: `{ width, height, frames }`, each of RGB bytes, row 0 on top. */
export function readFilm(bytes) {
  let at = 8, width = 0, height = 0, control = null, parts = [];
  const frames = [];
  const finish = () => {
    if (!control || !parts.length) return;
    const data = unfilter(zlib.inflateSync(Buffer.concat(parts)), control.width, control.height);
    const frame = frames.length ? Buffer.from(frames.at(-1)) : Buffer.alloc(3 * width * height);
    for (let y = 0; y < control.height; y++)
      data.copy(frame, 3 * ((control.top + y) * width + control.left), 3 * control.width * y, 3 * control.width * (y + 1));
    frames.push(frame);
    parts = [];
  };
  while (at < bytes.length) {
    const length = bytes.readUInt32BE(at), kind = bytes.toString('latin1', at + 4, at + 8), body = bytes.subarray(at + 8, at + 8 + length);
    if (kind === 'IHDR') [width, height] = [body.readUInt32BE(0), body.readUInt32BE(4)];
    if (kind === 'fcTL') {
      finish();
      const [w, h, left, top] = [4, 8, 12, 16].map((place) => body.readUInt32BE(place));
      control = { width: w, height: h, left, top };
    }
    if (kind === 'IDAT') parts.push(body);
    if (kind === 'fdAT') parts.push(body.subarray(4));
    at += 12 + length;
  }
  finish();
  return { width, height, frames };
}
