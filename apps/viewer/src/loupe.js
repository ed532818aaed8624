// What is small on the screen, enlarged beside it, pixel by pixel.
import { byId } from './dom.js';

/** Models that span fewer pixels than this are enlarged. */
const MOST = 140;

/** Enlarges the middle of a picture that was just drawn; `pixels` is how many of them the model spans. */
export function showLoupe(canvas, pixels, isWanted) {
  const loupe = byId('loupe');
  loupe.hidden = !isWanted || pixels > MOST;
  if (loupe.hidden) return;
  const target = byId('loupe-canvas'), context = target.getContext('2d');
  const times = Math.max(1, Math.floor(target.width / Math.max(16, pixels * 1.1))), side = target.width / times;
  context.imageSmoothingEnabled = false;
  const x = Math.round((canvas.width - side) / 2), y = Math.round((canvas.height - side) / 2);
  context.drawImage(canvas, x, y, side, side, 0, 0, target.width, target.height);
  byId('loupe-text').textContent = `enlarged ${times} times`;
}
