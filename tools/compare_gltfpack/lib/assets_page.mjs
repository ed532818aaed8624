// The page docs/assets.md, from the rows of assets.mjs.

import path from 'node:path';
import { fixed, markdownTable } from './table.mjs';

/** Nothing of the machine's folders belongs on the page. */
function withoutFolders(text, folders) {
  return folders.reduce((rest, folder) => rest.replaceAll(folder + path.sep, '').replaceAll(folder, ''), text);
}

function outcome(row) {
  if (row.failed) return `not measured: ${row.failed}`;
  const { refused, warnings = [] } = row.made;
  if (refused?.startsWith('bake: ')) return `loads; the bake is refused: ${refused.slice('bake: '.length)}`;
  if (refused) return `refused: ${refused.replace(/^simplify: /, '')}`;
  return warnings.length === 0 ? 'baked' : `baked; ${warnings.join('; ')}`;
}

/** The page in Markdown. `data` is the folder that names and sentences are relative to. */
export function assetsPage(rows, settings, data) {
  const { backgrounds, views, size, light, triangles, textureSize, bakeOptions, out } = settings;
  const sum = (test) => rows.filter(test).length;
  const baked = sum((row) => row.made && !row.made.refused);
  const options = bakeOptions.length > 0 ? ` -- ${bakeOptions.join(' ')}` : '';
  const numbers = [`--triangles ${triangles}`, `--texture-size ${textureSize}`, `--light ${light}`, `--views ${views}`, `--size ${size}`];
  const parts = [
    '# Assets',
    'What Parbake makes of models that others made: real assets, conformance cases, and geometry that is valid ' +
      `but nasty. ${baked} of ${rows.length} are baked. Read it to see what to expect of models like yours. The last column has ` +
      "the sentences that the command printed; those of the low-poly begin with its name, `low`. This page is made by",
    `    cd tools/compare_gltfpack && npm ci\n    node assets.mjs DATA --page ../../docs/assets.md ${numbers.join(' ')}${options}`,
    `Each model is cut to ${triangles} triangles (half of its own if that is less) and baked onto that with textures ` +
      `of ${textureSize}². PSNR in dB compares pictures by three.js of the model and the bake ` +
      `(${views} views of ${size}², light \`${light}\`); ` +
      '[tools/compare_gltfpack](../tools/compare_gltfpack/README.md) says how. Seconds are those of the bake.',
  ];
  for (const set of new Set(rows.map((row) => row.set))) {
    const columns = [
      { title: 'model', left: true, value: (row) => row.model },
      { title: 'triangles', value: (row) => row.original?.triangles },
      { title: 'baked onto', value: (row) => row.made?.triangles },
      { title: 'seconds', value: (row) => fixed(row.made?.seconds) },
      ...backgrounds.map((background) => ({
        title: `PSNR ${background}`,
        value: (row) => fixed(row.psnr?.[background]?.mean),
      })),
      { title: 'what became of it', left: true, value: (row) => withoutFolders(outcome(row), [out, data]) },
    ];
    parts.push(`## ${set}`, markdownTable(columns, rows.filter((row) => row.set === set)));
  }
  return `${parts.join('\n\n')}\n`;
}
