// What outlives the page: the changes that are in no file yet, and what the address says.

import { readAddress, writeAddress } from './address.js';
import { keepEdits } from './edits.js';
import { OtherTabs } from './other-tabs.js';

/** A pause of this length ends a movement of a slider, ms. */
const PAUSE = 300;

/** Keeps them. `callbacks.went(address)` hears of Back and Forward, `callbacks.others(count)` how many other tabs have the same file. */
export class Memory {
  #rig = null;
  #history = null;
  #tabs;
  #pause = 0;
  #isKept = true;

  constructor(callbacks) {
    this.#tabs = new OtherTabs(callbacks.others);
    addEventListener('popstate', () => callbacks.went(readAddress()));
    addEventListener('pagehide', () => this.#keep());
    addEventListener('beforeunload', (event) => {
      this.#keep();
      if (!this.#isKept) event.preventDefault();
    });
  }

  /** The page has a rig now, with its changes; `isFile`: other tabs may have it, too. */
  opened(rig, history, isFile) {
    this.#keep();
    [this.#rig, this.#history] = [rig, history];
    const { rig: before } = readAddress();
    writeAddress({ rig: rig.name }, before !== undefined && before !== rig.name);
    this.#tabs.has(isFile ? rig.name : null);
  }

  /** Something was changed. */
  changed() {
    clearTimeout(this.#pause);
    this.#pause = setTimeout(() => this.#keep(), PAUSE);
  }

  #keep() {
    clearTimeout(this.#pause);
    if (this.#rig) this.#isKept = keepEdits(this.#rig, this.#history.told);
  }
}
