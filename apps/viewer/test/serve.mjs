// Serves files and models on this machine, for tests of the page that need no command.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm', '.json': 'application/json' };

/** `answer(path)` gives bytes, text, or nothing; `{ url, stop }`. */
export async function serve(answer) {
  const server = http.createServer((request, response) => {
    const name = decodeURIComponent(new URL(request.url, 'http://localhost').pathname).slice(1) || 'index.html';
    const body = answer(name);
    response.writeHead(body == null ? 404 : 200, { 'Content-Type': name.endsWith('/') ? TYPES['.html'] : TYPES[path.extname(name)] ?? 'application/octet-stream' });
    response.end(body ?? '');
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return { url: `http://127.0.0.1:${server.address().port}/`, stop: () => new Promise((done) => { server.closeAllConnections(); server.close(done); }) };
}

/** A file below a folder, or nothing. */
export function below(folder, name) {
  const file = path.join(folder, name);
  return file.startsWith(folder + path.sep) && fs.existsSync(file) && fs.statSync(file).isFile() ? fs.readFileSync(file) : null;
}

/** The built page with these models, `[name, bytes]`, as `parbake view` answers. */
export function servePage(dist, models) {
  const session = JSON.stringify({
    version: 'test', models: models.map(([name], i) => ({ name, role: 'level', url: `model/${i}`, notes: `model/${i}/notes.json` })),
  });
  return serve((name) => {
    if (name === 'session.json') return session;
    const [, index, notes] = /^model\/(\d+)(\/notes\.json)?$/.exec(name) ?? [];
    if (index) return notes ? JSON.stringify({ warnings: [], bytes: models[index][1].length }) : models[index][1];
    return below(dist, name);
  });
}
