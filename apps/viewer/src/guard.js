// What three.js would wait for forever, or ask memory for without end, in parts of a file that parbake's own readers
// pass over: other scenes, animations, levels of detail. A few hostile bytes are enough for either.

/** Elements of an accessor that has no bytes in the file. */
const MOST_EMPTY = 1e7;

/** The JSON of a GLB file. */
function documentOf(bytes) {
  const view = new DataView(bytes), length = view.getUint32(12, true);
  return JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, length)));
}

/** Throws one sentence if a file must not be handed to three.js. */
export function guard(bytes) {
  const { nodes = [], accessors = [] } = documentOf(bytes);
  accessors.forEach((accessor, index) => {
    if (accessor.bufferView === undefined && accessor.count > MOST_EMPTY)
      throw new Error(`accessor ${index} declares ${accessor.count} elements without any bytes`);
  });
  // 1: being looked through, 2: done. Without recursion, since chains may be long.
  const state = new Uint8Array(nodes.length);
  const below = (index) => [...(nodes[index].children ?? []), ...(nodes[index].extensions?.MSFT_lod?.ids ?? [])];
  for (let first = 0; first < nodes.length; first++) {
    const stack = state[first] ? [] : [[first, below(first)]];
    while (stack.length) {
      const [index, rest] = stack.at(-1);
      state[index] = 1;
      const next = rest.pop();
      if (next === undefined) {
        state[index] = 2;
        stack.pop();
      } else if (!(next in nodes)) throw new Error(`node ${index} names node ${next}, and there are ${nodes.length}`);
      else if (state[next] === 1) throw new Error(`node ${next} lies below itself`);
      else if (!state[next]) stack.push([next, below(next)]);
    }
  }
}
