// Mouse, pen, touch and wheel on one element, as three gestures: turn, move, zoom.

/**
 * `turn(dx, dy)` and `move(dx, dy)` are in CSS pixels, `zoom(factor, x, y)` about a point of the element.
 * One pointer turns; with shift, control or another button, or with two fingers, it moves. The wheel zooms where
 * `takesWheel()`.
 */
export function listenToGestures(element, { turn, move, zoom, takesWheel = () => true }) {
  const pointers = new Map();
  const middle = () => {
    const all = [...pointers.values()];
    const x = all.reduce((sum, p) => sum + p.x, 0) / all.length, y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
    const spread = all.length > 1 ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 0;
    return { x, y, spread };
  };
  element.addEventListener('pointerdown', (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    element.classList.add('grabbed');
  });
  element.addEventListener('pointermove', (event) => {
    if (!pointers.has(event.pointerId)) return;
    const before = middle();
    pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    const after = middle(), dx = after.x - before.x, dy = after.y - before.y;
    if (pointers.size > 1) {
      move(dx, dy);
      if (before.spread > 0 && after.spread > 0) zoom(before.spread / after.spread, after.x, after.y);
    } else if (event.buttons & 6 || event.shiftKey || event.ctrlKey || event.metaKey) move(dx, dy);
    else turn(dx, dy);
  });
  const release = (event) => {
    pointers.delete(event.pointerId);
    if (!pointers.size) element.classList.remove('grabbed');
  };
  element.addEventListener('pointerup', release);
  element.addEventListener('pointercancel', release);
  element.addEventListener('contextmenu', (event) => event.preventDefault());
  element.addEventListener('wheel', (event) => {
    if (!takesWheel()) return;
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    zoom(Math.exp(Math.max(-120, Math.min(120, event.deltaY * lines)) * 0.0018), event.offsetX, event.offsetY);
  }, { passive: false });
}
