// The figures of the moves, and what they rest on.

import { html } from './svg.js';

/** Shows figures that rest on one run, while its members are computed. */
export function showAlone(element, { figures, fault }) {
  element.replaceChildren(verdict('pending', 'One run', 'its perturbed runs are being computed'), ...tripped(fault), tableOf(figures, true));
}

/** Shows figures with their ranges over the run and its members, and whether the run has converged. */
export function showJudged(element, { figures, notes, converged, remarks }, fault) {
  const [, convergence, ...others] = notes;
  const [word, why] = split(convergence);
  const sentences = [...others.map((note) => `${note}.`), ...remarks].map((text) => html('p', { class: 'remark' }, text));
  element.replaceChildren(verdict(converged ? 'converged' : 'unconverged', word, why), ...tripped(fault), tableOf(figures, false), ...sentences);
}

/** Shows how far the simulation is from the records that lie over it, below the figures of the moves. */
export function showDeviations(element, tables) {
  element.querySelectorAll('table.deviation').forEach((table) => table.remove());
  for (const table of tables) {
    const shown = tableOf(table, false);
    shown.className = 'deviation';
    element.append(shown);
  }
}

function split(convergence) {
  const at = convergence.indexOf(': ');
  return at < 0 ? [convergence, ''] : [convergence.slice(0, at), convergence.slice(at + 2)];
}

function verdict(kind, word, why) {
  return html('p', { class: `verdict ${kind}` }, html('strong', {}, word), ` ${why}`);
}

function tripped(fault) {
  if (!fault) return [];
  return [html('p', { class: 'verdict unconverged' }, html('strong', {}, `tripped at ${fault.at_s.toFixed(4)} s: ${fault.name}`), ` ${fault.meaning}`)];
}

/** A table as the answers have it. */
export function tableOf({ heading, columns, rows }, isPending) {
  const head = html('tr', {}, ...columns.map((name) => html('th', { scope: 'col' }, ...withUnit(name))));
  const body = rows.map(([first, ...cells]) => html('tr', { class: first.startsWith(' ') ? 'end' : 'move' },
    html('th', { scope: 'row' }, first.trim()), ...cells.map((cell) => html('td', {}, cell))));
  return html('table', { class: isPending ? 'pending' : null }, html('caption', {}, heading),
    html('thead', {}, head), html('tbody', {}, ...body));
}

/** The unit of a heading stands below it. */
function withUnit(name) {
  const at = name.lastIndexOf(', ');
  return at < 0 ? [name] : [name.slice(0, at), html('small', {}, name.slice(at + 2))];
}
