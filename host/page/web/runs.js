// The list of what is on the graphs. What has not changed keeps its place: a button that was replaced between the press of
// a mouse and its release would not be clicked.

import { html } from './svg.js';

export class Runs {
  #list;
  #now = html('li', { class: 'now' }, html('span', {}));
  /** The entry of each run and record. */
  #entries = new WeakMap();

  constructor(list) {
    this.#list = list;
  }

  /** Shows the run that follows the sliders, and what can be dismissed below: `kind`, `label`, `of`, and what then to do. */
  show(run, others) {
    const now = this.#now.firstChild;
    if (run && now.textContent !== run.label) now.textContent = run.label;
    const wanted = [...(run ? [this.#now] : []), ...others.map((other) => this.#entry(other))];
    for (const gone of [...this.#list.children].filter((entry) => !wanted.includes(entry))) gone.remove();
    wanted.forEach((entry, place) => {
      if (this.#list.children[place] !== entry) this.#list.insertBefore(entry, this.#list.children[place] ?? null);
    });
  }

  #entry({ kind, label, of, dismissed }) {
    if (!this.#entries.has(of)) {
      const dismiss = html('button', { type: 'button', 'aria-label': `Dismiss ${label}` }, '×');
      dismiss.addEventListener('click', dismissed);
      this.#entries.set(of, html('li', { class: kind }, html('span', {}, label), dismiss));
    }
    return this.#entries.get(of);
  }
}
