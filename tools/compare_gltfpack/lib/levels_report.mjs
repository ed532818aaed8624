// From rows of levels to a table in Markdown and a JSON document, with the sums below.

import { fixed, markdownTable, median, signed } from './table.mjs';

/** How far ours is above gltfpack at a size (`own` or `closeUp`), null where one is missing. */
function difference({ psnr }, size) {
  const { ours, gltfpack } = psnr[size] ?? {};
  return Number.isFinite(ours) && Number.isFinite(gltfpack) ? ours - gltfpack : null;
}

/** The share of gltfpack's texels or draw calls that ours has, null where one is missing. */
function share({ ours, gltfpack }, cost) {
  return gltfpack?.[cost] > 0 && ours ? ours[cost] / gltfpack[cost] : null;
}

/** Counts and medians over all levels. */
export function summariseLevels(levels) {
  const known = (values) => values.filter((value) => Number.isFinite(value));
  const against = (size) => {
    const differences = known(levels.map((level) => difference(level, size)));
    return {
      compared: differences.length,
      atOrAbove: differences.filter((value) => value >= 0).length,
      medianDifference: median(differences),
      leastDifference: differences.length > 0 ? Math.min(...differences) : null,
      medianOurs: median(levels.map(({ psnr }) => psnr[size]?.ours)),
    };
  };
  const atMostHalf = (cost) => known(levels.map((level) => share(level, cost))).filter((value) => value <= 0.5).length;
  const reached = (of) => {
    const values = known(levels.map(of));
    return { levels: values.length, median: median(values), atLeast35: values.filter((value) => value >= 35).length };
  };
  return {
    levels: levels.length,
    own: against('own'),
    closeUp: against('closeUp'),
    halfTheTexels: atMostHalf('texels'),
    halfTheDrawCalls: atMostHalf('drawCalls'),
    atSwitch: reached(({ psnr }) => psnr.atSwitch),
    againstBefore: reached(({ psnr }) => psnr.againstBefore),
  };
}

function table(rows) {
  const levels = rows.flatMap((row) =>
    row.levels.length > 0
      ? row.levels.map((level) => ({ model: row.model, ...level }))
      : [{ model: row.model, psnr: {}, note: row.failed ?? row.made?.refused }],
  );
  const two = (of) => (row) => [row.ours, row.gltfpack].map((who) => of(who ?? {}) ?? '–').join(' / ');
  const kilotexels = ({ texels }) => (texels === undefined ? undefined : Math.round(texels / 1000));
  return markdownTable(
    [
      { title: 'model', left: true, value: ({ model }) => model },
      { title: 'pixels', value: ({ screenSize }) => screenSize },
      { title: 'triangles', value: two(({ triangles }) => triangles) },
      { title: 'draw calls', value: two(({ drawCalls }) => drawCalls) },
      { title: 'kilotexels', value: two(kilotexels) },
      { title: 'ours', value: ({ psnr }) => fixed(psnr.own?.ours) },
      { title: 'gltfpack', value: ({ psnr }) => fixed(psnr.own?.gltfpack) },
      { title: 'difference', value: (level) => signed(difference(level, 'own')) },
      { title: 'ours close up', value: ({ psnr }) => fixed(psnr.closeUp?.ours) },
      { title: 'gltfpack', value: ({ psnr }) => fixed(psnr.closeUp?.gltfpack) },
      { title: 'difference', value: (level) => signed(difference(level, 'closeUp')) },
      { title: 'switch, pixels', value: ({ switchPixels }) => fixed(switchPixels, 0) },
      { title: 'there', value: ({ psnr }) => fixed(psnr.atSwitch) },
      { title: 'against the level before', value: ({ psnr }) => fixed(psnr.againstBefore) },
      {
        title: 'notes',
        left: true,
        value: ({ note, gltfpack }) => note ?? (gltfpack?.refused ? `gltfpack: ${gltfpack.refused}` : gltfpack?.note) ?? '',
      },
    ],
    levels,
  );
}

/** The report on `rows` as `{ markdown, json }`. */
export function levelsReport(rows, { light, backgrounds, views, size, lodOptions }) {
  const sums = summariseLevels(rows.flatMap((row) => row.levels));
  const against = (name, of) =>
    `${name}: ours at or above on ${of.atOrAbove} of ${of.compared}, median ${signed(of.medianDifference)} dB, least ` +
    `${signed(of.leastDifference)} dB; median of ours ${fixed(of.medianOurs)} dB.`;
  const reached = (name, of) =>
    `${name}: median ${fixed(of.median)} dB, ${of.atLeast35} of ${of.levels} at 35 dB or above.`;
  const seconds = median(rows.map((row) => row.made?.seconds));
  const markdown = [
    '# Levels of detail beside the original',
    `PSNR in dB of pictures by three.js under \`${light}\`: the mean of ${views} views before ${backgrounds.join(' and ')}. ` +
      `\`parbake lod\` ran with ${lodOptions.length > 0 ? `\`${lodOptions.join(' ')}\`` : 'its default options'}; gltfpack with ` +
      '`-sp -sv` and as many triangles, its textures at full size. Two figures in a cell are those of ours and gltfpack. ' +
      `Pictures of the level’s own size are such that the model’s longest side spans as many pixels; close up they have ${size}².`,
    table(rows),
    '## Sums',
    against('At the levels’ own sizes', sums.own),
    against('Close up', sums.closeUp),
    `At most half of gltfpack’s texels: ${sums.halfTheTexels} of ${sums.levels}; draw calls: ${sums.halfTheDrawCalls}.`,
    reached('Against the original where a level takes over', sums.atSwitch),
    reached('Against the level before, there', sums.againstBefore),
    `A chain took ${fixed(seconds)} s in the median.`,
  ].join('\n\n');
  return { markdown: `${markdown}\n`, json: { settings: { light, backgrounds, views, size, lodOptions }, rows, sums } };
}
