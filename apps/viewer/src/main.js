// The page of `parbake view`: loads the session's models, and draws what the controls ask for.
import { LAYOUTS, HEAT, HEAT_MOST, TONES } from './compose.js';
import { CHANNELS } from './materials.js';
import { LIGHTS } from './lights.js';
import { createLoader, fetchModel } from './load.js';
import { createStore } from './store.js';
import { Levels } from './levels.js';
import { showLoupe } from './loupe.js';
import { listenToGestures } from './gestures.js';
import { MODES, needsCompare, showFigures, showNotes, wirePanel } from './panel.js';
import { SLOW_PICTURE, deferred, follow, showRun } from './run.js';
import { Stage, rgb } from './stage.js';
import { byId, check, count, options, radios } from './dom.js';
import { wireAnimation } from './animation.js';
import { wireKeys } from './keys.js';
import { wireSplitter } from './splitter.js';
import { wireTheme } from './theme.js';

/** A picture that has not changed for so many milliseconds is measured. */
const RESTING = 250;
/** After so many milliseconds it is said that loading takes a while. */
const SLOW = 8000;
/** What a picture depends on. */
const DRAWN = ['mode', 'channel', 'wireframe', 'parallax', 'light', 'turn', 'exposure', 'tone', 'background', 'split', 'level', 'theme', 'uvLines'];
const store = createStore({
  mode: 'model', channel: 'lit', wireframe: false, parallax: true, light: 'studio', turn: 0, exposure: 0, tone: 'none',
  background: 'page', split: 0.5, level: 'auto', turntable: false, uvLines: true, theme: 'light', isReady: false, hasCompare: false,
});
/** When the models are on the stage and all is wired. */
const ready = deferred();
const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
let stage, animation, levels = null, compare = null, drawing = 0, resting = 0, measuring = 0, measured = 0, textures = [], isListed = false, runNotes = [], isSlow = false, isRun = false, toldNotes = null;
/** Models that are shown no more. */
const retired = [];

/** All that a picture depends on besides the camera. */
function drawOptions() {
  const s = store.get();
  const background = { page: rgb(color('--viewport')), black: [0, 0, 0], white: [1, 1, 1], grey: rgb('#bcbcbc') }[s.background];
  return {
    layout: { high: LAYOUTS.second, split: LAYOUTS.split, side: LAYOUTS.side, difference: LAYOUTS.difference }[s.mode] ?? LAYOUTS.first,
    uv: s.mode === 'uv', channel: s.channel, light: s.light, turn: (s.turn * Math.PI) / 180, wireframe: s.wireframe,
    ink: color('--wire'), exposure: 2 ** s.exposure, tone: TONES.findIndex(([key]) => key === s.tone), split: s.split, background,
    uvLines: s.uvLines,
  };
}

function draw() {
  drawing = 0;
  if (!store.get().isReady) return;
  stage.resize();
  const { level } = store.get(), shorter = Math.min(stage.width, stage.height);
  const pixels = stage.view.pixels(shorter);
  const wanted = level === 'auto' ? levels.forSize(pixels, stage.width, stage.height) : level;
  if (wanted !== levels.shown) levels.show(wanted);
  stage.draw(drawOptions());
  // Only now, since the models that took their places have their shaders in common with them.
  retired.splice(0).forEach((model) => model.dispose());
  showLoupe(byId('canvas'), pixels, ['model', 'high', 'split', 'difference'].includes(store.get().mode));
  showSize(pixels, shorter);
  showTags();
  clearTimeout(resting);
  resting = 0;
  if (!animation.isPlaying() && !store.get().turntable) resting = setTimeout(rest, RESTING);
}

/** After the picture has stood still for a moment: what takes too long to be told for each frame. */
async function rest() {
  resting = 0;
  const run = ++measuring;
  const waits = stage.timer.poll();
  showAllFigures();
  const { mode, hasCompare } = store.get();
  if (hasCompare && mode !== 'uv' && !isSlow) {
    const decibels = await stage.measure(drawOptions());
    if (run !== measuring) return;
    byId('psnr').textContent = Number.isFinite(decibels) ? `${decibels.toFixed(2)} dB` : 'the same picture';
    byId('reading').hidden = false;
    showAllFigures();
  }
  if (waits) setTimeout(() => { stage.timer.poll(); showAllFigures(); }, RESTING);
  measured = run;
}

