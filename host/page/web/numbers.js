// Fields for numbers.

import { html } from './svg.js';

/** The number in a field. */
export function numberIn(field) {
  const number = Number(field.value.trim() || NaN);
  if (Number.isFinite(number)) return number;
  throw new Error(`${field.getAttribute('aria-label') ?? field.labels[0].textContent}: write a number`);
}

/** A line of a form: its label, its control, and the text behind it. */
export function labelled(id, label, control, behind = '') {
  return [html('p', { class: 'row' }, html('label', { for: id }, label), control, html('small', {}, behind))];
}

/** A number of seconds as an estimate. */
export function about(seconds) {
  if (seconds < 1) return 'less than a second';
  if (seconds < 99.5) return `about ${seconds.toFixed(0)} s`;
  if (seconds < 5970) return `about ${(seconds / 60).toFixed(0)} min`;
  return `about ${(seconds / 3600).toFixed(1)} h`;
}
