// The points of a sweep as lines across parallel axes: what varies, and what was found.

import { Axis, BOTTOM, NONE, TOP } from './axis.js';
import { html, place, say, svg } from './svg.js';

const WIDTH = 860;
const MARGIN = 76;

/** A figure of the points of a sweep, as docs/json.md has them: a part of an axis that is chosen selects points. */
export function parallelOf({ rows, best }) {
  const columns = [
    ...Object.keys(rows[0].levels).map((name) => ({ name, values: rows.map(({ levels }) => levels[name]) })),
    ...Object.keys(rows[0].metrics).map((name) => ({ name, values: rows.map(({ metrics }) => metrics[name].value) })),
  ].filter(({ values }) => values.some((value) => value !== null));
  const apart = (WIDTH - 2 * MARGIN) / Math.max(columns.length - 1, 1);
  const selected = svg('path', { class: 'selected' });
  const told = html('p', { role: 'status' });
  const axes = columns.map(({ name, values }, k) => new Axis(name, values, MARGIN + k * apart, () => select()));
  const pathOf = (places) => places.map((row) => `M${columns.map(({ values }, k) =>
    `${axes[k].x.toFixed(1)} ${axes[k].yOf(values[row]).toFixed(1)}`).join('L')}`).join('');
  const select = () => {
    const chosen = rows.map((_, row) => row).filter((row) => columns.every(({ values }, k) => axes[k].selects(values[row])));
    place(selected, { d: pathOf(chosen) });
    say(told, wordsOf(chosen, columns, rows.length));
  };
  const all = svg('path', { class: 'all', d: pathOf(rows.map((_, row) => row)) });
  const bestRow = rows.findIndex(({ point }) => point === best);
  const bestOne = bestRow < 0 ? [] : [svg('path', { class: 'best', d: pathOf([bestRow]) })];
  // Names that stand beside each other would run into one another.
  const names = columns.map(({ name }, k) => svg('text', { class: 'name', x: axes[k].x, y: k % 2 ? 30 : 14, 'text-anchor': 'middle' }, name));
  const hasGaps = columns.some(({ values }) => values.includes(null));
  const none = hasGaps ? [svg('text', { x: MARGIN - 14, y: BOTTOM + NONE + 4, 'text-anchor': 'end' }, 'no value')] : [];
  select();
  return html('figure', { class: 'parallel' }, html('figcaption', {}, `Each line is a point${bestOne.length ? '; the thick one is the best' : ''}`),
    svg('svg', { viewBox: `0 0 ${WIDTH} ${BOTTOM + NONE + TOP / 4}`, role: 'group', 'aria-label': 'Points over parallel axes' },
      all, selected, ...bestOne, ...names, ...none, ...axes.map(({ element }) => element)),
    html('p', { class: 'across' }, 'Drag along an axis, or move its ends with the arrow keys, to select points; click on it to take all of it again.'), told);
}

/** Which points are selected; of a single one its values. */
function wordsOf(chosen, columns, all) {
  if (chosen.length !== 1) return `${chosen.length} of ${all} points selected`;
  return `1 of ${all} points selected: ${columns.map(({ name, values }) => `${name} ${textOf(values[chosen[0]])}`).join(', ')}`;
}

function textOf(value) {
  if (value === null) return 'no value';
  return typeof value === 'number' ? String(Number(value.toPrecision(4))) : value;
}
