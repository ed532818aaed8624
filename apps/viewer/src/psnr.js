// Peak signal-to-noise ratio of two pictures of the same size, RGBA bytes.

/** In dB over all pixels and three channels; Infinity where they are the same. */
export function psnr(a, b) {
  let sum = 0;
  for (let i = 0; i < a.length; i += 4) {
    const r = a[i] - b[i], g = a[i + 1] - b[i + 1], c = a[i + 2] - b[i + 2];
    sum += r * r + g * g + c * c;
  }
  return 10 * Math.log10((255 * 255) / (sum / ((a.length / 4) * 3)));
}