/** When the picture that is wanted now has been drawn and measured. */
async function settled() {
  do await new Promise((wait) => setTimeout(wait, 20)); while (drawing || resting || measured !== measuring);
}

function redraw() {
  measuring++;
  if (!drawing) drawing = requestAnimationFrame(draw);
}

/** Whether pictures take so long that they are drawn coarsely, and not measured. */
function setSlow(value) {
  if (value === isSlow) return;
  isSlow = value;
  stage.sharpness = isSlow ? 0.5 : 1;
  redraw();
}

/** Draws, waits for it, and tells how many milliseconds that took. */
function drawNow() {
  const began = performance.now();
  draw();
  stage.finish();
  return performance.now() - began;
}

function showSize(pixels, shorter) {
  const [least, most] = [12, shorter * 8];
  byId('size').value = (1000 * Math.log(pixels / least)) / Math.log(most / least);
  byId('size-value').textContent = `${count(pixels)} px`;
  byId('size').setAttribute('aria-valuetext', `${Math.round(pixels)} pixels`);
}

function showTags() {
  const { mode, hasCompare } = store.get(), both = ['split', 'side'].includes(mode);
  const [first, second] = [byId('label-first'), byId('label-second')];
  const level = levels.count > 1 ? (levels.shown === null ? ', too small to be drawn' : `, level ${levels.shown}`) : '';
  const triangles = levels.shown === null ? 0 : levels.figures[levels.shown].triangles;
  first.hidden = !(both || levels.count > 1) || mode === 'uv' || mode === 'high';
  first.textContent = `${levels.model().name}${level} · ${count(triangles)} triangles`;
  second.hidden = !hasCompare || !(both || mode === 'high');
  if (hasCompare) second.textContent = `${compare.name} · ${count(compare.known.triangles)} triangles`;
}

function showAllFigures() {
  const none = { triangles: 0, vertices: 0, materials: 0, textures: 0, texels: 0 };
  const first = { ...(levels.shown === null ? none : levels.figures[levels.shown]), bytes: levels.model().bytes, drawCalls: stage.drawCalls[0] };
  const second = compare && { ...compare.known, bytes: compare.bytes, drawCalls: stage.drawCalls[1] };
  const { timer, milliseconds } = stage;
  const gpu = timer.isAvailable ? ['GPU time', timer.milliseconds === null ? '–' : `${timer.milliseconds.toFixed(2)} ms`]
    : ['Frame', milliseconds === null ? '–' : `${milliseconds.toFixed(1)} ms`];
  showFigures(first, second, gpu);
}

function listTextures() {
  const list = [];
  for (const [owner, model] of [['Model', levels.model()], ['High-poly', compare]]) {
    if (!model) continue;
    const found = model.textures();
    for (const entry of found) {
      const { width, height } = entry.texture.image;
      list.push({ model, owner, entry, label: `${entry.label}, ${width} × ${height} (${[owner, entry.material].filter(Boolean).join(', ')})` });
    }
    if (!found.length) list.push({ model, owner, entry: null, label: `No texture (${owner})` });
  }
  const same = (a, b) => a.entry?.label === b?.entry?.label && a.owner === b?.owner, before = textures[byId('texture').value];
  [textures, isListed] = [list, true];
  const labels = list.map((item) => item.label);
  if (labels.join('\n') !== [...byId('texture').options].map((option) => option.text).join('\n'))
    options(byId('texture'), labels.map((label, index) => [index, label]));
  const index = Math.max(0, list.findIndex((item) => same(item, before)));
  byId('texture').value = index;
  showTexture(index);
}

function showTexture(index) {
  const { model, entry } = textures[index];
  stage.uv.show(entry, model.meshes());
  redraw();
}

function fail(error) {
  byId('message').hidden = true;
  byId('failure').hidden = false;
  byId('failure-text').textContent = error.message ?? String(error);
  if (isRun) byId('failure-title').textContent = 'The bake has failed';
  byId('failure-hint').hidden = isRun;
  // There is nothing to set.
  document.body.classList.add('failed');
  byId('panel-toggle').hidden = true;
}

