// The list of rigs in the header: those that come with the program, and the file that is open.

import { html } from './svg.js';

export class RigList {
  #select;
  #builtin;
  #file = html('option', { disabled: true });

  /** `builtin` are `{ name, about }`. */
  constructor(select, builtin) {
    this.#select = select;
    this.#builtin = builtin.map(({ name }) => name);
    select.append(...builtin.map(({ name, about }) => html('option', { value: name, title: about }, name)));
  }

  get names() {
    return this.#builtin;
  }

  isFile(name) {
    return !this.#builtin.includes(name);
  }

  /** Shows which rig is open: of a file its name, and its path when one points at it. */
  show(name) {
    this.#file.remove();
    if (this.isFile(name)) {
      [this.#file.value, this.#file.title, this.#file.textContent] = [name, name, name.split(/[\\/]/).at(-1)];
      this.#select.prepend(this.#file);
    }
    this.#select.value = name;
    this.#select.title = name;
  }
}
