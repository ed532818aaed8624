// Animations of the models: one clip at a time, all models in step.
import { byId, options } from './dom.js';

export function wireAnimation(redraw) {
  let animated = [], playing = false, last = 0, time = 0, length = 0;

  const pose = () => {
    for (const model of animated) model.mixer.setTime(Math.min(time, length));
    byId('time').value = length ? time / length : 0;
    byId('time-value').textContent = `${time.toFixed(1)} s`;
    redraw();
  };
  const choose = (name) => {
    length = 0;
    time = 0;
    for (const model of animated) {
      model.mixer.stopAllAction();
      const clip = model.clips.find((c, i) => (c.name || `Clip ${i + 1}`) === name);
      if (!clip) continue;
      model.mixer.clipAction(clip).play();
      length = Math.max(length, clip.duration);
    }
    pose();
  };
  const step = (now) => {
    if (!playing) return;
    time = length ? (time + (now - last) / 1000) % length : 0;
    last = now;
    pose();
    requestAnimationFrame(step);
  };
  const play = (isOn) => {
    // Nothing moves before it is asked to: the file's own pose is what was baked.
    if (isOn && animated.length && !length) choose(byId('clip').value);
    playing = isOn && animated.length > 0;
    byId('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
    byId('play-icon').setAttribute('href', playing ? '#icon-pause' : '#icon-play');
    last = performance.now();
    if (playing) requestAnimationFrame(step);
    redraw();
  };

  byId('clip').addEventListener('change', (event) => choose(event.target.value));
  byId('play').addEventListener('click', () => play(!playing));
  byId('time').addEventListener('input', (event) => {
    play(false);
    if (!length) choose(byId('clip').value);
    time = event.target.value * length;
    pose();
  });
  return {
    isPlaying: () => playing,
    toggle: () => play(!playing),
    /** From now on it is these models that move. */
    setModels(models) {
      for (const model of animated) model.mixer.stopAllAction();
      animated = models.filter((model) => model.clips.length);
      [time, length] = [0, 0];
      play(false);
      pose();
      const names = new Set(animated.flatMap((model) => model.clips.map((clip, i) => clip.name || `Clip ${i + 1}`)));
      options(byId('clip'), [...names].map((name) => [name, name]));
      byId('animation-section').hidden = animated.length === 0;
    },
  };
}
