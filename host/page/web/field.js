// The field of one key: its name, a slider, its value with its unit, where that comes from, and what is wrong with it.

import { sliderFor } from './slider.js';
import { html, say } from './svg.js';

/** What a key means, and its name in the thesis if it has one there. */
function hoverOf({ meaning, thesis }) {
  return thesis ? `${meaning}\nIn the thesis: ${thesis}` : meaning;
}

/** A field. `callbacks.changed(key, text, isDone)` hears of every change; text null: back to the file's value. */
export class Field {
  #key;
  #callbacks;
  #input;
  #slider = null;
  #scale = null;
  #origin = html('span', { class: 'origin' });
  #problem;
  #reset;

  constructor(key, value, fileValue, callbacks) {
    this.#key = key;
    this.#callbacks = callbacks;
    const id = `key-${key.path.replace('.', '-')}`;
    this.#problem = html('p', { class: 'problem', id: `${id}-problem`, role: 'alert' });
    this.#input = this.#inputOf(id, value);
    this.#reset = html('button', { type: 'button', class: 'reset', title: 'Reset to the value of the file', hidden: true }, '↺');
    this.#reset.setAttribute('aria-label', `${key.name}: back to the value of the file`);
    this.#reset.addEventListener('click', () => callbacks.changed(key, null, true));
    this.element = html('div', { class: 'field', 'data-key': key.path },
      html('label', { for: id, title: hoverOf(key) }, key.name || key.path), this.#sliderOf(fileValue), this.#input,
      html('span', { class: 'unit' }, key.unit), this.#origin, this.#reset, this.#problem, this.#help(id));
    this.show(value, false);
  }

  /** Shows a value of the rig; what is being typed stays. */
  show(value, isChanged) {
    const isHeld = document.activeElement === this.#input && this.#input.type === 'text';
    if (value && !isHeld) this.#put(value.text);
    if (this.#scale && value && document.activeElement !== this.#slider) {
      this.#slider.value = this.#scale.stepOf(value.number);
    }
    const origin = isChanged ? 'changed' : (value?.origin ?? 'none');
    say(this.#origin, origin);
    this.#origin.title = isChanged ? 'changed from the file, on this page' : (value?.origin_in_words ?? this.#key.preset);
    this.#origin.className = `origin ${origin}`;
    this.element.classList.toggle('changed', isChanged);
    this.#reset.hidden = !isChanged;
  }

  /** Shows a value that was chosen elsewhere, at once. */
  put(text) {
    this.#put(text);
  }

  /** Shows what is wrong; nothing for an empty message. */
  complain(message) {
    say(this.#problem, message);
    this.element.classList.toggle('wrong', message !== '');
    this.#input.setAttribute('aria-invalid', String(message !== ''));
  }

  focus() {
    this.#input.focus();
  }

  #put(text) {
    if (this.#input.type === 'checkbox') this.#input.checked = text === 'true';
    else this.#input.value = text;
  }

  #inputOf(id, value) {
    const { kind } = this.#key;
    const described = { id, 'aria-describedby': `${id}-help ${id}-problem` };
    if (kind.type === 'choice') return this.#choice(described, kind.options);
    if (kind.type === 'switch') return this.#switch(described);
    const text = { ...described, type: 'text', autocomplete: 'off', spellcheck: 'false', inputmode: 'text' };
    const input = html('input', { ...text, readonly: kind.type === 'default-only', placeholder: value ? null : 'none' });
    input.addEventListener('input', () => this.#callbacks.changed(this.#key, input.value.trim() || null, false));
    input.addEventListener('change', () => this.#callbacks.changed(this.#key, input.value.trim() || null, true));
    return input;
  }

  #choice(described, options) {
    const select = html('select', described, ...options.map((word) => html('option', { value: word }, word)));
    select.addEventListener('change', () => this.#callbacks.changed(this.#key, select.value, true));
    return select;
  }

  #switch(described) {
    const box = html('input', { ...described, type: 'checkbox' });
    box.addEventListener('change', () => this.#callbacks.changed(this.#key, String(box.checked), true));
    return box;
  }

  #sliderOf(fileValue) {
    this.#scale = sliderFor(this.#key.kind, fileValue?.number, fileValue?.range);
    if (!this.#scale) return html('span', { class: 'no-slider' });
    this.#slider = html('input', { type: 'range', min: 0, max: this.#scale.steps, 'aria-label': `${this.#key.name}, slider` });
    const changed = (isDone) => {
      const text = String(this.#scale.valueAt(Number(this.#slider.value)));
      this.#put(text);
      this.#callbacks.changed(this.#key, text, isDone);
    };
    this.#slider.addEventListener('input', () => changed(false));
    this.#slider.addEventListener('change', () => changed(true));
    return this.#slider;
  }

  #help(id) {
    const { meaning, range, preset, thesis, path } = this.#key;
    const facts = [range && `${range} ${this.#key.unit}`.trim(), preset && `without it ${preset}`, thesis && `thesis ${thesis}`];
    return html('p', { class: 'help', id: `${id}-help` }, meaning, html('br'),
      html('code', {}, path), ` · ${facts.filter(Boolean).join(' · ')}`);
  }
}
