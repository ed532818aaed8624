// Runs programs: without a shell, with a time limit, with what they say kept for the report.

import { spawn } from 'node:child_process';

/** What a program did: exit code (null if it was killed), seconds, and its output as text. */
export function run(program, args, { seconds = 1800 } = {}) {
  return new Promise((done, fail) => {
    const begun = performance.now();
    const child = spawn(program, args, { stdio: ['ignore', 'pipe', 'pipe'] });
    let output = '';
    let late = false;
    const timer = setTimeout(() => {
      late = true;
      child.kill('SIGKILL');
    }, seconds * 1000);
    for (const stream of [child.stdout, child.stderr]) stream.setEncoding('utf8').on('data', (text) => (output += text));
    child.on('error', (error) => {
      clearTimeout(timer);
      fail(new Error(`${program} cannot be run: ${error.message}`));
    });
    child.on('close', (code) => {
      clearTimeout(timer);
      if (late) output += `\nerror: ended after ${seconds} s`;
      done({ code, seconds: (performance.now() - begun) / 1000, output });
    });
  });
}

/** Why a program failed: its line that begins with "error:", else its last line. */
export function reason({ code, output }) {
  const lines = output.split('\n').map((line) => line.trim()).filter(Boolean);
  const error = lines.findLast((line) => /^error:/i.test(line));
  return error?.replace(/^error:\s*/i, '') ?? lines.at(-1) ?? `ended with code ${code} without a word`;
}

/** The warnings that a program printed, without the word. */
export function warnings({ output }) {
  return output.split('\n').filter((line) => line.startsWith('warning: ')).map((line) => line.slice('warning: '.length));
}

/** Calls `work` on all items, `jobs` at a time; results in the order of the items. */
export async function inParallel(items, jobs, work) {
  const results = new Array(items.length);
  let next = 0;
  const worker = async () => {
    while (next < items.length) {
      const index = next;
      next += 1;
      results[index] = await work(items[index], index);
    }
  };
  await Promise.all(Array.from({ length: Math.max(1, Math.min(jobs, items.length)) }, worker));
  return results;
}
