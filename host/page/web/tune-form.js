// The form of a tuning: the requirements on a step, the spread, and the size of the search.

import { labelled, numberIn } from './numbers.js';
import { html } from './svg.js';

const FIELDS = [
  ['step_mm', 'Step', 'mm, there and back'],
  ['settled_mm', 'Settled within', 'mm of the setpoint'],
  ['overshoot_percent', 'Maximum overshoot', '% of the step'],
  ['time_s', 'Time each way', 's'],
  ['load_percent', 'Load ±', '%'],
  ['friction_percent', 'Friction ±', '%'],
  ['supply_percent', 'Supply pressure ±', '%'],
  ['valve_percent', 'Valve conductance ±', '%'],
  ['population', 'Candidates', 'per generation'],
  ['generations', 'Generations', '0: evaluates the gains of the file'],
  ['draws', 'Fresh draws', 'to evaluate the gains'],
];

/** The tolerance of the rig, and the size of the search that suits its law, until others are typed. */
const OF_RIG = ['settled_mm', 'population', 'generations'];

/** The form of a tuning. `callbacks.changed()` hears of every change. */
export class TuneForm {
  #fields;
  #typed = new Set();
  #searched = html('p', { class: 'remark' });

  constructor(_, { goal }, callbacks) {
    this.#fields = FIELDS.map(([name, label, unit]) => {
      const field = html('input', { type: 'text', id: `tune-${name}`, inputmode: 'decimal', size: 8, value: goal[name] });
      field.addEventListener('input', () => this.#typed.add(name));
      return { name, label, unit, field };
    });
    const lines = (from, to) => this.#fields.slice(from, to).flatMap(({ name, label, unit, field }) => labelled(`tune-${name}`, label, field, unit));
    this.element = html('div', {}, html('h3', {}, 'Goal for a step'), ...lines(0, 4),
      html('h3', {}, 'Spread of the drive'), ...lines(4, 8),
      html('h3', {}, 'Search'), this.#searched, ...lines(8));
    this.element.addEventListener('input', () => callbacks.changed());
  }

  show() {}

  /** Another rig is opened: its tolerance and the size of its search are its own. */
  opened() {
    for (const name of OF_RIG) this.#typed.delete(name);
  }

  /** Shows what is searched on this rig, and the size that suits it. */
  planned({ search }) {
    this.#searched.textContent = `Searched: ${search.what.join(', ')}.`;
    for (const { name, field } of this.#fields) if (this.#isUsual(name)) field.value = search[name];
  }

  #isUsual(name) {
    return OF_RIG.includes(name) && !this.#typed.has(name);
  }

  /** The tuning in the form of the request. */
  body() {
    return { goal: Object.fromEntries(this.#fields.map(({ name, field }) => [name, this.#isUsual(name) ? null : numberIn(field)])) };
  }
}
