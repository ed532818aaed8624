// The viewer: serves a page and models on loopback to headless Chromium, and asks the page to
// compare models (lib/page.js says by which conventions).

import { createReadStream, existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import http from 'node:http';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';
import puppeteer from 'puppeteer-core';

const here = path.dirname(fileURLToPath(import.meta.url));
const require = createRequire(import.meta.url);
const HTML = '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><script type="module" src="/page.js"></script>';
const TYPES = { '.wasm': 'application/wasm', '.js': 'text/javascript', '.json': 'application/json' };
// A page of three models and many views takes minutes without a GPU.
const PATIENCE = 30 * 60 * 1000;

/** The folder of three.js's decoders: draco/ and basis/. */
function decoderFolder() {
  return path.dirname(require.resolve('three/examples/jsm/libs/meshopt_decoder.module.js'));
}

/** The path that Chromium has on this system, or null. */
export function findChromium() {
  const places = [
    process.env.CHROMIUM,
    '/usr/bin/chromium',
    '/usr/bin/chromium-browser',
    '/usr/bin/google-chrome',
    '/Applications/Google Chrome.app/Contents/MacOS/Google Chrome',
    'C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe',
  ];
  return places.find((place) => place && existsSync(place)) ?? null;
}

// The camera of lib/page.js: its distance, and the tangent of half its angle of view.
const [DISTANCE, HALF_ANGLE] = [3.5, 0.4];

/** Side of the picture in which a model, whose longest side is 2 units long there, spans so many pixels. */
export function pictureSize(pixels) {
  return Math.round(pixels * DISTANCE * HALF_ANGLE);
}

/** A running browser with its server. Close it when done. */
export class Viewer {
  #server;
  #browser;
  #folders = new Map([['three', decoderFolder()]]);

  /** Starts server and browser. Throws when no Chromium is found. */
  static async start(chromium = findChromium()) {
    if (!chromium) throw new Error('no Chromium found; name it with --chromium or in the variable CHROMIUM');
    const viewer = new Viewer();
    const bundle = await build({
      entryPoints: [path.join(here, 'page.js')],
      bundle: true,
      format: 'esm',
      minify: true,
      write: false,
      logLevel: 'error',
    });
    const page = bundle.outputFiles[0].contents;
    viewer.#server = http.createServer((request, response) => viewer.#answer(request, response, page));
    await new Promise((done) => viewer.#server.listen(0, '127.0.0.1', done));
    viewer.#browser = await puppeteer.launch({
      executablePath: chromium,
      protocolTimeout: PATIENCE,
      // Chromium's sandbox needs rights that containers lack. WebGL runs on the CPU, so that figures
      // do not depend on a graphics card.
      args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
    });
    return viewer;
  }

  async close() {
    await this.#browser?.close();
    this.#server?.close();
  }

  /** Serves what lies in the folder of `file` and returns the URL of `file`. */
  #publish(file) {
    const folder = path.dirname(path.resolve(file));
    let key = [...this.#folders].find(([, other]) => other === folder)?.[0];
    if (!key) {
      key = `models${this.#folders.size}`;
      this.#folders.set(key, folder);
    }
    return `/${key}/${encodeURIComponent(path.basename(file))}`;
  }

  #answer(request, response, page) {
    let name;
    try {
      name = decodeURIComponent(request.url.split('?')[0]);
    } catch {
      name = '';
    }
    if (name === '/') {
      response.setHeader('content-type', 'text/html');
      response.end(HTML);
      return;
    }
    if (name === '/page.js') {
      response.setHeader('content-type', 'text/javascript');
      response.end(page);
      return;
    }
    const [, key, ...rest] = name.split('/');
    const folder = this.#folders.get(key);
    const file = folder && path.join(folder, ...rest);
    // Nothing above a folder that was published.
    if (!file || !file.startsWith(folder + path.sep) || !existsSync(file)) {
      response.statusCode = 404;
      response.end();
      return;
    }
    const type = TYPES[path.extname(file)];
    if (type) response.setHeader('content-type', type);
    createReadStream(file)
      .on('error', () => response.destroy())
      .pipe(response);
  }

  /**
   * Compares files as three.js shows them. `candidates` is an object of name → path. Options are
   * those of `compareModels` in lib/page.js, whose result this returns.
   */
  async compare(original, candidates, { light, views, size, backgrounds, pictures }) {
    const page = await this.#browser.newPage();
    const messages = [];
    page.on('console', (message) => messages.push(message.text()));
    page.on('pageerror', (error) => messages.push(String(error)));
    try {
      await page.goto(`http://127.0.0.1:${this.#server.address().port}/`);
      await page.waitForFunction('window.pageIsReady', { timeout: 60000 }).catch(() => {
        throw new Error(`the viewer's page did not start: ${messages.join('; ')}`);
      });
      const question = {
        original: this.#publish(original),
        candidates: Object.fromEntries(Object.entries(candidates).map(([name, file]) => [name, this.#publish(file)])),
        light,
        views,
        size,
        backgrounds,
        pictures,
      };
      const answer = await page.evaluate(
        (asked) => window.compareModels(asked).catch((error) => ({ failed: String(error?.message ?? error) })),
        question,
      );
      if (answer.failed) throw new Error(answer.failed);
      return answer;
    } finally {
      await page.close();
    }
  }
}
