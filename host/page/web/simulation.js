// The run that follows a slider: one request at a time, and only for the newest change; then its neighbours.

import { Refused, post, postForColumns } from './server.js';

/** Does the newest of what it is asked to do, one at a time. */
class Newest {
  #work;
  #waiting = null;
  #busy = false;

  constructor(work) {
    this.#work = work;
  }

  get isBusy() {
    return this.#busy;
  }

  async ask(what) {
    this.#waiting = what;
    if (this.#busy) return;
    this.#busy = true;
    while (this.#waiting !== null) {
      const next = this.#waiting;
      this.#waiting = null;
      await this.#work(next, () => this.#waiting === null);
    }
    this.#busy = false;
  }
}

/** A pause of this length ends a movement of a slider, ms: only then are the neighbours worth their time. */
const PAUSE = 60;

/** Tells `told` of the check, the run and the neighbours of the newest rig that it was given. */
export class Simulation {
  #told;
  #checks = new Newest((rig) => this.#check(rig));
  #runs = new Newest((asked, isNewest) => this.#run(asked, isNewest));
  #neighbours = new AbortController();
  #pause = 0;
  #areNeighboursDue = false;

  /** `told` has the functions `check`, `run`, `neighbours` and `failed`. */
  constructor(told) {
    this.#told = told;
  }

  /** Whether everything that was asked for has been told. */
  get isAtRest() {
    return !(this.#checks.isBusy || this.#runs.isBusy || this.#areNeighboursDue);
  }

  /** `since` is when the change was made, as `performance.now()` has it. */
  ask(rig, since = performance.now()) {
    clearTimeout(this.#pause);
    this.#neighbours.abort();
    this.#areNeighboursDue = false;
    this.#checks.ask(rig);
    this.#runs.ask({ rig, since });
  }

  async #check(rig) {
    try {
      this.#told.check(await post('/api/check', rig));
    } catch (error) {
      this.#told.failed(error);
    }
  }

  async #run({ rig, since }, isNewest) {
    try {
      this.#told.run(await postForColumns('/api/run', rig), rig, since);
      if (!isNewest()) return;
      this.#areNeighboursDue = true;
      this.#pause = setTimeout(() => this.#askNeighbours(rig), PAUSE);
    } catch (error) {
      // What is wrong with the rig, the check tells at its field.
      if (!(error instanceof Refused) || error.problems.length === 0) this.#told.failed(error);
    }
  }

  async #askNeighbours(rig) {
    this.#neighbours = new AbortController();
    const { signal } = this.#neighbours;
    try {
      const band = await postForColumns('/api/neighbours', rig, signal);
      if (!signal.aborted) this.#told.neighbours(band);
    } catch (error) {
      if (!signal.aborted) this.#told.failed(error);
    } finally {
      if (!signal.aborted) this.#areNeighboursDue = false;
    }
  }
}
