// The keyboard: one letter each, listed in the help.
import { byId } from './dom.js';

/** `shortcuts`: `[keys, what they do, action]`; keys as `KeyboardEvent.key` says them. */
export function wireKeys(shortcuts, canvasKeys) {
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || byId('help').open) return;
    const { target } = event;
    if (target === byId('canvas') && canvasKeys(event)) return event.preventDefault();
    // Where typing chooses or changes something, letters are not ours.
    if (target.matches('select, input[type="text"], input[type="number"]')) return;
    if (target.matches('input, button') && [' ', 'Enter'].includes(event.key)) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const found = shortcuts.find(([keys]) => keys.includes(key));
    if (!found) return;
    event.preventDefault();
    found[2](key);
  });
  const list = byId('shortcuts');
  const add = (keys, text) => {
    const term = document.createElement('dt'), told = document.createElement('dd');
    for (const key of keys) {
      const cap = document.createElement('kbd');
      cap.textContent = key === ' ' ? 'Space' : key.length === 1 ? key.toUpperCase() : key;
      term.append(cap);
    }
    told.textContent = text;
    list.append(term, told);
  };
  add(['←', '→', '↑', '↓'], 'Turn, with the picture in focus');
  add(['+', '−'], 'Zoom, with the picture in focus');
  for (const [keys, text] of shortcuts) add(keys, text);

  const dialog = byId('help');
  byId('help-open').addEventListener('click', () => dialog.showModal());
  byId('help-close').addEventListener('click', () => dialog.close());
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
}
