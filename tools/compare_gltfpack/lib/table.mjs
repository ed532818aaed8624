// Tables in Markdown, and the sums that stand below them.

/** A table in Markdown: `columns` are `{ title, value(row), left }`. */
export function markdownTable(columns, rows) {
  const cell = (text) => String(text ?? '–').replaceAll('|', '\\|').replaceAll('\n', ' ');
  const line = (cells) => `| ${cells.join(' | ')} |`;
  return [
    line(columns.map(({ title }) => title)),
    line(columns.map(({ left }) => (left ? '---' : '---:'))),
    ...rows.map((row) => line(columns.map(({ value }) => cell(value(row))))),
  ].join('\n');
}

/** A number with so many decimals, or a dash where there is none. */
export function fixed(value, decimals = 1) {
  return Number.isFinite(value) ? value.toFixed(decimals) : '–';
}

/** A difference with its sign. */
export function signed(value, decimals = 1) {
  return Number.isFinite(value) ? `${value > 0 ? '+' : ''}${value.toFixed(decimals)}` : '–';
}

/** The median, null of nothing. */
export function median(values) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  if (sorted.length === 0) return null;
  const middle = sorted.length / 2;
  return sorted.length % 2 === 1 ? sorted[Math.floor(middle)] : (sorted[middle - 1] + sorted[middle]) / 2;
}

export function mean(values) {
  return values.length > 0 ? values.reduce((sum, value) => sum + value, 0) / values.length : null;
}
