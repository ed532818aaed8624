// What the page shows, as plain values; whoever draws a value listens for its changes.

/** A set of named values. `on` calls back with all values when one of the named ones changes. */
export function createStore(values) {
  const listeners = [];
  return {
    get: () => values,
    set(patch) {
      const changed = Object.keys(patch).filter((key) => !Object.is(values[key], patch[key]));
      if (!changed.length) return;
      values = { ...values, ...patch };
      for (const { keys, call } of [...listeners]) if (keys.some((key) => changed.includes(key))) call(values);
    },
    on(keys, call) {
      listeners.push({ keys, call });
      call(values);
    },
  };
}
