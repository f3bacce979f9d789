// The fields of a component's keys: those that matter first, the others behind a click, and a search through all of them.

import { html, say } from './svg.js';

/** A shorter list has no search: it is seen at a glance. */
const SEARCHED = 12;

/** `sections` are `{ title, keys }`, `fields` the field of each path, `placeOf(key)` the place of a key that matters first. */
export class KeyList {
  #keys;
  #fields;
  #more = null;
  /** Number of keys behind the click. */
  #hidden = 0;
  #count = html('summary', {});
  #nothing = html('p', { class: 'remark', hidden: true }, 'No key matches by name or meaning.');
  #search;

  constructor(sections, fields, placeOf) {
    this.#keys = sections.flatMap(({ keys }) => keys);
    this.#fields = fields;
    const first = this.#keys.filter((key) => placeOf(key) !== undefined).sort((a, b) => placeOf(a) - placeOf(b));
    this.#search = html('input', { type: 'search', id: 'key-search', 'aria-label': 'Search the keys', placeholder: 'Search the keys', autocomplete: 'off', spellcheck: 'false' });
    this.#search.addEventListener('input', () => this.#filter());
    const others = this.#sectionsOf(sections, (key) => !first.includes(key));
    if (first.length) {
      this.#more = html('details', { class: 'more' }, this.#count, ...others);
      this.#hidden = this.#keys.length - first.length;
    }
    const shown = first.length ? [...this.#sectionsOf([{ title: '', keys: first }], () => true), this.#more] : others;
    this.elements = [...(this.#keys.length > SEARCHED ? [this.#search] : []), this.#nothing, ...shown];
  }

  #sectionsOf(sections, isWanted) {
    const wanted = sections.map(({ title, keys }) => ({ title, keys: keys.filter(isWanted) })).filter(({ keys }) => keys.length > 0);
    return wanted.map(({ title, keys }) => html('section', {},
      ...(title ? [html('h3', {}, title)] : []), ...keys.map(({ path }) => this.#fields.get(path).element)));
  }

  /** What is searched, and whether all keys are shown: for the list that takes the place of this one. */
  get view() {
    return { sought: this.#search.value, isOpen: this.#more?.open ?? false };
  }

  set view({ sought, isOpen }) {
    if (this.#more) this.#more.open = isOpen;
    this.#search.value = sought;
    this.#filter();
  }

  /** Counts what lies behind the click; a problem there opens it. */
  count(isChanged, isWrong) {
    if (!this.#more) return;
    const behind = this.#keys.filter(({ path }) => this.#more.contains(this.#fields.get(path).element));
    const changed = behind.filter(isChanged).length;
    say(this.#count, `${this.#hidden} more${changed ? `, ${changed} changed from the file` : ''}`);
    if (behind.some(isWrong)) this.#more.open = true;
  }

  #filter() {
    const sought = this.#search.value.trim().toLowerCase();
    for (const key of this.#keys) this.#fields.get(key.path).element.hidden = !matches(key, sought);
    const found = this.#keys.filter((key) => matches(key, sought));
    if (sought && this.#more) this.#more.open = found.some(({ path }) => this.#more.contains(this.#fields.get(path).element));
    this.#nothing.hidden = found.length > 0;
  }
}

/** Whether a key has these letters in its name, its meaning or its name in the thesis. */
function matches({ path, name, meaning, thesis }, sought) {
  return [path, name, meaning, thesis].some((text) => text.toLowerCase().includes(sought));
}
