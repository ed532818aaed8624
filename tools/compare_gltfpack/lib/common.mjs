// What the commands of this folder share: options of the viewer, and how they are read.

import { LIGHT_NAMES } from './light_names.mjs';

/** Options of everything that renders, for `parseArgs`. */
export const VIEWER_OPTIONS = {
  parbake: { type: 'string', default: 'parbake' },
  light: { type: 'string', default: 'room' },
  views: { type: 'string', default: '12' },
  size: { type: 'string', default: '384' },
  backgrounds: { type: 'string', default: '#000000,#808080' },
  models: { type: 'string' },
  jobs: { type: 'string', default: '1' },
  reuse: { type: 'boolean', default: false },
  out: { type: 'string' },
  chromium: { type: 'string' },
  seconds: { type: 'string', default: '1800' },
  help: { type: 'boolean', short: 'h', default: false },
};

/** Wrong usage: exits with code 2 after the sentence. */
export class UsageError extends Error {}

/** A whole number of an option within a range. */
export function whole(values, name, least, most) {
  const number = Number(values[name]);
  if (!Number.isInteger(number) || number < least || number > most) {
    throw new UsageError(`--${name} ${values[name]}: a whole number from ${least} to ${most}`);
  }
  return number;
}

/** The lights that were asked for, checked. */
export function lightsOf(text) {
  const lights = text.split(',');
  const unknown = lights.find((light) => !LIGHT_NAMES.includes(light));
  if (unknown !== undefined) throw new UsageError(`--light ${unknown}: ${LIGHT_NAMES.join(', ')} or several with commas`);
  return lights;
}

/** The models that `--models` names; all without it. A name that is no model is wrong usage. */
export function chosen(models, names) {
  if (!names) return models;
  return names.split(',').map((name) => {
    const model = models.find((other) => other.name === name);
    if (!model) throw new UsageError(`--models ${name}: the folder has no such model`);
    return model;
  });
}

/** Runs a command's main function; prints errors as one line. */
export async function main(command, usage) {
  try {
    process.exitCode = (await command()) ?? 0;
  } catch (error) {
    const wrong = error instanceof UsageError || error.code?.startsWith?.('ERR_PARSE_ARGS');
    console.error(`error: ${error.message}${wrong ? `\n\n${usage}` : ''}`);
    process.exitCode = wrong ? 2 : 1;
  }
}
