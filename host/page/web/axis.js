// One of several parallel axes: its scale, its ticks, and the range on it that is selected.

import { scaleOf, ticks, tickText } from './scale.js';
import { place, svg } from './svg.js';

/** Ends of the axes, and the row below them for missing values, pixels. */
export const [TOP, BOTTOM, NONE] = [46, 246, 22];

/** Step of an end of the range per key press, as a share of the axis; Page up and Page down take ten steps. */
const STEPS = 50;

/** Largest motion of a pointer that still counts as a click, pixels. */
const CLICK = 4;

/** An axis at a horizontal position. `changed()` is called when the selected range has changed. */
export class Axis {
  #ends;
  #part;
  #words;
  #y;
  #bar = svg('rect', { width: 10, class: 'part' });
  #handles;
  #changed;

  constructor(name, values, x, changed) {
    this.x = x;
    this.#changed = changed;
    this.#words = [...new Set(values.filter((value) => typeof value === 'string'))];
    this.#ends = this.#words.length ? [-0.5, this.#words.length - 0.5] : endsOf(values);
    this.#part = [...this.#ends];
    this.#y = scaleOf(...this.#ends, BOTTOM, TOP);
    this.#handles = ['least', 'most'].map((end, which) => this.#handle(`${name}, ${end}`, which));
    this.element = svg('g', { class: 'axis' }, svg('path', { class: 'rule', d: `M${x} ${TOP}V${BOTTOM}` }), ...this.#marks(),
      this.#ground(), this.#bar, ...this.#handles);
    this.#show();
  }

  /** The position of a value on the axis. */
  yOf(value) {
    return value === null ? BOTTOM + NONE : this.#y(this.#numberOf(value));
  }

  /** Whether a value is in the selected range; every value is while the range is the whole axis. */
  selects(value) {
    if (this.#isWhole) return true;
    const number = value === null ? NaN : this.#numberOf(value);
    return number >= this.#part[0] && number <= this.#part[1];
  }

  get #isWhole() {
    return this.#part.every((end, which) => end === this.#ends[which]);
  }

  #numberOf(value) {
    return typeof value === 'string' ? this.#words.indexOf(value) : value;
  }

  #marks() {
    const numbers = ticks(...this.#ends, 5);
    const step = numbers[1] - numbers[0];
    const marks = this.#words.length ? this.#words.map((word, place) => [place, word]) : numbers.map((number) => [number, tickText(number, step)]);
    return marks.flatMap(([number, text]) => [
      svg('path', { class: 'rule', d: `M${this.x - 4} ${this.#y(number)}h4` }),
      svg('text', { x: this.x - 11, y: this.#y(number) + 4, 'text-anchor': 'end' }, text),
    ]);
  }

  /** Handles the pointer: a drag selects a range, a click the whole axis. */
  #ground() {
    const ground = svg('rect', { class: 'ground', x: this.x - 14, y: TOP - 6, width: 28, height: BOTTOM - TOP + 12 });
    let from = null;
    const valueAt = (event) => {
      const box = ground.getBoundingClientRect();
      return this.#within(this.#y.back(TOP - 6 + (event.clientY - box.top) * (BOTTOM - TOP + 12) / box.height));
    };
    ground.addEventListener('pointerdown', (event) => {
      from = { value: valueAt(event), at: event.clientY };
      ground.setPointerCapture(event.pointerId);
    });
    ground.addEventListener('pointermove', (event) => {
      if (from && Math.abs(event.clientY - from.at) > CLICK) this.#choose([from.value, valueAt(event)].sort((a, b) => a - b));
    });
    ground.addEventListener('pointerup', (event) => {
      if (from && Math.abs(event.clientY - from.at) <= CLICK) this.#choose([...this.#ends]);
      from = null;
    });
    ground.addEventListener('pointercancel', () => { from = null; });
    return ground;
  }

  /** An end of the range, which keys move. */
  #handle(label, which) {
    const handle = svg('rect', { class: 'end', tabindex: 0, role: 'slider', width: 16, height: 6, x: this.x - 8, 'aria-label': label, 'aria-orientation': 'vertical' });
    const [low, high] = this.#ends;
    const step = this.#words.length ? 1 : (high - low) / STEPS;
    const moves = { ArrowUp: step, ArrowRight: step, ArrowDown: -step, ArrowLeft: -step, PageUp: 10 * step, PageDown: -10 * step, Home: low - high, End: high - low };
    handle.addEventListener('keydown', (event) => {
      if (!(event.key in moves) || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      const part = [...this.#part];
      const moved = this.#within(part[which] + moves[event.key]);
      part[which] = which === 0 ? Math.min(moved, part[1]) : Math.max(moved, part[0]);
      this.#choose(part);
    });
    return handle;
  }

  #within(number) {
    return Math.min(Math.max(number, this.#ends[0]), this.#ends[1]);
  }

  #choose(part) {
    this.#part = part;
    this.#show();
    this.#changed();
  }

  #show() {
    const [low, high] = this.#part.map((end) => this.#y(end));
    place(this.#bar, { x: this.x - 5, y: high, height: Math.max(low - high, 0), visibility: this.#isWhole ? 'hidden' : 'visible' });
    this.#handles.forEach((handle, which) => {
      const end = this.#part[which];
      place(handle, {
        y: this.#y(end) - 3, 'aria-valuemin': this.#ends[0], 'aria-valuemax': this.#ends[1], 'aria-valuenow': end, 'aria-valuetext': this.#textOf(end, which),
      });
    });
  }

  #textOf(end, which) {
    if (!this.#words.length) return String(Number(end.toPrecision(4)));
    return this.#words[which === 0 ? Math.ceil(end) : Math.floor(end)] ?? 'none';
  }
}

function endsOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value === null) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  const air = low === high ? Math.abs(low) * 0.05 || 1 : 0;
  return [low - air, high + air];
}
