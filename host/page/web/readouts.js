// Position, pressures and state of the drive, large enough to read from across the room.

import { valueText } from './plot.js';
import { html, say } from './svg.js';

const FIGURES = [['position', 'Position', 'mm'], ['pressure-1', 'Pressure 1', 'kPa'], ['pressure-2', 'Pressure 2', 'kPa'], ['mode', 'State', '']];

/** The figures of the last look, in large letters. */
export class Readouts {
  #parts = {};

  constructor(element) {
    const figure = ([name, label, unit]) => {
      this.#parts[name] = html('strong', { 'data-figure': name }, '–');
      return html('p', {}, html('small', {}, [label, unit].filter(Boolean).join(', ')), this.#parts[name]);
    };
    element.replaceChildren(...FIGURES.map(figure));
  }

  /** Shows the state of the drive at a look; without a look, that there is none. */
  show({ position, pressures = [], mode } = {}) {
    const { mode: state } = this.#parts;
    say(this.#parts.position, valueText(position ?? NaN, 'mm'));
    [1, 2].forEach((chamber) => say(this.#parts[`pressure-${chamber}`], valueText(pressures[chamber - 1] ?? NaN, 'kPa')));
    say(state, mode ?? 'not connected');
    state.className = `mode ${mode ?? ''}`;
  }
}
