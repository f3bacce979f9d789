// The run that follows a slider: one request at a time, and only for the newest change; then what is wrong with it, and its
// perturbed runs.

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

  /** Drops the waiting request. */
  forget() {
    this.#waiting = null;
  }
}

/** A pause of this length ends a movement of a slider, ms: only then are the members worth their time. */
const PAUSE = 60;

/** While a slider moves, the fields beside the curves are brought up to date no more often than this, ms. */
const FIELDS = 250;

/** Tells `callbacks` of the run, the check and the members of the newest rig that it was given. */
export class Simulation {
  #callbacks;
  #checks = new Newest((asked) => this.#check(asked));
  #runs = new Newest((asked, isNewest) => this.#run(asked, isNewest));
  #ensemble = new AbortController();
  #pause = 0;
  #isEnsembleDue = false;
  #checked = 0;
  /** Number of rigs that were given up. */
  #given = 0;

  /** `callbacks` has the functions `check`, `run`, `ensemble` and `failed`. */
  constructor(callbacks) {
    this.#callbacks = callbacks;
  }

  /** Whether every request has been answered. */
  get isAtRest() {
    return !(this.#checks.isBusy || this.#runs.isBusy || this.#isEnsembleDue);
  }

  /** `since` is when the change was made, as `performance.now()` has it. */
  ask(rig, since = performance.now()) {
    this.#leaveEnsemble();
    this.#runs.ask({ rig, since, given: this.#given });
  }

  /** There is another rig: nothing that was asked for before is told any more. */
  giveUp() {
    this.#leaveEnsemble();
    this.#given += 1;
    this.#runs.forget();
    this.#checks.forget();
  }

  #leaveEnsemble() {
    clearTimeout(this.#pause);
    this.#ensemble.abort();
    this.#isEnsembleDue = false;
  }

  async #check({ rig, given }) {
    try {
      const found = await post('/api/check', rig);
      if (given === this.#given) this.#callbacks.check(found, rig);
    } catch (error) {
      if (given === this.#given) this.#callbacks.failed(error);
    }
  }

  /** The curves first: what the fields say comes after them. */
  async #run(asked, isNewest) {
    const { rig, since, given } = asked;
    let hasFailed = false;
    try {
      const run = await postForColumns('/api/run', rig);
      if (given !== this.#given) return;
      this.#callbacks.run(run, rig, since);
      if (isNewest()) {
        this.#isEnsembleDue = true;
        this.#pause = setTimeout(() => this.#askEnsemble(rig), PAUSE);
      }
    } catch (error) {
      if (given !== this.#given) return;
      // What is wrong with the rig, the check tells at its field.
      hasFailed = !(error instanceof Refused) || error.problems.length === 0;
      if (hasFailed) this.#callbacks.failed(error);
    }
    const isDue = isNewest() || performance.now() - this.#checked > FIELDS;
    if (!isDue || hasFailed) return;
    this.#checked = performance.now();
    this.#checks.ask(asked);
  }

  async #askEnsemble(rig) {
    this.#ensemble = new AbortController();
    const { signal } = this.#ensemble;
    try {
      const band = await postForColumns('/api/ensemble', rig, signal);
      if (!signal.aborted) this.#callbacks.ensemble(band);
    } catch (error) {
      if (!signal.aborted) this.#callbacks.failed(error);
    } finally {
      if (!signal.aborted) this.#isEnsembleDue = false;
    }
  }
}
