// The list of the runs that are on the graphs.

import { html, say } from './svg.js';

export class Runs {
  #element;
  /** The run of the page, which changes with every movement of a slider. */
  #now = html('span', {});
  #nowRow = html('li', { class: 'now' }, this.#now);
  #rows = [];

  constructor(element) {
    this.#element = element;
  }

  /** Shows them: the label of the run of the page, or null, and `{ kind, label, dismiss }` of each of the others. */
  show(now, others) {
    if (now !== null) say(this.#now, now);
    const before = [...this.#rows];
    this.#rows = others.map((other) => {
      const place = before.findIndex(({ kind, label }) => kind === other.kind && label === other.label);
      return place < 0 ? rowOf(other) : Object.assign(before.splice(place, 1)[0], { dismiss: other.dismiss });
    });
    const elements = [...(now === null ? [] : [this.#nowRow]), ...this.#rows.map(({ element }) => element)];
    const { children } = this.#element;
    const isSame = elements.length === children.length && elements.every((one, place) => one === children[place]);
    if (!isSame) this.#element.replaceChildren(...elements);
  }
}

function rowOf(run) {
  const button = html('button', { type: 'button', 'aria-label': `Dismiss ${run.label}` }, '×');
  const row = { ...run, element: html('li', { class: run.kind }, html('span', {}, run.label), button) };
  button.addEventListener('click', () => row.dismiss());
  return row;
}
