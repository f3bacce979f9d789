// The result of a study: notes, tables and graphs, as on the page of its command.

import { chartOf } from './chart.js';
import { tableOf } from './figures.js';
import { html } from './svg.js';

/**
 * Shows a report; the first graph stands before the tables. `command` is what it is of, `actions` are buttons for what can be
 * done with it, `more` are figures behind the first one.
 */
export function showReport(element, { title, notes, tables, figures }, command, actions, more = []) {
  const [first, ...others] = notes;
  const [lead, ...rest] = figures;
  element.replaceChildren(
    html('h2', { tabindex: -1 }, title), html('code', {}, command), ...(first ? [html('p', { class: 'verdict' }, first)] : []),
    html('p', { class: 'row' }, ...actions),
    ...(lead ? [chartOf(lead)] : []), ...more,
    ...others.map((note) => html('p', { class: 'remark' }, note)),
    ...tables.map((table) => html('div', { class: 'wide', tabindex: 0, role: 'region', 'aria-label': table.heading }, tableOf(table, false))),
    ...rest.map(chartOf));
  element.querySelector('h2').focus();
}

/** Shows what can be expected here. */
export function showNothing(element, text) {
  element.replaceChildren(html('p', { class: 'empty' }, text));
}
