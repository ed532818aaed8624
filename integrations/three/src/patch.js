// Puts the parallax into a shader of three.js, by exchanging whole chunks; what other patches look for stays there.
import { ShaderChunk } from 'three';
import { OFFSET } from './format.js';
import { BEGIN, DECLARED, REACH } from './glsl.js';

/** A fetch of one of the material's maps. Baked light has a layout of its own, and no depth. */
const FETCH = /texture2D\(\s*((?!lightMap\b)\w*[mM]ap),\s*(v\w+Uv)\b/g;
const shifted = (text) => text.replace(FETCH, 'parallaxTexture( $1, $2');

/** Lets all maps of a fragment shader be fetched where the shift leads. */
function shiftFetches(fragment) {
  return shifted(fragment).replace(/#include <(\w+)>/g, (include, name) => {
    const chunk = ShaderChunk[name] ?? '', moved = shifted(chunk);
    return moved === chunk ? include : moved;
  });
}

export const defines = (names) => names.map((name) => `#define ${name}\n`).join('');

/** The vertex shader with the offsets in it. */
export function patchVertex(vertex) {
  return vertex
    .replace('void main() {', `#ifdef PARALLAX_OFFSET\nattribute vec3 ${OFFSET};\n#endif\nvoid main() {`)
    .replace('#include <begin_vertex>', `#include <begin_vertex>\n${REACH}`);
}

/** The fragment shader with the parallax in it. `macros` are lines of the preprocessor. */
export function patchFragment(fragment, macros, isShifted) {
  const begun = fragment
    .replace('#include <common>', `#include <common>\n${DECLARED}`)
    .replace('#include <map_fragment>', `${BEGIN}\n#include <map_fragment>`);
  return macros + (isShifted ? shiftFetches(begun) : begun);
}
