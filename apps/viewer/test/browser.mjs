// What all tests in the browser need: the browser, `parbake view` as its users start it, and a page whose console and
// requests are watched.
import { spawn } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import puppeteer from 'puppeteer-core';

/** WebGL on the processor, as Debian's Chromium offers it. */
const FLAGS = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
const PLACES = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

/** The browser's path, or null. */
export function findBrowser() {
  return [process.env.CHROMIUM, ...PLACES].find((place) => place && fs.existsSync(place)) ?? null;
}

export function launch(more = []) {
  return puppeteer.launch({ executablePath: findBrowser(), protocolTimeout: 180_000, args: [...FLAGS, ...more] });
}

/** Starts the command; gives its address, and a function that ends it. */
export function view(parbake, models, more = []) {
  return new Promise((resolve, reject) => {
    const began = performance.now();
    const child = spawn(parbake, ['view', ...models, '--no-open', '--quiet', ...more], { stdio: ['ignore', 'pipe', 'pipe'] });
    let out = '', said = '';
    const stop = () => new Promise((done) => {
      if (child.exitCode !== null || child.signalCode !== null) return done();
      child.once('exit', done);
      child.kill('SIGINT');
    });
    child.stdout.on('data', (data) => {
      out += data;
      const url = /^(http:\S+)\n/.exec(out)?.[1];
      if (url) resolve({ url, stop, began });
    });
    child.stderr.on('data', (data) => { said += data; });
    child.on('exit', (code) => reject(new Error(`parbake view ended with ${code}: ${said}`)));
    child.on('error', reject);
  });
}

/** A page with all that it complains about, and all that it asks of others; `sharpness` is the canvas's pixels for each of the page's. */
export async function watchedPage(browser, { width = 1440, height = 900, sharpness = 1, scheme = 'light', isPhone = false, motion = 'no-preference' } = {}) {
  const page = await browser.newPage();
  await page.setViewport({ width, height, deviceScaleFactor: sharpness, isMobile: isPhone, hasTouch: isPhone });
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: scheme }, { name: 'prefers-reduced-motion', value: motion }]);
  const errors = [], outside = [];
  page.on('console', (message) => {
    // A refused model is answered with a status that the browser writes to the console by itself.
    if (message.type() === 'error' && !/status of 422/.test(message.text())) errors.push(message.text());
  });
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('request', (request) => {
    const url = new URL(request.url());
    if (!['blob:', 'data:'].includes(url.protocol) && url.hostname !== '127.0.0.1') outside.push(request.url());
  });
  return { page, errors, outside };
}

/** What axe-core finds on the page that keeps someone out, a sentence each. */
export async function barriers(page) {
  // The policy of the page lets nothing in; the protocol does.
  await page.evaluate(fs.readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8'));
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
  return violations.filter(({ impact }) => ['serious', 'critical'].includes(impact))
    .map(({ id, impact, nodes }) => `axe-core ${id} (${impact}): ${nodes.map((n) => n.target).join(' ')}`);
}

/** Waits until the page shows a model or says why not; which of both. */
export async function settled(page, timeout = 60_000) {
  await page.waitForFunction(() => window.parbake || !document.getElementById('failure').hidden, { timeout });
  return page.evaluate(() => (window.parbake ? 'shown' : 'refused'));
}

/** Waits until the next picture has been drawn and measured. */
export async function drawn(page) {
  await page.evaluate(() => window.parbake.settled());
}
