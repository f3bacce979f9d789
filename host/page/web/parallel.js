// The points of a sweep as lines across parallel axes: what varies, and what was found.

import { Axis, BOTTOM, NONE, TOP } from './axis.js';
import { saveButton } from './save-picture.js';
import { html, place, say, svg } from './svg.js';

const WIDTH = 860;
const MARGIN = 76;

/** A figure of the points of a sweep, as docs/reference/json.md has them: a part of an axis that is chosen selects points. */
export function parallelOf({ rows, best }) {
  const columns = [
    ...Object.keys(rows[0].levels).map((name) => ({ name, values: rows.map(({ levels }) => levels[name]) })),
    ...Object.keys(rows[0].metrics).map((name) => ({ name, values: rows.map(({ metrics }) => metrics[name].value) })),
  ].filter(({ values }) => values.some((value) => value !== null));
  const places = rows.map((_, row) => row);
  const isDoubtful = (row) => remarksOn(rows[row]).length > 0;
  const apart = (WIDTH - 2 * MARGIN) / Math.max(columns.length - 1, 1);
  const [selected, doubted] = ['selected', 'selected doubtful'].map((kind) => svg('path', { class: kind }));
  const told = html('p', { role: 'status' });
  const axes = columns.map(({ name, values }, k) => new Axis(name, values, MARGIN + k * apart, () => select()));
  const pathOf = (drawn) => drawn.map((row) => `M${columns.map(({ values }, k) =>
    `${axes[k].x.toFixed(1)} ${axes[k].yOf(values[row]).toFixed(1)}`).join('L')}`).join('');
  const select = () => {
    const chosen = places.filter((row) => columns.every(({ values }, k) => axes[k].selects(values[row])));
    place(selected, { d: pathOf(chosen.filter((row) => !isDoubtful(row))) });
    place(doubted, { d: pathOf(chosen.filter(isDoubtful)) });
    say(told, wordsOf(chosen, rows));
  };
  const all = svg('path', { class: 'all', d: pathOf(places.filter((row) => !isDoubtful(row))) });
  const others = svg('path', { class: 'all doubtful', d: pathOf(places.filter(isDoubtful)) });
  const bestRow = rows.findIndex(({ point }) => point === best);
  const bestOne = bestRow < 0 ? [] : [svg('path', { class: isDoubtful(bestRow) ? 'best doubtful' : 'best', d: pathOf([bestRow]) })];
  // Names that stand beside each other would run into one another.
  const names = columns.map(({ name }, k) => svg('text', { class: 'name', x: axes[k].x, y: k % 2 ? 30 : 14, 'text-anchor': 'middle' }, name));
  const hasGaps = columns.some(({ values }) => values.includes(null));
  const none = hasGaps ? [svg('text', { x: MARGIN - 14, y: BOTTOM + NONE + 4, 'text-anchor': 'end' }, 'no value')] : [];
  select();
  const thick = bestOne.length ? '; the thick one is the best' : '';
  const dashed = places.some(isDoubtful) ? '; dashed: not converged, tripped, failed, or breaks a constraint' : '';
  const drawn = svg('svg', { viewBox: `0 0 ${WIDTH} ${BOTTOM + NONE + TOP / 4}`, role: 'group', 'aria-label': 'Points over parallel axes' },
    all, others, selected, doubted, ...bestOne, ...names, ...none, ...axes.map(({ element }) => element));
  const title = `Each line is a point${thick}${dashed}`;
  return html('figure', { class: 'parallel' }, html('figcaption', {}, title, saveButton(drawn, title)), drawn,
    html('p', { class: 'across' }, 'Drag along an axis, or move its ends with the arrow keys, to select points; click on it to take all of it again.'), told);
}

/** The reason not to trust the figures of a point. */
function remarksOn({ converged, fault, failure, allowed }) {
  const isWhole = !fault && !failure;
  return [fault, failure, converged === false && 'not converged', isWhole && allowed === false && 'breaks a constraint'].filter(Boolean);
}

/** Which points are selected; of a single one its values, with their ranges over the rig and its members. */
function wordsOf(chosen, rows) {
  if (chosen.length !== 1) return `${chosen.length} of ${rows.length} points selected`;
  const row = rows[chosen[0]];
  const levels = Object.entries(row.levels).map(([name, value]) => `${name} ${textOf(value)}`);
  const figures = Object.entries(row.metrics).map(([name, metric]) => `${name} ${rangeOf(metric)}`);
  return `1 of ${rows.length} points selected: ${[...levels, ...figures, ...remarksOn(row)].join(', ')}`;
}

function rangeOf({ value, least, most }) {
  const hasRange = least !== null && most !== null && textOf(least) !== textOf(most);
  return hasRange ? `${textOf(value)} (${textOf(least)} to ${textOf(most)})` : textOf(value);
}

function textOf(value) {
  if (value === null) return 'no value';
  return typeof value === 'number' ? String(Number(value.toPrecision(4))) : value;
}
