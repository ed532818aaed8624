// The controls: what the user chooses goes into the store, what the store says is shown.
import { TONES } from './compose.js';
import { LIGHTS } from './lights.js';
import { CHANNELS } from './materials.js';
import { bytes, byId, check, count, options, radios } from './dom.js';

export const BACKGROUNDS = [['page', 'As the page'], ['black', 'Black'], ['grey', 'Grey'], ['white', 'White']];
export const MODES = [
  ['model', 'Model'], ['high', 'High-poly'], ['split', 'Split'], ['side', 'Side by side'],
  ['difference', 'Difference'], ['uv', 'UV layout'],
];

/** Modes that need a second model. */
export const needsCompare = (mode) => !['model', 'uv'].includes(mode);

/** Wires all controls that only set a value of the store. */
export function wirePanel(store) {
  radios(byId('channels'), 'channel', CHANNELS.map((c) => [c.key, c.label]), (channel) => store.set({ channel }));
  options(byId('light'), LIGHTS.map((light) => [light.key, light.label]));
  options(byId('tone'), TONES);
  options(byId('background'), BACKGROUNDS);
  for (const id of ['light', 'tone', 'background'])
    byId(id).addEventListener('change', (event) => store.set({ [id]: event.target.value }));
  for (const id of ['wireframe', 'parallax', 'turntable', 'uvLines'])
    byId(id).addEventListener('change', (event) => store.set({ [id]: event.target.checked }));
  for (const id of ['turn', 'exposure'])
    byId(id).addEventListener('input', (event) => store.set({ [id]: Number(event.target.value) }));

  store.on(['mode'], ({ mode }) => {
    check(byId('modes'), mode);
    byId('uv-section').hidden = mode !== 'uv';
    byId('divider').hidden = mode !== 'side';
    for (const section of document.querySelectorAll('.scene-only')) section.hidden = mode === 'uv';
  });
  store.on(['channel'], ({ channel }) => check(byId('channels'), channel));
  store.on(['light', 'tone', 'background'], (values) => {
    for (const id of ['light', 'tone', 'background']) byId(id).value = values[id];
  });
  store.on(['wireframe', 'parallax', 'turntable', 'uvLines'], (values) => {
    for (const id of ['wireframe', 'parallax', 'turntable', 'uvLines']) byId(id).checked = values[id];
  });
  store.on(['turn', 'exposure'], ({ turn, exposure }) => {
    byId('turn').value = turn;
    byId('exposure').value = exposure;
    byId('turn-value').textContent = `${turn}°`;
    byId('exposure-value').textContent = `${exposure > 0 ? '+' : ''}${exposure} EV`;
  });
}

/** The rows of the table of figures. `first` and `second` are figures with bytes and draw calls, or null. */
export function showFigures(first, second, gpu) {
  const rows = [
    ['Triangles', (f) => count(f.triangles)], ['Vertices', (f) => count(f.vertices)],
    ['Draw calls', (f) => (f.drawCalls ? count(f.drawCalls) : '–')], ['Materials', (f) => count(f.materials)],
    ['Textures', (f) => count(f.textures)], ['Texels', (f) => count(f.texels)], ['File', (f) => (f.bytes === null ? '–' : bytes(f.bytes))],
  ];
  const body = byId('figures').tBodies[0];
  for (const head of byId('figures').querySelectorAll('.second')) head.hidden = !second;
  body.replaceChildren(...[...rows.map(([name, of]) => [name, of(first), second ? of(second) : null]), gpu]
    .filter(Boolean)
    .map(([name, ...values]) => {
      const row = document.createElement('tr'), head = document.createElement('th');
      head.scope = 'row';
      head.textContent = name;
      row.append(head);
      for (const value of values) if (value !== null) row.insertCell().textContent = value;
      return row;
    }));
}

export function showNotes(notes) {
  byId('notes-section').hidden = notes.length === 0;
  byId('notes').replaceChildren(...notes.map((note) => {
    const item = document.createElement('li');
    item.textContent = note;
    return item;
  }));
}
