// A bake that is followed while it runs: what it tells, and its newest snapshot as often as this page can bear.
import { byId } from './dom.js';

/** A snapshot is shown after so many times the milliseconds that the last one took, so that the bake has the processor. */
const REST = 20;
const LONGEST_REST = 8000;
/** Pictures that take longer are drawn coarsely while the bake runs: the processor draws them, and the bake needs it. */
export const SLOW_PICTURE = 60;
/** Milliseconds more between news there. */
const SLOW_NEWS = 2500;
const GONE = 'The bake was ended before it was finished.';

/** A request that fails may be this machine waking up: so many times it is tried again, a second later. */
const RETRIES = 5;
/** While the last model is put on the stage, the command is told so often that this page is still there. */
const PING = 2000;

/**
 * Follows the run until it ends. `tell(state)` is called with all that is known of it; `canShow()` says whether the stage
 * could take a snapshot; `show(bytes, state)` puts one there and gives the milliseconds that this took, and whether that
 * was slow: `{ took, isSlow }`. `others` is a promise: once it is settled, nothing else
 * is asked of the command, which may then end.
 */
export async function follow({ tell, canShow, show, others }) {
  let state = { version: 0 }, shown = 0, next = 0, isSlow = true, failed = 0;
  for (;;) {
    const asked = canShow() && performance.now() >= next ? 'look' : 'news';
    const told = await fetch(`run/${asked}/${state.version}`).then((r) => r.json()).catch(() => null);
    failed = told ? 0 : failed + 1;
    if (failed && failed <= RETRIES) {
      await new Promise((wait) => setTimeout(wait, 1000));
      continue;
    }
    state = told ?? { ...state, failure: GONE };
    tell(state);
    const isOver = state.isFinished || state.failure;
    if (state.snapshot > shown && (asked === 'look' || isOver)) {
      const ping = isOver && setInterval(() => fetch(`run/news/${state.version}`).catch(() => {}), PING);
      const bytes = await fetch('run/snapshot').then((r) => (r.ok ? r.arrayBuffer() : null)).catch(() => null);
      if (bytes) {
        shown = state.snapshot;
        const { took, ...rest } = await show(bytes, state);
        next = performance.now() + Math.min(LONGEST_REST, REST * took);
        isSlow = rest.isSlow;
      }
      clearInterval(ping);
    }
    if (!isOver) {
      // What is told is drawn as well.
      if (isSlow && performance.now() < next) await new Promise((wait) => setTimeout(wait, SLOW_NEWS));
      continue;
    }
    // The command waits for this before it ends, and a request that is still on its way would be lost.
    await others;
    await fetch('run/shown').catch(() => {});
    return;
  }
}

/** A promise that is kept or broken from outside. */
export function deferred() {
  const all = {};
  all.promise = new Promise((resolve, reject) => Object.assign(all, { resolve, reject }));
  return all;
}

const capital = (text) => text[0].toUpperCase() + text.slice(1);
const percent = (share) => `${Math.round(100 * share)} %`;
const time = (seconds) => (seconds < 90 ? `${Math.round(seconds)} s` : `${Math.round(seconds / 60)} min`);

/** Says in words and pictures how the run goes. */
export function showRun(name, state) {
  const { stage, part, done, secondsLeft, seconds, curves = [], isFinished, failure } = state;
  const left = secondsLeft === null || secondsLeft === undefined ? '' : `, ${time(secondsLeft)} left`;
  const what = failure ? 'Failed' : isFinished ? `Finished in ${time(seconds)}` : [part, stage].filter(Boolean).join(': ') || 'Starting';
  const sentence = capital(what);
  byId('run-section').hidden = false;
  if (byId('run-stage').textContent !== sentence) byId('run-stage').textContent = sentence;
  const progress = isFinished ? 1 : done ?? 0;
  byId('run-progress').value = progress;
  byId('run-progress').hidden = Boolean(failure);
  const share = isFinished || failure || done === null || done === undefined ? '' : percent(done) + left;
  byId('run-left').textContent = share && left.slice(2);
  byId('run-reading').hidden = false;
  byId('run-reading').classList.toggle('failed', Boolean(failure));
  byId('run-text').textContent = [sentence, share].filter(Boolean).join(', ');
  document.title = `${failure ? 'Failed' : isFinished ? 'Finished' : percent(progress)} – ${name} – Parbake`;
  showErrors(curves);
}

let drawn = '', last = [];
new ResizeObserver(() => { drawn = ''; showErrors(last); }).observe(byId('run-figure'));

/** What stages minimise, over time; drawn anew where there is more of it. */
function showErrors(curves) {
  last = curves;
  const errors = curves.map(error).filter((curve) => curve.points.length > 1);
  byId('run-figure').hidden = errors.length === 0;
  const key = JSON.stringify([errors.length, errors.at(-1)?.points, document.documentElement.dataset.theme]);
  if (!errors.length || key === drawn || !byId('run-chart').clientWidth) return;
  drawn = key;
  drawCurves(byId('run-chart'), errors);
}

/** A curve as shares of what it began with, each the mean of its neighbourhood: views change from step to step. */
function error({ stage, points }) {
  const reach = Math.floor(points.length / 16);
  const mean = (from, to) => {
    const some = points.slice(Math.max(0, from), to + 1);
    return some.reduce((sum, [, value]) => sum + value, 0) / some.length;
  };
  const first = mean(0, reach);
  const share = (_, k) => mean(k - reach, k + reach) / first;
  return { stage, points: first > 0 ? points.map(([second], k) => [second, share(null, k)]) : [] };
}

/** Errors over time, on a logarithmic scale whose top is where each began. */
function drawCurves(canvas, errors) {
  const ratio = window.devicePixelRatio || 1, [width, height] = [canvas.clientWidth, canvas.clientHeight];
  Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
  const context = canvas.getContext('2d'), style = getComputedStyle(canvas);
  const [begin, end] = [errors[0].points[0][0], errors.at(-1).points.at(-1)[0]];
  const lowest = Math.min(0.5, ...errors.flatMap(({ points }) => points.map(([, share]) => share)).filter((share) => share > 0));
  const x = (second) => 2 + ((second - begin) / Math.max(1e-3, end - begin)) * (width - 4);
  const y = (share) => 2 + Math.min(1, Math.max(0, Math.log(Math.max(share, lowest)) / Math.log(lowest))) * (height - 4);
  context.scale(ratio, ratio);
  context.lineWidth = 1;
  context.strokeStyle = style.getPropertyValue('--line');
  context.beginPath();
  for (const at of [2, height - 2]) context.moveTo(0, at), context.lineTo(width, at);
  context.stroke();
  context.lineWidth = 1.5;
  context.lineJoin = 'round';
  errors.forEach(({ points }, index) => {
    context.strokeStyle = style.getPropertyValue(index === errors.length - 1 ? '--accent' : '--muted');
    context.beginPath();
    for (const [second, share] of points) context.lineTo(x(second), y(share));
    context.stroke();
  });
}
