// Builds dist/ from src/: the page's own scripts in app.js, three.js in three.js, its decoders as they come. And the small
// view in reports in embed.js, three.js included.
//   node build.mjs           builds
//   node build.mjs --check   builds elsewhere and compares with dist/, byte for byte
import * as esbuild from 'esbuild';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));
const at = (...parts) => path.join(here, ...parts);
const three = (...parts) => at('node_modules', 'three', ...parts);
const dist = at('dist');

/** Decoders that run in workers, and read as files. */
const DECODERS = {
  'draco/draco_wasm_wrapper.js': three('examples/jsm/libs/draco/gltf/draco_wasm_wrapper.js'),
  'draco/draco_decoder.wasm': three('examples/jsm/libs/draco/gltf/draco_decoder.wasm'),
  'basis/basis_transcoder.wasm': three('examples/jsm/libs/basis/basis_transcoder.wasm'),
};

/** The worker that KTX2Loader would make from text (its `init`). */
async function basisWorker() {
  const { KTX2Loader } = await import(three('examples/jsm/loaders/KTX2Loader.js'));
  const body = KTX2Loader.BasisWorker.toString();
  const constants = ['EngineFormat', 'EngineType', 'TranscoderFormat', 'BasisFormat']
    .map((name) => `let _${name} = ${JSON.stringify(KTX2Loader[name])};`);
  const transcoder = fs.readFileSync(three('examples/jsm/libs/basis/basis_transcoder.js'), 'utf8');
  return [...constants, transcoder, body.slice(body.indexOf('{') + 1, body.lastIndexOf('}'))].join('\n');
}

/** What a report has to say of three.js, which it contains. */
function threeLicence() {
  const all = fs.readFileSync(at('THIRD_PARTY_LICENSES.txt'), 'utf8');
  const three = all.match(/^three\.js .*$/m)[0], [licence] = all.match(/^Permission is hereby granted[\s\S]*?SOFTWARE\.$/m);
  return `/*\n${three}\n\n${licence}\n*/`;
}

async function build(out) {
  fs.rmSync(out, { recursive: true, force: true });
  const shared = {
    bundle: true, format: 'esm', target: 'es2022', minify: true, legalComments: 'none', charset: 'utf8',
    absWorkingDir: here, logLevel: 'warning',
  };
  await esbuild.build({ ...shared, entryPoints: ['src/vendor.js'], outfile: path.join(out, 'three.js') });
  const apart = {
    name: 'three.js stays a file of its own',
    setup(build) {
      // The package of integrations/three imports three.js by its name.
      build.onResolve({ filter: /\/vendor\.js$|^three$/ }, () => ({ path: './three.js', external: true }));
    },
  };
  await esbuild.build({ ...shared, entryPoints: ['src/main.js'], outfile: path.join(out, 'app.js'), plugins: [apart] });
  await esbuild.build({
    ...shared, entryPoints: ['src/embed.js'], outfile: path.join(out, 'embed.js'), banner: { js: threeLicence() },
    // The package of integrations/three has no three.js of its own.
    alias: { three: at('node_modules', 'three') },
  });
  await esbuild.build({ ...shared, entryPoints: ['src/style.css'], outfile: path.join(out, 'style.css') });
  fs.copyFileSync(at('src/index.html'), path.join(out, 'index.html'));
  for (const [name, from] of Object.entries(DECODERS)) {
    fs.mkdirSync(path.dirname(path.join(out, name)), { recursive: true });
    fs.copyFileSync(from, path.join(out, name));
  }
  fs.writeFileSync(path.join(out, 'basis', 'worker.js'), await basisWorker());
  fs.copyFileSync(at('THIRD_PARTY_LICENSES.txt'), path.join(out, 'THIRD_PARTY_LICENSES.txt'));
}

function files(folder) {
  return fs.readdirSync(folder, { recursive: true }).map(String).filter((name) => fs.statSync(path.join(folder, name)).isFile()).sort();
}

if (process.argv.includes('--check')) {
  const fresh = fs.mkdtempSync(path.join(os.tmpdir(), 'parbake-page-'));
  await build(fresh);
  const names = [...new Set([...files(dist), ...files(fresh)])];
  const read = (folder, name) => (fs.existsSync(path.join(folder, name)) ? fs.readFileSync(path.join(folder, name)) : null);
  const differ = names.filter((name) => {
    const [a, b] = [read(dist, name), read(fresh, name)];
    return !a || !b || !a.equals(b);
  });
  fs.rmSync(fresh, { recursive: true });
  if (differ.length) {
    console.error(`apps/viewer/dist is not what its sources make: ${differ.join(', ')}. Run "npm run build" in apps/viewer and commit dist.`);
    process.exit(1);
  }
  console.log(`apps/viewer/dist is what its sources make (${names.length} files)`);
} else {
  await build(dist);
  for (const name of files(dist)) console.log(`${String(fs.statSync(path.join(dist, name)).size).padStart(8)}  ${name}`);
}
