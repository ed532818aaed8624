// Pictures for comparisons: node stills.mjs SPEC.json, where SPEC is [{ url, stills: [{ file, ...options }] }] with the
// options of `Stage.still`. Writes RGBA bytes, row 0 on top.
import fs from 'node:fs';
import { launch, settled, watchedPage } from './browser.mjs';

const browser = await launch();
try {
  for (const { url, stills } of JSON.parse(fs.readFileSync(process.argv[2]))) {
    const { page, errors } = await watchedPage(browser, { width: 400, height: 300 });
    await page.goto(url);
    if ((await settled(page)) !== 'shown') throw new Error(await page.$eval('#failure-text', (e) => e.textContent));
    for (const { file, ...options } of stills) {
      const text = await page.evaluate((wanted) => {
        const bytes = window.parbake.stage.still(wanted);
        let out = '';
        for (let i = 0; i < bytes.length; i += 32768) out += String.fromCharCode(...bytes.subarray(i, i + 32768));
        return btoa(out);
      }, options);
      fs.writeFileSync(file, Buffer.from(text, 'base64'));
    }
    if (errors.length) throw new Error(errors.join('\n'));
    await page.close();
  }
} finally {
  await browser.close();
}
