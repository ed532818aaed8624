// From rows of figures to a table in Markdown and a JSON document, with the sums below.

import { fixed, markdownTable, mean, median, signed } from './table.mjs';

const BASE_LIGHT = 'room';

/** PSNR of a file under a light: before one background, or the mean over all of them. */
function psnr(row, who, light, background) {
  const of = row.psnr[light]?.[who];
  if (!of) return null;
  return background ? (of[background]?.mean ?? null) : mean(Object.values(of).map((value) => value.mean));
}

/** How far ours is above gltfpack, null where one is missing. */
function difference(row, light, background) {
  const [ours, other] = ['ours', 'gltfpack'].map((who) => psnr(row, who, light, background));
  return ours === null || other === null ? null : ours - other;
}

/** Counts and median over all models, for one light and one background (or the mean of all). */
function summarise(rows, light, background) {
  const differences = rows.map((row) => difference(row, light, background)).filter((value) => value !== null);
  return {
    models: rows.length,
    compared: differences.length,
    atOrAbove: differences.filter((value) => value >= 0).length,
    moreThanOneBelow: differences.filter((value) => value < -1).length,
    medianDifference: median(differences),
    leastDifference: differences.length > 0 ? Math.min(...differences) : null,
    medianOurs: median(rows.map((row) => psnr(row, 'ours', light, background))),
    medianGltfpack: median(rows.map((row) => psnr(row, 'gltfpack', light, background))),
  };
}

/** How much a file loses under another light than the room, in the median of all models. */
function relighting(rows, lights, who) {
  const losses = {};
  for (const light of lights.filter((name) => name !== BASE_LIGHT)) {
    losses[light] = median(
      rows.map((row) => {
        const [there, here] = [light, BASE_LIGHT].map((name) => psnr(row, who, name));
        return there === null || here === null ? NaN : there - here;
      }),
    );
  }
  return losses;
}

function notes(row) {
  const all = [];
  if (row.failed) all.push(row.failed);
  if (row.ours?.refused) all.push(`ours: ${row.ours.refused}`);
  if (row.gltfpack?.refused) all.push(`gltfpack: ${row.gltfpack.refused}`);
  if (row.gltfpack?.note) all.push(`gltfpack: ${row.gltfpack.note}`);
  return all.join('; ');
}

function table(rows, light, backgrounds) {
  const three = (of) => (row) => ['original', 'ours', 'gltfpack'].map((who) => of(row[who] ?? {}) ?? '–').join(' / ');
  const megatexels = ({ texels }) => (texels === undefined ? undefined : (texels / 1e6).toFixed(2));
  const columns = [
    { title: 'model', left: true, value: (row) => row.model },
    { title: 'triangles', value: three(({ triangles }) => triangles) },
    { title: 'draw calls', value: three(({ drawCalls }) => drawCalls) },
    { title: 'megatexels', value: three(megatexels) },
    { title: 'bake, s', value: (row) => fixed(row.ours?.seconds) },
  ];
  for (const background of backgrounds) {
    columns.push(
      { title: `ours ${background}`, value: (row) => fixed(psnr(row, 'ours', light, background)) },
      { title: `gltfpack ${background}`, value: (row) => fixed(psnr(row, 'gltfpack', light, background)) },
      { title: 'difference', value: (row) => signed(difference(row, light, background)) },
    );
  }
  columns.push({ title: 'notes', left: true, value: notes });
  return markdownTable(columns, rows);
}

function summaryTable(summaries) {
  return markdownTable(
    [
      { title: 'light', left: true, value: ({ light }) => light },
      { title: 'background', left: true, value: ({ background }) => background },
      { title: 'compared', value: (row) => `${row.compared} of ${row.models}` },
      { title: 'ours at or above', value: ({ atOrAbove }) => atOrAbove },
      { title: 'ours more than 1 dB below', value: (row) => row.moreThanOneBelow },
      { title: 'median difference', value: (row) => signed(row.medianDifference) },
      { title: 'least difference', value: (row) => signed(row.leastDifference) },
      { title: 'median of ours', value: (row) => fixed(row.medianOurs) },
      { title: 'median of gltfpack', value: (row) => fixed(row.medianGltfpack) },
    ],
    summaries,
  );
}

/** The report on `rows` as `{ markdown, json }`. */
export function report(rows, settings) {
  const { lights, backgrounds, views, size, triangles, textureSize, bakeOptions } = settings;
  const summaries = lights.flatMap((light) =>
    [...backgrounds, null].map((background) => ({
      light,
      background: background ?? 'mean of both',
      ...summarise(rows, light, background),
    })),
  );
  const relit = Object.fromEntries(['ours', 'gltfpack'].map((who) => [who, relighting(rows, lights, who)]));
  const command = ['--texture-size', textureSize, ...bakeOptions].join(' ');
  const parts = [
    '# Parbake and gltfpack beside the original',
    `PSNR in dB of pictures by three.js: ${views} views of ${size} × ${size}. Models were cut to ${triangles} ` +
      `triangles, or half of their own if that is less; \`parbake bake\` ran with \`${command}\`. gltfpack ran with ` +
      '`-sp -sv` and as many triangles, its textures at full size. Three figures in a cell are those of the ' +
      'original, ours and gltfpack.',
  ];
  for (const light of lights) parts.push(`## Light: ${light}`, table(rows, light, backgrounds));
  parts.push('## Sums', summaryTable(summaries));
  const others = lights.filter((light) => light !== BASE_LIGHT);
  if (lights.includes(BASE_LIGHT) && others.length > 0) {
    const losses = (who) => others.map((light) => `${signed(relit[who][light])} dB under ${light}`).join(', ');
    parts.push(`Against ${BASE_LIGHT}, in the median: ours ${losses('ours')}; gltfpack ${losses('gltfpack')}.`);
  }
  return {
    markdown: `${parts.join('\n\n')}\n`,
    json: { settings: { lights, backgrounds, views, size, triangles, textureSize, bakeOptions }, rows, summaries, relit },
  };
}