function warn(text) {
  byId('banner-text').textContent = text;
  byId('banner').hidden = false;
}

function wireView() {
  const canvas = byId('canvas');
  const shorter = () => Math.min(canvas.clientWidth, canvas.clientHeight);
  const isUv = () => store.get().mode === 'uv';
  // Side by side, each half is a picture of its own.
  listenToGestures(canvas, {
    turn(dx, dy) {
      if (isUv()) stage.uv.move(dx, dy, shorter());
      else stage.view.orbit(-dx * 0.008, dy * 0.008);
      redraw();
    },
    move(dx, dy) {
      if (isUv()) stage.uv.move(dx, dy, shorter());
      else stage.view.pan(dx / shorter(), dy / shorter());
      redraw();
    },
    zoom(factor, x, y) {
      if (isUv()) stage.uv.zoom(factor, (x - canvas.clientWidth / 2) / shorter(), (y - canvas.clientHeight / 2) / shorter());
      else stage.view.zoom(factor);
      redraw();
    },
  });
  canvas.addEventListener('dblclick', fit);
  for (const id of ['fit', 'fit-uv']) byId(id).addEventListener('click', fit);
  byId('size').addEventListener('input', (event) => {
    const side = Math.min(stage.width, stage.height), [least, most] = [12, side * 8];
    stage.view.setPixels(least * (most / least) ** (event.target.value / 1000), side);
    redraw();
  });
  byId('texture').addEventListener('change', (event) => showTexture(Number(event.target.value)));
  new ResizeObserver(redraw).observe(canvas);
}

function fit() {
  if (store.get().mode === 'uv') stage.uv.fit();
  else stage.view.fit();
  redraw();
}

/** Keys on the picture itself; whether this was one. */
function canvasKeys({ key }) {
  const isUv = store.get().mode === 'uv', step = 0.12;
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  if (arrows[key]) {
    const [x, y] = arrows[key];
    if (isUv) stage.uv.move(-40 * x, 40 * y, 1000);
    else stage.view.orbit(x * step, y * step);
  } else if (key === '+' || key === '=' || key === '-') {
    const factor = key === '-' ? 1.15 : 1 / 1.15;
    if (isUv) stage.uv.zoom(factor, 0, 0);
    else stage.view.zoom(factor);
  } else return false;
  redraw();
  return true;
}

function cycle(key, values) {
  const at = values.indexOf(store.get()[key]);
  store.set({ [key]: values[(at + 1) % values.length] });
}

function wireShortcuts(modes) {
  const settings = (isOpen) => {
    document.body.classList.toggle('panel-closed', !isOpen);
    byId('panel-toggle').setAttribute('aria-expanded', String(isOpen));
    redraw();
  };
  const toggle = () => settings(document.body.classList.contains('panel-closed'));
  byId('panel-toggle').addEventListener('click', toggle);
  settings(!matchMedia('(max-width: 760px)').matches);
  const level = (step) => {
    if (levels.count < 2) return;
    const from = store.get().level === 'auto' ? levels.shown ?? levels.count - 1 : store.get().level;
    store.set({ level: Math.min(levels.count - 1, Math.max(0, from + step)) });
  };
  wireKeys([
    [modes.map((_, i) => String(i + 1)), 'Views, from left to right', (key) => store.set({ mode: modes[Number(key) - 1] })],
    [['c'], 'Next channel', () => cycle('channel', CHANNELS.map((c) => c.key))],
    [['l'], 'Next light', () => cycle('light', LIGHTS.map((light) => light.key))],
    [['w'], 'Wireframe', () => store.set({ wireframe: !store.get().wireframe })],
    [['d'], 'Parallax maps', () => { if (!byId('parallax-switch').hidden) store.set({ parallax: !store.get().parallax }); }],
    [['r'], 'Turntable', () => store.set({ turntable: !store.get().turntable })],
    [['f'], 'Fit to view', fit],
    [['[', ']'], 'Finer or coarser level of detail', (key) => level(key === '[' ? -1 : 1)],
    [[' '], 'Play or pause the animation', () => animation.toggle()],
    [['t'], 'Light or dark', () => byId('theme').click()],
    [['p'], 'Settings', toggle],
    [['?'], 'This help', () => byId('help').showModal()],
  ], canvasKeys);
}

