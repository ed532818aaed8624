// Goes through models with one browser, and keeps the tables up to date.

import { mkdir, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { inParallel } from './run.mjs';
import { Viewer } from './viewer.mjs';

/**
 * Calls `compareOne(model, viewer)` for each model, `jobs` at a time, and writes what `report(rows)` makes of the rows so
 * far, `{ markdown, json }`, to `name`.md and `name`.json in `out`. Returns all rows in the models' order.
 */
export async function sweep(models, { out, name, jobs, chromium }, compareOne, report) {
  await mkdir(out, { recursive: true });
  const viewer = await Viewer.start(chromium);
  const rows = new Array(models.length);
  try {
    await inParallel(models, jobs, async (model, index) => {
      rows[index] = await compareOne(model, viewer);
      const done = rows.filter(Boolean);
      console.error(`${model.name}: ${done.length} of ${models.length}`);
      // After each model, so that a run that is cut short leaves what it found.
      const { markdown, json } = report(done);
      await writeFile(path.join(out, `${name}.md`), markdown);
      await writeFile(path.join(out, `${name}.json`), JSON.stringify(json, null, 2));
    });
  } finally {
    await viewer.close();
  }
  return rows;
}
