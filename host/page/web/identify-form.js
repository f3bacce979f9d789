// Which records parameters are found from, and which of them are unknown.

import { html } from './svg.js';

/** The form of an identification. `callbacks.changed()` hears of every change, `callbacks.records()` gives the records of the page. */
export class IdentifyForm {
  #callbacks;
  #records = html('ul', { class: 'records' });
  #unknowns = html('div', { class: 'choices' });
  #boxes = [];
  /** The names of records that are not used. */
  #unused = new Set();

  constructor(_, __, callbacks) {
    this.#callbacks = callbacks;
    const open = html('button', { type: 'button' }, 'Open a record…');
    open.addEventListener('click', () => callbacks.open());
    this.element = html('div', {}, html('h3', {}, 'Records'), this.#records, html('p', {}, open),
      html('h3', {}, 'Unknown parameters'), this.#unknowns);
    this.element.addEventListener('input', () => callbacks.changed());
  }

  /** The records of the page have changed. */
  show() {
    const names = this.#callbacks.records().map(({ name }) => {
      const box = html('input', { type: 'checkbox', value: name, checked: !this.#unused.has(name) });
      box.addEventListener('input', () => (box.checked ? this.#unused.delete(name) : this.#unused.add(name)));
      return html('li', {}, html('label', {}, box, ` ${name}`));
    });
    this.#records.replaceChildren(...(names.length ? names : [html('li', {}, 'none: drop a TARGET file, or open one')]));
  }

  /** Another rig is opened, which may have other unknowns. */
  opened() {
    this.#boxes = [];
    this.#unused.clear();
    this.#unknowns.replaceChildren();
  }

  /** Uses this record alone. */
  useOnly(record) {
    this.#unused = new Set(this.#callbacks.records().map(({ name }) => name).filter((name) => name !== record));
    this.show();
  }

  /** The plan tells what may be unknown. */
  planned({ unknowns }) {
    const paths = unknowns.map(({ key }) => key);
    if (paths.join() === this.#boxes.map(({ path }) => path).join()) return;
    const before = new Set(this.#boxes.filter(({ box }) => !box.checked).map(({ path }) => path));
    this.#boxes = unknowns.map(({ key, assumed_within: within }) => {
      const box = html('input', { type: 'checkbox', value: key, checked: !before.has(key) });
      return { path: key, box, element: html('label', { title: `assumed within ${within}` }, box, ` ${key}`) };
    });
    this.#unknowns.replaceChildren(...this.#boxes.map(({ element }) => element));
  }

  /** The keys for the request; none if all unknowns are selected: the command fits those by default. */
  body() {
    const chosen = this.#boxes.filter(({ box }) => box.checked).map(({ path }) => path);
    if (this.#boxes.length && !chosen.length) throw new Error('choose at least one unknown parameter');
    const records = this.#callbacks.records().filter(({ name }) => !this.#unused.has(name));
    return { records, fit: chosen.length === this.#boxes.length ? [] : chosen };
  }
}