/** Turns while it is wanted; each frame by the time that has passed. */
function wireTurntable() {
  let last = 0;
  const step = (now) => {
    if (!store.get().turntable) return;
    stage.view.orbit(Math.min(0.1, (now - last) / 1000) * 0.6, 0);
    last = now;
    redraw();
    requestAnimationFrame(step);
  };
  store.on(['turntable'], ({ turntable }) => {
    last = performance.now();
    if (turntable) requestAnimationFrame(step);
  });
}

function wireLevels() {
  const fieldset = byId('levels');
  fieldset.hidden = levels.count < 2;
  const entries = levels.figures.map((figures, level) => [level, `${level}: ${count(figures.triangles)}`]);
  radios(fieldset, 'level', [['auto', 'By size'], ...entries], (level) => store.set({ level }));
  check(fieldset, store.get().level);
}

/** What is being viewed; fills in the names as soon as they are known. */
async function readSession() {
  const session = await fetch('session.json').then((r) => r.json()).catch(() => {
    throw new Error('parbake view no longer answers: it was ended. Start it again.');
  });
  const files = session.models.filter((model) => model.role === 'level');
  const other = session.models.find((model) => model.role === 'compare');
  const { name } = session.live ?? files[0];
  isRun = Boolean(session.live);
  byId('version').textContent = `Parbake ${session.version}.`;
  byId('title').textContent = name;
  byId('subtitle').textContent = other ? `compared with ${other.name}` : '';
  document.title = `${name} – Parbake`;
  // What turns is drawn anew all the time, which takes the bake's time where there is no graphics processor.
  byId('spinner').hidden = Boolean(session.live);
  byId('message-text').textContent = session.live ? 'The bake begins' : `Reading ${files.map((file) => file.name).join(', ')}`;
  return { files, other, run: session.live ?? null };
}

/** Loads everything onto the stage, of a run its first snapshot. Gives why the second model is missing, if it is. */
async function loadModels({ files, other, run }) {
  // While they are on their way, WebGL is started.
  const coming = files.map(fetchModel), otherComing = other && fetchModel(other);
  for (const model of [...coming, otherComing]) model?.catch(() => {});
  try {
    stage = new Stage(byId('canvas'));
  } catch {
    throw new Error('This browser has no WebGL 2, or it is switched off. Turn on hardware acceleration, or use another browser.');
  }
  const load = createLoader(stage.renderer);
  const second = otherComing ? otherComing.then(load).catch((error) => error) : null;
  const others = Promise.allSettled([otherComing]);
  const firsts = run ? [await firstSnapshot(run, load, others)] : await Promise.all(coming.map((model) => model.then(load)));
  const found = await second, problem = found instanceof Error ? found.message : null;
  compare = problem ? null : found;
  levels = new Levels(firsts);
  if (compare) compare.known = compare.figures();
  stage.setModels(levels, compare);
  return problem;
}

/** Follows a run from now on; gives its first snapshot. The run's command is let go once `others` have come. */
function firstSnapshot(run, load, others) {
  const first = deferred();
  let isFirst = true, before = Infinity;
  const tell = (state) => {
    showRun(run.name, state);
    runNotes = state.warnings ?? runNotes;
    if (state.failure) setSlow(false);
    if (state.failure) store.get().isReady ? warn(state.failure) : first.reject(new Error(state.failure));
    if (store.get().isReady) tellNotes();
    else write(byId('message-text'), byId('run-stage').textContent);
  };
  const show = async (bytes, { bytes: size = null, isFinished }) => {
    const began = performance.now();
    const model = await load({ entry: run, bytes, size, notes: [] }).catch((error) => {
      if (isFirst) first.reject(error);
      else warn(error.message);
    });
    if (!model) {
      setSlow(!isFinished && isSlow);
      return { took: performance.now() - began, isSlow };
    }
    const loaded = performance.now() - began;
    if (isFirst) first.resolve(model);
    isFirst = false;
    await ready.promise;
    if (levels.model() !== model) replace(model, isFinished);
    const drawn = drawNow();
    // The first picture compiles shaders.
    setSlow(!isFinished && Math.min(drawn, before) > SLOW_PICTURE);
    before = drawn;
    return { took: loaded + drawn, isSlow };
  };
  setSlow(true);
  // A second snapshot waits until the first one stands there, beside the high-poly.
  follow({ tell, canShow: () => isFirst || store.get().isReady, show, others }).catch(first.reject);
  return first.promise;
}

