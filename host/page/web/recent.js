// The samples of the last minute.

import { placeOf } from './scale.js';

/** How long they are kept, s. */
const KEPT = 60;

/** Room for them, twice: a stream has 1000 a second at most. */
const ROOM = 2 * 1024 * KEPT;

/** The channels in the order in which the server sends them, and their units. */
export const CHANNELS = new Map([
  ['setpoint', 'mm'], ['position', 'mm'], ['pressure 1', 'kPa'], ['pressure 2', 'kPa'], ['spool', 'mm'], ['error', 'counts'], ['command', 'counts'],
]);

/** Samples on one axis of time; a row of NaN is a gap. */
export class Recent {
  #time = new Float64Array(ROOM);
  #channels = new Map([...CHANNELS.keys()].map((name) => [name, new Float32Array(ROOM)]));
  #from = 0;
  #end = 0;

  /** Adds what has come, and forgets what is older than a minute. */
  add({ time, channels }) {
    if (this.#end + time.length > ROOM) this.#makeRoom();
    this.#time.set(time, this.#end);
    // What is unknown is null in JSON, which would become 0.
    [...this.#channels.values()].forEach((kept, place) => kept.set(channels[place].map((value) => value ?? NaN), this.#end));
    this.#end += time.length;
    this.#from = this.#placeOf(this.last - KEPT);
  }

  clear() {
    [this.#from, this.#end] = [0, 0];
  }

  get isEmpty() {
    return this.#from === this.#end;
  }

  /** The time of the newest, s. */
  get last() {
    return this.isEmpty ? 0 : this.#time[this.#end - 1];
  }

  /** A run of the samples between two times, which begins at the first of these, or with the oldest sample. */
  between(from, to) {
    const origin = Math.max(from, this.isEmpty ? from : this.#time[this.#from]);
    const [first, end] = [this.#placeOf(origin), this.#placeOf(to + 1e-9)];
    const time = this.#time.slice(first, end).map((at) => at - origin);
    const curves = new Map([...this.#channels].map(([name, kept]) => [name, kept.slice(first, end)]));
    return { label: 'live', origin, time, curves, units: CHANNELS };
  }

  /** Times and values of a channel, of what is kept since a time and the sample before it. */
  since(after, name) {
    const first = Math.max(this.#placeOf(after) - 1, this.#from);
    return [this.#time.subarray(first, this.#end), this.#channels.get(name).subarray(first, this.#end)];
  }

  #placeOf(time) {
    return this.#from + placeOf(this.#time.subarray(this.#from, this.#end), time);
  }

  #makeRoom() {
    for (const kept of [this.#time, ...this.#channels.values()]) kept.copyWithin(0, this.#from, this.#end);
    [this.#from, this.#end] = [0, this.#end - this.#from];
  }
}
