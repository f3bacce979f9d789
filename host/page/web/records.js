// Records over the run, and the deviation of the simulation from each.

import { Refused } from './answer.js';

/** The ways to lay a record over the run, as `overlay --align` has them. */
export const ALIGNMENTS = [
  ['start', 'by the start of the test'],
  ['move', 'by the first move'],
  ['correlation', 'where the positions agree best'],
];

export class Records {
  #ask;
  #callbacks;
  #records = [];
  #align = 'start';
  /** What was asked for last, by the name of the record: its content and the number of the question. */
  #asked = new Map();
  #count = 0;

  /** `ask(record, align)` gives a comparison; `callbacks` has the functions `changed` and `failed`. */
  constructor(ask, callbacks) {
    this.#ask = ask;
    this.#callbacks = callbacks;
  }

  /** The curves, for the graphs. */
  get runs() {
    return this.#records.map(({ run }) => run);
  }

  /** The records themselves: name, content, shift, figures and deviation. The content is what `incoming.js` gives. */
  get all() {
    return this.#records;
  }

  get align() {
    return this.#align;
  }

  /** Aligns all records by another method. */
  set align(method) {
    this.#align = method;
    this.compareAgain();
  }

  clear() {
    this.#records = [];
    this.#asked.clear();
    this.#callbacks.changed();
  }

  dismiss(record) {
    this.#records = this.#records.filter(({ name }) => name !== record.name);
    this.#asked.delete(record.name);
    this.#callbacks.changed();
  }

  /** There is another run: no answer that is on its way is of it. `compareAgain` asks anew. */
  outdate() {
    for (const asked of this.#asked.values()) asked.number = 0;
  }

  /** Compares each with the newest run, those that are on their way as well. */
  compareAgain() {
    for (const { content } of [...this.#asked.values()]) this.lay(content);
  }

  /**
   * Lays a record or a run folder over the run; one that lies there already is compared again. An answer is ignored if a later
   * request has overtaken it, or nothing needs it any more.
   */
  async lay(given) {
    const content = this.#named(given);
    const { name } = content;
    this.#count += 1;
    const number = this.#count;
    const isNewest = () => this.#asked.get(name)?.number === number;
    this.#asked.set(name, { content, number });
    try {
      const { head, time, columns } = await this.#ask(content, this.#align);
      if (!isNewest()) return;
      const curves = new Map(columns.map((column) => [column.name, column.values]));
      const units = new Map(columns.map((column) => [column.name, column.unit]));
      const run = { label: name, time, curves, units, isRecord: true };
      const record = { name, content, shift: head.shift_s, figures: head.figures, deviation: head.deviation, run };
      this.#records = [...this.#records.filter((other) => other.name !== name), record];
      this.#callbacks.changed();
    } catch (error) {
      if (!isNewest()) return;
      this.#forget(name);
      this.#callbacks.failed(error.status === 413 ? tooLong(name) : error);
    }
  }

  /** Run folders are often called alike: another run under the same name gets a name of its own. */
  #named(content) {
    if (content.run_json === undefined) return content;
    const isFree = (name) => {
      const there = this.#asked.get(name)?.content;
      return !there || (there.run_json === content.run_json && there.trace_csv === content.trace_csv);
    };
    let name = content.name;
    for (let number = 2; !isFree(name); number += 1) name = `${content.name} (${number})`;
    return name === content.name ? content : { ...content, name };
  }

  /** After a failure: what lies over the run is compared again with the next one, and what does not is forgotten. */
  #forget(name) {
    const before = this.#records.find((record) => record.name === name);
    if (before) this.#asked.get(name).content = before.content;
    else this.#asked.delete(name);
  }
}

function tooLong(name) {
  return new Refused(413, { error: `${name} is longer than the 16 MiB that the studio takes; \`pneudrive overlay\` takes longer ones` });
}