/** Shows another model in the place of the one before. */
function replace(model, isLast) {
  const before = levels;
  levels = new Levels([model]);
  stage.setLevels(levels);
  model.setParallax(store.get().parallax);
  byId('parallax-switch').hidden = !shownModels().some((shown) => shown.parallax.length);
  if (store.get().mode === 'uv') listTextures();
  else isListed = false;
  retired.push(...before.models);
  if (isLast) {
    animation.setModels(shownModels());
    wireLevels();
  }
  tellNotes();
  redraw();
}

/** Sets a text where it is another: what is told anew is read out anew. */
function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

const shownModels = () => [...levels.models, compare].filter(Boolean);

function tellNotes() {
  const notes = [...new Set([...shownModels().flatMap((model) => model.notes), ...runNotes])];
  if (notes.join('\n') === toldNotes) return;
  toldNotes = notes.join('\n');
  showNotes(notes);
}

/** Wires what depends on the models. */
function wireModels() {
  animation = wireAnimation(redraw);
  animation.setModels(shownModels());
  const modes = MODES.filter(([key]) => compare || !needsCompare(key));
  radios(byId('modes'), 'mode', modes, (mode) => store.set({ mode }));
  byId('modes').disabled = false;
  wireSplitter(store);
  wireLevels();
  store.on(['level'], ({ level }) => check(byId('levels'), level));
  wireView();
  wireTurntable();
  wireShortcuts(modes.map(([key]) => key));
  byId('parallax-switch').hidden = !shownModels().some((model) => model.parallax.length);
  store.on(['parallax'], ({ parallax }) => { for (const model of shownModels()) model.setParallax(parallax); });
  store.set({ isReady: true, hasCompare: compare !== null, mode: compare ? 'split' : 'model' });
  store.on(['mode', 'hasCompare'], ({ mode, hasCompare }) => {
    byId('legend').hidden = mode !== 'difference';
    if (!hasCompare || mode === 'uv') byId('reading').hidden = true;
    if (mode === 'uv' && !isListed) listTextures();
    check(byId('modes'), mode);
  });
  store.on(DRAWN, redraw);
  ready.resolve();
}

async function start() {
  wirePanel(store);
  wireTheme(store);
  byId('legend-ramp').style.background = `linear-gradient(90deg, ${HEAT.join(', ')})`;
  byId('legend-most').textContent = `${Math.round(HEAT_MOST * 255)} of 255 and more`;
  byId('banner-close').addEventListener('click', () => { byId('banner').hidden = true; });
  byId('canvas').addEventListener('webglcontextlost', () => {
    fail(new Error('The graphics processor has dropped this page, most likely for want of memory. Reload the page.'));
  });
  const slow = setTimeout(() => { byId('message-text').textContent += '. Large models take a while.'; }, SLOW);
  const problem = await loadModels(await readSession());
  clearTimeout(slow);
  wireModels();
  if (problem) warn(`The model is shown by itself: ${problem}`);
  if (problem) runNotes = [...runNotes, problem];
  tellNotes();
  draw();
  byId('message').hidden = true;
  // The studio has no extensions, but is there at once; the room takes a moment.
  if (shownModels().some((model) => model.hasExtensions)) requestAnimationFrame(() => setTimeout(() => store.set({ light: 'room' })));
  // Textures that cannot be decoded are told late.
  setTimeout(tellNotes, 1000);
  // For tests and for the console.
  window.parbake = { store, stage, redraw, settled, snapshot: () => { draw(); return byId('canvas').toDataURL(); } };
}

start().catch(fail);
