// The keys of the component that was chosen.

import { COMPONENTS } from './components.js';
import { Field } from './field.js';
import { KeyList } from './key-list.js';
import { html } from './svg.js';

/** The panel beside the picture. `callbacks` has `changed(key, text, isDone)` and `chosen(id)`. */
export class Inspector {
  #element;
  #keys;
  #callbacks;
  #fields = new Map();
  #list = null;
  #id = '';
  #shape = '';

  constructor(element, keys, callbacks) {
    this.#element = element;
    this.#keys = keys;
    this.#callbacks = callbacks;
  }

  /** Shows a component of a rig. `state` has `used`, `values`, `fileValues`, `problems`, and the names of the keys that are `changed`. */
  show(id, state) {
    const component = COMPONENTS.find((one) => one.id === id);
    const keys = this.#keys.filter((key) => component.tables.includes(key.table) && state.used.has(key.path));
    const law = state.values['controller.law']?.text;
    const shape = `${id} ${state.rig} ${law} ${keys.map((key) => key.path)}`;
    if (shape !== this.#shape) this.#build(component, keys, state, law);
    this.#shape = shape;
    const isChanged = ({ path, stem }) => state.changed.has(path) || state.changed.has(stem);
    const problemsOf = (path) => state.problems.filter((one) => belongs(one, path, this.#keys));
    for (const key of keys) {
      const field = this.#fields.get(key.path);
      field.show(state.values[key.path], isChanged(key));
      field.complain(problemsOf(key.path).map((one) => one.message).join('; '));
    }
    this.#list.count(isChanged, ({ path }) => problemsOf(path).length > 0);
    this.#tellProblemsElsewhere(state.problems);
  }

  #build(component, keys, state, law) {
    const view = component.id === this.#id ? this.#list.view : null;
    this.#id = component.id;
    const focused = document.activeElement?.id;
    this.#fields = new Map(keys.map((key) =>
      [key.path, new Field(key, state.values[key.path], state.fileValues[key.path], this.#callbacks)]));
    const groups = component.tables.map((table) => ({ title: table, keys: keys.filter((key) => key.table === table) }));
    const several = groups.filter(({ keys: of }) => of.length > 0).length > 1;
    const sections = groups.map(({ title, keys: of }) => ({ title: several ? title : '', keys: of }));
    this.#list = new KeyList(sections, this.#fields, ({ first }) => first[law]);
    if (view) this.#list.view = view;
    const names = COMPONENTS.map(({ id, title }) => html('option', { value: id, selected: id === component.id }, title));
    const choice = html('select', { id: 'component', 'aria-label': 'Component' }, ...names);
    choice.addEventListener('change', () => this.#callbacks.chosen(choice.value));
    this.#element.replaceChildren(html('h2', {}, choice), html('div', { class: 'elsewhere' }), ...this.#list.elements);
    if (focused) document.getElementById(focused)?.focus();
  }

  /** Problems of keys that are not shown, each leading to its component. */
  #tellProblemsElsewhere(problems) {
    const hidden = problems.filter((one) => ![...this.#fields.keys()].some((path) => belongs(one, path, this.#keys)));
    const lines = hidden.map((one) => html('p', { class: 'problem' }, `${one.key}: ${one.message}`));
    const place = this.#element.querySelector('.elsewhere');
    if (lines.length || place.firstChild) place.replaceChildren(...lines);
  }
}

/** Whether a problem is one of a key, spelled with its unit or without. */
function belongs(problem, path, keys) {
  return problem.key === path || problem.key === keys.find((key) => key.path === path)?.stem;
}
