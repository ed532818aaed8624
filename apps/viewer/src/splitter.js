// The border between both pictures in the split view: dragged, or moved by arrow keys.
import { byId } from './dom.js';

export function wireSplitter(store) {
  const handle = byId('splitter');
  const move = (split) => store.set({ split: Math.min(0.98, Math.max(0.02, split)) });
  handle.addEventListener('pointerdown', (event) => {
    handle.setPointerCapture(event.pointerId);
    handle.focus({ focusVisible: false });
    event.preventDefault();
  });
  handle.addEventListener('pointermove', (event) => {
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const { left, width } = handle.parentElement.getBoundingClientRect();
    move((event.clientX - left) / width);
  });
  handle.addEventListener('keydown', (event) => {
    const steps = { ArrowLeft: -0.02, ArrowRight: 0.02, ArrowDown: -0.02, ArrowUp: 0.02, PageDown: -0.1, PageUp: 0.1 };
    const { split } = store.get();
    if (event.key in steps) move(split + steps[event.key]);
    else if (event.key === 'Home' || event.key === 'End') move(event.key === 'Home' ? 0 : 1);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  store.on(['split', 'mode'], ({ split, mode }) => {
    handle.hidden = mode !== 'split';
    handle.style.left = `${100 * split}%`;
    handle.setAttribute('aria-valuenow', String(Math.round(100 * split)));
    handle.setAttribute('aria-valuetext', `${Math.round(100 * split)} percent model`);
  });
}
