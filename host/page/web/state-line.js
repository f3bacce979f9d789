// The line in the header, which every view shows: how the rig is, unless the drive has not been stopped.

import { say } from './svg.js';

export class StateLine {
  #element;
  #now = ['', false];
  #alarm = '';

  constructor(element) {
    this.#element = element;
  }

  /** Tells something. */
  show(text, isWrong = false) {
    this.#now = [text, isWrong];
    this.#draw();
  }

  /** Tells this and nothing else, until it is taken back with ''. */
  alarm(text) {
    this.#alarm = text;
    this.#draw();
  }

  #draw() {
    const [text, isWrong] = this.#alarm ? [this.#alarm, true] : this.#now;
    say(this.#element, text);
    this.#element.classList.toggle('wrong', isWrong);
  }
}
