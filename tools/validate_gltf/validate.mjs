// Holds glTF files against the Khronos validator (npm `gltf-validator`).
//
//     npm ci && node validate.mjs [--errors-only] FILE_OR_FOLDER...
//
// A folder stands for all .glb and .gltf files in it. Prints every error and
// warning with its JSON pointer, then one line of sums. Exits 1 when any file has
// an error or a warning or cannot be read, 2 when there was nothing to look at. With
// --errors-only warnings are printed and pass: of files that hold models as they were read.

import { readFile, readdir, stat } from 'node:fs/promises';
import path from 'node:path';
import validator from 'gltf-validator';

const SEVERITIES = ['error', 'warning', 'info', 'hint'];

/** The files that an argument stands for. */
async function filesOf(argument) {
  if (!(await stat(argument)).isDirectory()) return [argument];
  const names = await readdir(argument);
  return names.filter((name) => /\.(glb|gltf)$/i.test(name)).sort().map((name) => path.join(argument, name));
}

/** Prints what the validator has to say; returns the number of errors and warnings. */
async function validate(file) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: path.basename(file),
    // No message is left out, however many there are.
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  const known = unknownToIt(report.issues.messages);
  const shown = report.issues.messages.filter((message) => message.severity <= 1 && !known.has(message));
  for (const { severity, pointer, code, message } of shown) {
    console.log(`${file}: ${SEVERITIES[severity]} at ${pointer ?? 'the file'}: ${message} (${code})`);
  }
  return [report.issues.numErrors, report.issues.numWarnings - known.size];
}

/**
 * Warnings that the validator has for every KTX2 picture, other people's too: it does not know
 * KHR_texture_basisu. Of these pictures alone, what it says of their type and of their first bytes.
 */
function unknownToIt(messages) {
  const isType = ({ code, message }) => code === 'VALUE_NOT_IN_LIST' && message.includes("'image/ktx2'");
  const pictures = new Set(messages.filter(isType).map(({ pointer }) => pointer.replace('/mimeType', '')));
  const isFormat = ({ code, pointer }) => code === 'IMAGE_UNRECOGNIZED_FORMAT' && pictures.has(pointer);
  return new Set(messages.filter((message) => isType(message) || isFormat(message)));
}

const given = process.argv.slice(2);
const errorsOnly = given.includes('--errors-only');
const sums = { files: 0, errors: 0, warnings: 0 };
for (const argument of given.filter((argument) => argument !== '--errors-only')) {
  try {
    for (const file of await filesOf(argument)) {
      const [errors, warnings] = await validate(file);
      sums.files += 1;
      sums.errors += errors;
      sums.warnings += warnings;
    }
  } catch (error) {
    console.log(`${argument}: error: ${error.message ?? error}`);
    sums.errors += 1;
  }
}
console.log(`${sums.files} files, ${sums.errors} errors, ${sums.warnings} warnings`);
if (sums.errors > 0 || (sums.warnings > 0 && !errorsOnly)) process.exitCode = 1;
else if (sums.files === 0) process.exitCode = 2;
