// The form of a sweep: what it varies, and what it collects.

import { labelled, numberIn } from './numbers.js';
import { html } from './svg.js';

const VARIED = ['number', 'integer', 'choice', 'switch'];

/** Collected if nothing else is chosen. */
const USUAL = ['settling_s', 'overshoot_mm'];

/** The form of a sweep. `callbacks.changed()` hears of every change, `callbacks.state()` gives the rig's keys and values. */
export class SweepForm {
  #keys;
  #callbacks;
  #rows = [];
  #list = html('div', { class: 'varied' });
  #figures = [];
  #aim;
  #runs;

  constructor(keys, { figures }, callbacks) {
    this.#keys = keys.filter(({ kind }) => VARIED.includes(kind.type));
    this.#callbacks = callbacks;
    this.#figures = figures.map(({ name, meaning }) => {
      const box = html('input', { type: 'checkbox', value: name, id: `figure-${name}`, checked: USUAL.includes(name) });
      return { name, box, element: html('label', { title: meaning }, box, ` ${name}`) };
    });
    const aims = ['', ...figures.flatMap(({ name }) => [`minimise ${name}`, `maximise ${name}`])];
    this.#aim = html('select', { id: 'sweep-best' }, ...aims.map((aim) => html('option', { value: aim, selected: aim === 'minimise overshoot_mm' }, aim || 'none')));
    this.#runs = html('input', { type: 'text', id: 'sweep-runs', inputmode: 'numeric', value: '8', size: 6 });
    const more = html('button', { type: 'button', id: 'sweep-more' }, 'Add a key');
    more.addEventListener('click', () => this.#add());
    this.element = html('div', {}, html('h3', {}, 'Varied keys'), this.#list, html('p', {}, more),
      html('h3', {}, 'Figures to collect'), html('div', { class: 'choices' }, ...this.#figures.map(({ element }) => element)),
      ...labelled('sweep-best', 'Best point', this.#aim), ...labelled('sweep-runs', 'Runs per point', this.#runs, 'the rig and its perturbed runs'));
    this.element.addEventListener('input', () => callbacks.changed());
  }

  /** The rig has other keys or values. */
  show() {
    const used = this.#used();
    this.#rows = this.#rows.filter(({ select }) => used.some(({ path }) => path === select.value));
    if (this.#rows.length === 0 && used.length > 0) this.#add();
    this.#list.replaceChildren(...this.#rows.map(({ element }) => element));
  }

  /** The sweep in the form of the request. */
  body() {
    const metrics = this.#figures.filter(({ box }) => box.checked).map(({ name }) => name);
    const [aim, metric] = this.#aim.value.split(' ');
    return { vary: this.#rows.map((row) => row.body()), metrics, objective: metric ? { aim, metric } : null, runs: numberIn(this.#runs) };
  }

  #used() {
    const { used, values } = this.#callbacks.state();
    return this.#keys.filter(({ path }) => used.has(path) && values[path]);
  }

  /** The mass, which every user knows, first; then the next key that does not vary yet. */
  #add() {
    const taken = this.#rows.map(({ select }) => select.value);
    const free = this.#used().filter(({ path }) => !taken.includes(path));
    const key = free.find(({ path }) => path === 'load.mass_kg') ?? free[0];
    if (!key) return;
    this.#rows.push(this.#row(key));
    this.#list.replaceChildren(...this.#rows.map(({ element }) => element));
    this.#callbacks.changed();
  }

  #row(key) {
    const tables = Map.groupBy(this.#used(), ({ table }) => table || 'rig');
    const option = (one) => html('option', { value: one.path, title: one.meaning, selected: one.path === key.path }, one.path);
    const select = html('select', { 'aria-label': 'Varied key' },
      ...[...tables].map(([table, keys]) => html('optgroup', { label: table }, ...keys.map(option))));
    const remove = html('button', { type: 'button', class: 'reset', 'aria-label': 'Do not vary this key' }, '×');
    const row = { select, over: html('span', { class: 'over' }) };
    row.element = html('div', { class: 'vary' }, select, remove, row.over);
    const choose = () => this.#fill(row, this.#keys.find(({ path }) => path === select.value));
    select.addEventListener('change', () => {
      choose();
      this.#callbacks.changed();
    });
    remove.addEventListener('click', () => {
      this.#rows = this.#rows.filter((other) => other !== row);
      row.element.remove();
      this.#callbacks.changed();
    });
    choose();
    return row;
  }

  /** The fields for the values of a key. */
  #fill(row, key) {
    if (!['number', 'integer'].includes(key.kind.type)) {
      const words = key.kind.options ?? ['false', 'true'];
      row.over.replaceChildren(words.join(', '));
      row.body = () => ({ key: key.path, words });
      return;
    }
    const field = (name, value) => html('input', { type: 'text', class: name, 'aria-label': `${key.path} ${name}`, inputmode: 'decimal', size: 8, value });
    const [low, high] = around(key.kind, this.#callbacks.state().values[key.path].number);
    const [from, to, steps] = [field('from', low), field('to', high), field('steps', 5)];
    const log = html('input', { type: 'checkbox', 'aria-label': `${key.path} in logarithmic steps` });
    row.over.replaceChildren('from ', from, ' to ', to, ` ${key.unit} in `, steps, ' values ', html('label', {}, log, ' logarithmic'));
    row.body = () => ({ key: key.path, from: numberIn(from), to: numberIn(to), steps: numberIn(steps), logarithmic: log.checked });
  }
}

/** From a half to the double of a value, within the range of its key. */
function around({ type, min, max }, value) {
  const ends = value === 0 ? [0, 1] : [value / 2, value * 2].sort((a, b) => a - b);
  const rounded = (number) => (type === 'integer' ? Math.round(number) : Number(number.toPrecision(3)));
  return ends.map((end) => rounded(Math.min(Math.max(end, min ?? -Infinity), max ?? Infinity)));
}
