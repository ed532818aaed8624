// Small helpers for the elements of the page.

export const byId = (id) => document.getElementById(id);

/** Radio buttons in a fieldset that stand for the values of one key; entries are `[value, label]`. */
export function radios(fieldset, name, entries, choose) {
  for (const old of fieldset.querySelectorAll('label')) old.remove();
  for (const [value, label] of entries) {
    const element = document.createElement('label'), input = document.createElement('input');
    const text = document.createElement('span');
    Object.assign(input, { type: 'radio', name, value });
    input.addEventListener('change', () => choose(value));
    text.textContent = label;
    element.append(input, text);
    fieldset.append(element);
  }
}

export function check(fieldset, value) {
  for (const input of fieldset.querySelectorAll('input')) input.checked = input.value === String(value);
}

export function options(select, entries) {
  select.replaceChildren(...entries.map(([value, label]) => new Option(label, value)));
}

const GROUPED = new Intl.NumberFormat('en');
export const count = (n) => GROUPED.format(Math.round(n));

/** A size in bytes with three digits. */
export function bytes(n) {
  const units = ['B', 'kB', 'MB', 'GB'];
  const power = Math.min(3, Math.floor(Math.log10(Math.max(1, n)) / 3)), value = n / 1000 ** power;
  return `${power === 0 || value >= 100 ? Math.round(value) : value >= 10 ? value.toFixed(1) : value.toFixed(2)} ${units[power]}`;
}
